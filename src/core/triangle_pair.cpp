#include "core/triangle_pair.h"

#include <algorithm>
#include <cmath>

#include "core/predicates.h"

namespace prcage {
namespace {

// A triangle's plane in floating point.
class FilteredPlane {
 public:
  FilteredPlane(const double* a, const double* b, const double* c) : a_(a) {
    const double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
    const double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
    const double yz = uy * vz, zy = uz * vy, zx = uz * vx, xz = ux * vz, xy = ux * vy, yx = uy * vx;
    x_ = yz - zy;
    y_ = zx - xz;
    z_ = xy - yx;
    x_magnitude_ = std::abs(yz) + std::abs(zy);
    y_magnitude_ = std::abs(zx) + std::abs(xz);
    z_magnitude_ = std::abs(xy) + std::abs(yx);
  }

  // orient3d: +1 or -1 if the sign is certain, else 0. The bound is the static error of the expression (7 roundings
  // on each product of differences, each exact difference off by half an ulp) with room to spare; results near
  // underflow are left undecided.
  int side(const double* d) const {
    const double wx = d[0] - a_[0], wy = d[1] - a_[1], wz = d[2] - a_[2];
    const double det = x_ * wx + y_ * wy + z_ * wz;
    const double magnitude = x_magnitude_ * std::abs(wx) + y_magnitude_ * std::abs(wy) + z_magnitude_ * std::abs(wz);
    const double bound = 2e-15 * magnitude + 1e-280;
    return det > bound ? 1 : det < -bound ? -1 : 0;
  }

 private:
  const double* a_;
  double x_, y_, z_;
  double x_magnitude_, y_magnitude_, z_magnitude_;
};

// Are both points certain to be strictly on one side of the plane of t?
bool both_on_one_side(const double* const t[3], const double* x, const double* y) {
  const FilteredPlane plane(t[0], t[1], t[2]);
  const int side = plane.side(x);
  return side != 0 && plane.side(y) == side;
}

// Are all corners of s certain to be strictly on one side of the plane of t?
bool separates(const double* const t[3], const double* const s[3]) {
  const FilteredPlane plane(t[0], t[1], t[2]);
  const int side = plane.side(s[0]);
  return side != 0 && plane.side(s[1]) == side && plane.side(s[2]) == side;
}

bool shares_two(const TriangleRef& a, const int* in_a, const TriangleRef& b, const int* in_b) {
  const double* u = a.p[in_a[0]];
  const double* v = a.p[in_a[1]];
  const double* p = a.p[3 - in_a[0] - in_a[1]];
  const double* q = b.p[3 - in_b[0] - in_b[1]];
  if (FilteredPlane(u, v, p).side(q) != 0) return false;
  if (exact::orient3d(u, v, p, q) != 0) return false;
  return exact::coplanar_side(u, v, p, q) > 0;
}

bool shares_one(const TriangleRef& a, int in_a, const TriangleRef& b, int in_b) {
  const double* a1 = a.p[(in_a + 1) % 3];
  const double* a2 = a.p[(in_a + 2) % 3];
  const double* b1 = b.p[(in_b + 1) % 3];
  const double* b2 = b.p[(in_b + 2) % 3];
  if (both_on_one_side(b.p, a1, a2) || both_on_one_side(a.p, b1, b2)) return false;
  return exact::segment_triangle_intersect(a1, a2, b.p[0], b.p[1], b.p[2]) ||
         exact::segment_triangle_intersect(b1, b2, a.p[0], a.p[1], a.p[2]);
}

}  // namespace

bool certainly_separated(const double* const a[3], const double* const b[3]) {
  return separates(a, b) || separates(b, a);
}

bool improper_contact(const TriangleRef& a, const TriangleRef& b) {
  int in_a[3];
  int in_b[3];
  int shared = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (a.v[i] == b.v[j] && shared < 3) {
        in_a[shared] = i;
        in_b[shared] = j;
        ++shared;
      }
  if (shared == 0)
    return !certainly_separated(a.p, b.p) && exact::triangles_intersect(a.p[0], a.p[1], a.p[2], b.p[0], b.p[1], b.p[2]);
  if (shared == 1) return shares_one(a, in_a[0], b, in_b[0]);
  if (shared == 2) return shares_two(a, in_a, b, in_b);
  return true;
}

}  // namespace prcage
