#include "core/schedule.h"

#include <cmath>

namespace prcage {

std::string options_error(const Options& options) {
  if (options.tau_absolute != 0 && !(options.tau_absolute > 0 && std::isfinite(options.tau_absolute)))
    return "tau_absolute must be positive and finite";
  if (options.tau_absolute == 0 && !(options.tau > 0 && options.tau <= 1)) return "tau must be in (0, 1]";
  if (!(options.sigma > 0 && options.sigma <= 0.01)) return "sigma must be in (0, 0.01]";
  if (options.threads < 0 || options.threads > 4096) return "threads must be in [0, 4096]";
  if (options.schedule.empty()) {
    if (options.cycles < 1 || options.cycles > 10000) return "cycles must be in [1, 10000]";
    return {};
  }
  double last = 0;
  for (const double beta : options.schedule) {
    if (!(beta > last && beta <= 1)) return "schedule must rise strictly within (0, 1]";
    last = beta;
  }
  if (last != 1) return "schedule must end at 1";
  return {};
}

}  // namespace prcage
