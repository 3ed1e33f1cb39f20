// The band seam: which interval of signed heights above the plane of a face a new vertex may take. The engine is the
// same for every band; that of a cage lies outside of M (paper eq. 4), that of a simplification on both sides (eq. 9).
#pragma once

#include <algorithm>

namespace prcage {

// Allowed n_f . (p - c_f), in the input's unit.
struct HeightInterval {
  double lower;
  double upper;
};

// On which sides of M a surface may be. On the outer one only: it also never moves inward.
enum class Sides { outer, both };

struct Band {
  double outer = 0;  // how far from M outside of it
  double inner = 0;  // and inside of it
  Sides sides = Sides::outer;

  // `distance` is an upper bound of d(c_f, M); for a band on both sides it is negative inside of M. The plane of the
  // face itself is always allowed.
  HeightInterval operator()(double distance) const {
    const double lower = sides == Sides::outer ? 0.0 : std::min(0.0, -inner - distance);
    return {lower, std::max(0.0, outer - distance)};
  }
  // With no more than `room` outward (eq. 10), up to a wrap of M, but as far out of M as into it in any case.
  HeightInterval operator()(double distance, double room) const {
    const HeightInterval height = (*this)(distance);
    return {height.lower, std::min(height.upper, std::max({0.0, room, inner - distance}))};
  }
};

}  // namespace prcage
