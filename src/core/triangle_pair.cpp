#include "core/triangle_pair.h"

#include "core/filtered_cross.h"
#include "core/predicates.h"

namespace prcage {
namespace {

// A triangle's plane in floating point.
class FilteredPlane {
 public:
  FilteredPlane(const double* a, const double* b, const double* c)
      : a_(a), cross_(difference(a, b), difference(a, c)) {}

  // orient3d: +1 or -1 if the sign is certain, else 0.
  int side(const double* d) const { return cross_.sign_of_product(difference(a_, d)); }

 private:
  const double* a_;
  FilteredCross cross_;
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

// A direction, taken as exact: which side of the plane through an edge and parallel to it is a point on?
class FilteredDirection {
 public:
  // Nearly orthogonal to triangle t.
  explicit FilteredDirection(const double* const t[3])
      : direction_(FilteredCross(difference(t[0], t[1]), difference(t[0], t[2])).value()) {}

  // +1 or -1 if the sign is certain, else 0.
  int side(const double* p, const double* q, const double* d) const {
    return FilteredCross(difference(p, q), difference(p, d)).sign_of_product(direction_);
  }

 private:
  Vec3 direction_;
};

// Seen along the direction, does an edge of t have t on one side of its line and all of s strictly on the other? This
// is what separates coplanar triangles.
bool edge_separates(const FilteredDirection& direction, const double* const t[3], const double* const s[3]) {
  for (int i = 0; i < 3; ++i) {
    const double* p = t[i];
    const double* q = t[(i + 1) % 3];
    const int other = -direction.side(p, q, t[(i + 2) % 3]);
    if (other != 0 && direction.side(p, q, s[0]) == other && direction.side(p, q, s[1]) == other &&
        direction.side(p, q, s[2]) == other)
      return true;
  }
  return false;
}

// The same for triangles that share corner `shared` of t, where an edge at that corner has to separate them from the
// other two corners of s.
bool edge_separates_beyond(const FilteredDirection& direction, const double* const t[3], int shared, const double* x,
                           const double* y) {
  const double* v = t[shared];
  const double* p = t[(shared + 1) % 3];
  const double* q = t[(shared + 2) % 3];
  const auto beyond = [&](const double* edge, const double* apex) {
    const int other = -direction.side(v, edge, apex);
    return other != 0 && direction.side(v, edge, x) == other && direction.side(v, edge, y) == other;
  };
  return beyond(p, q) || beyond(q, p);
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
  const FilteredDirection direction(a.p);
  if (edge_separates_beyond(direction, a.p, in_a, b1, b2) || edge_separates_beyond(direction, b.p, in_b, a1, a2))
    return false;
  return exact::segment_triangle_intersect(a1, a2, b.p[0], b.p[1], b.p[2]) ||
         exact::segment_triangle_intersect(b1, b2, a.p[0], a.p[1], a.p[2]);
}

}  // namespace

bool certainly_separated(const double* const a[3], const double* const b[3]) {
  if (separates(a, b) || separates(b, a)) return true;
  const FilteredDirection direction(a);
  return edge_separates(direction, a, b) || edge_separates(direction, b, a);
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
