// A cross product in floating point that knows how far it may be off: the filter in front of the exact predicates.
#pragma once

#include <cmath>

#include "core/vec3.h"

namespace prcage {

// From one point to another, each component off by half an ulp at most.
inline Vec3 difference(const double* from, const double* to) {
  return {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
}

// u x v, and the same sums with absolute values, to which the errors are proportional.
class FilteredCross {
 public:
  FilteredCross(const Vec3& u, const Vec3& v) {
    const double yz = u.y() * v.z(), zy = u.z() * v.y(), zx = u.z() * v.x();
    const double xz = u.x() * v.z(), xy = u.x() * v.y(), yx = u.y() * v.x();
    value_ = {yz - zy, zx - xz, xy - yx};
    magnitude_ = {std::abs(yz) + std::abs(zy), std::abs(zx) + std::abs(xz), std::abs(xy) + std::abs(yx)};
  }

  const Vec3& value() const { return value_; }

  // Sign of the product with w if it is certain, else 0. The components of u, v and w are numbers or differences of two
  // numbers; the bound covers the roundings of those, of the products and of the sums with room to spare. Results near
  // underflow are left undecided.
  int sign_of_product(const Vec3& w) const {
    const double product = value_.x() * w.x() + value_.y() * w.y() + value_.z() * w.z();
    const double magnitude =
        magnitude_.x() * std::abs(w.x()) + magnitude_.y() * std::abs(w.y()) + magnitude_.z() * std::abs(w.z());
    const double bound = 2e-15 * magnitude + 1e-280;
    return product > bound ? 1 : product < -bound ? -1 : 0;
  }

 private:
  Vec3 value_;
  Vec3 magnitude_;
};

}  // namespace prcage
