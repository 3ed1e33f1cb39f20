// Contender: CGAL's alpha wrap by itself. Its only knobs are lengths, so alpha is found by bisection, and the offset is
// a thirtieth of it, as in CGAL's own examples: the wrap with the most faces that are not too many.
//
// CGAL's Alpha_wrap_3 is under the GPL-3.0-or-later, and so is this program as a whole.
#include <cmath>
#include <stdexcept>
#include <utility>

#include "perf/rival.h"
#include "tools/wrap/alpha_wrap.h"

namespace prcage::perf {
namespace {

constexpr double alpha_per_offset = 30;
constexpr double largest_alpha = 1;
constexpr double smallest_alpha = 1.0 / 1000;
constexpr int bisections = 7;

class AlphaSearch {
 public:
  AlphaSearch(const Mesh& input, std::size_t faces) : input_(input), faces_(faces) {}

  Search run() && {
    double alpha = 1.0 / 20;
    const bool finer = try_alpha(alpha);
    const double factor = finer ? 0.5 : 2;
    double last = alpha;
    while (alpha > smallest_alpha && alpha < largest_alpha) {
      last = alpha;
      alpha *= factor;
      if (try_alpha(alpha) != finer) break;
    }
    double fits = finer ? last : alpha, does_not = finer ? alpha : last;
    for (int i = 0; i < bisections; ++i) {
      const double middle = std::sqrt(fits * does_not);
      (try_alpha(middle) ? fits : does_not) = middle;
    }
    return std::move(search_);
  }

 private:
  // Are its faces few enough?
  bool try_alpha(double alpha) {
    Wrap wrap = alpha_wrap(input_, {alpha, alpha / alpha_per_offset});
    if (wrap.status != Status::ok) throw std::runtime_error(wrap.message);
    search_.seconds += wrap.seconds;
    const std::size_t faces = wrap.mesh.triangles.size();
    const bool fits = faces <= faces_;
    if (better(faces)) {
      search_.kept = {std::move(wrap.mesh), wrap.seconds, {{"alpha", alpha}, {"offset", alpha / alpha_per_offset}}};
    }
    return fits;
  }

  // The most that fit; if none do, the fewest.
  bool better(std::size_t faces) const {
    const std::size_t kept = search_.kept.cage.triangles.size();
    if (kept == 0) return true;
    if (kept > faces_) return faces < kept;
    return faces <= faces_ && faces > kept;
  }

  const Mesh& input_;
  std::size_t faces_;
  Search search_;
};

}  // namespace
}  // namespace prcage::perf

int main(int argc, char** argv) {
  using namespace prcage;
  return perf::rival_main(argc, argv,
                          [](const Mesh& input, std::size_t faces) { return perf::AlphaSearch(input, faces).run(); });
}
