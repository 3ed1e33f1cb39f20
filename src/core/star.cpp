#include "core/star.h"

#include <cmath>

namespace prcage {
namespace {

struct Vector {
  double x, y, z;
};

Vector offset(const double* from, const double* to) { return {to[0] - from[0], to[1] - from[1], to[2] - from[2]}; }

// u x v, and the same sums with absolute values, to which the errors are proportional.
struct Cross {
  Vector value;
  Vector magnitude;

  Cross(const Vector& u, const Vector& v) {
    const double yz = u.y * v.z, zy = u.z * v.y, zx = u.z * v.x, xz = u.x * v.z, xy = u.x * v.y, yx = u.y * v.x;
    value = {yz - zy, zx - xz, xy - yx};
    magnitude = {std::abs(yz) + std::abs(zy), std::abs(zx) + std::abs(xz), std::abs(xy) + std::abs(yx)};
  }

  // Sign of the product with w if it is certain, else 0. The components of u, v and w are numbers or differences of two
  // numbers; the bound covers the roundings of those, of the products and of the sums with room to spare. Results near
  // underflow are left undecided.
  int sign_of_product(const Vector& w) const {
    const double product = value.x * w.x + value.y * w.y + value.z * w.z;
    const double bound =
        2e-15 * (magnitude.x * std::abs(w.x) + magnitude.y * std::abs(w.y) + magnitude.z * std::abs(w.z)) + 1e-280;
    return product > bound ? 1 : product < -bound ? -1 : 0;
  }
};

// Sum of the faces' area vectors, up to rounding: any direction will do, this one does for most stars.
Vector mean_normal(const double* centre, const double* const* link, std::size_t size) {
  Vector sum{0, 0, 0};
  Vector u = offset(centre, link[size - 1]);
  for (std::size_t i = 0; i < size; ++i) {
    const Vector v = offset(centre, link[i]);
    sum.x += u.y * v.z - u.z * v.y;
    sum.y += u.z * v.x - u.x * v.z;
    sum.z += u.x * v.y - u.y * v.x;
    u = v;
  }
  return sum;
}

}  // namespace

bool star_certainly_embedded(const double* centre, const double* const* link, std::size_t size) {
  const Vector n = mean_normal(centre, link, size);
  // u -> (n x d) . u does not change along n. An odd d, so that regular meshes have no vertices where it is zero.
  const Cross across(n, {0.3141, 0.5926, -0.7422});
  Vector u = offset(centre, link[size - 1]);
  int side = across.sign_of_product(u);
  if (side == 0) return false;
  int rises = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const Vector v = offset(centre, link[i]);
    if (Cross(u, v).sign_of_product(n) <= 0) return false;
    const int next_side = across.sign_of_product(v);
    if (next_side == 0) return false;
    if (side < next_side) ++rises;
    side = next_side;
    u = v;
  }
  return rises == 1;
}

}  // namespace prcage
