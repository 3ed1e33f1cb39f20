// The band seam: which interval of signed heights above the plane of a face a new vertex may take. The engine is the
// same for every band; a cage's is eq. 4 of the paper.
#pragma once

#include <algorithm>

namespace prcage {

// Allowed n_f . (p - c_f), in the input's unit.
struct HeightInterval {
  double lower;
  double upper;
};

// Cage (eq. 4): outward only, at most what is left of tau. `distance` is an upper bound of d(c_f, M).
struct CageBand {
  double tau;

  HeightInterval operator()(double distance) const { return {0.0, std::max(0.0, tau - distance)}; }
};

}  // namespace prcage
