// Angles in degrees, accurate for slivers: atan2 of both products is, acos is not.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "core/vec3.h"

namespace prcage {

// 0 if one of the two has no length.
inline double angle_degrees(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi;
}

// At p, q and r.
inline std::array<double, 3> corner_angles(const Vec3& p, const Vec3& q, const Vec3& r) {
  return {angle_degrees(q - p, r - p), angle_degrees(r - q, p - q), angle_degrees(p - r, q - r)};
}

// The smallest of these, which is across from the shortest edge.
inline double least_angle(const Vec3& p, const Vec3& q, const Vec3& r) {
  const double a = (q - r).squaredNorm(), b = (r - p).squaredNorm(), c = (p - q).squaredNorm();
  if (a <= b && a <= c) return angle_degrees(q - p, r - p);
  return b <= c ? angle_degrees(r - q, p - q) : angle_degrees(p - r, q - r);
}

}  // namespace prcage
