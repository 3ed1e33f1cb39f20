// Distance from a point to a triangle in double precision.
#pragma once

#include <algorithm>

#include "core/vec3.h"

namespace prcage {

// The point of the closed triangle abc nearest to x. The triangle may be degenerate. The result is on the triangle
// up to rounding, so that its distance to x is an upper bound of the true one to within a few ulp of the coordinates.
inline Vec3 closest_point(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto on_segment = [&x](const Vec3& p, const Vec3& q) -> Vec3 {
    const Vec3 d = q - p;
    const double dd = d.squaredNorm();
    const double t = dd > 0 ? std::clamp((x - p).dot(d) / dd, 0.0, 1.0) : 0.0;
    return p + t * d;
  };
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 normal = ab.cross(ac);
  const double nn = normal.squaredNorm();
  const Vec3 ax = x - a;
  // Barycentric coordinates of the projection, times nn.
  const double v = ax.cross(ac).dot(normal);
  const double w = ab.cross(ax).dot(normal);
  if (v > 0 && w > 0 && v + w < nn) return a + (v / nn) * ab + (w / nn) * ac;
  // Outside, or degenerate: the nearest point is on an edge.
  const Vec3 p = on_segment(a, b);
  const Vec3 q = on_segment(b, c);
  const Vec3 r = on_segment(c, a);
  const double dp = (x - p).squaredNorm();
  const double dq = (x - q).squaredNorm();
  const double dr = (x - r).squaredNorm();
  return dp <= dq && dp <= dr ? p : dq <= dr ? q : r;
}

}  // namespace prcage
