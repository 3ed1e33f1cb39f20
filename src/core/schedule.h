// The staircase schedule (paper eq. 6): which share of tau each cycle may use.
#pragma once

#include <string>
#include <vector>

#include "core/prcage.h"

namespace prcage {

// The list in the options, or `cycles` uniform steps beta_k = k / cycles.
inline std::vector<double> schedule_of(const Options& options) {
  if (!options.schedule.empty()) return options.schedule;
  std::vector<double> betas;
  for (int k = 1; k <= options.cycles; ++k) betas.push_back(static_cast<double>(k) / options.cycles);
  return betas;
}

// Empty if the options are in range, else one sentence that names the option at fault.
std::string options_error(const Options& options);

}  // namespace prcage
