// Points and vectors of the engine: Eigen's fixed-size vectors under the project's own name, and the views
// that convert between them and the plain arrays of the public interface.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/prcage.h"

namespace prcage {

using Vec3 = Eigen::Vector3d;
using Position = std::array<double, 3>;
using Triangle = std::array<std::uint32_t, 3>;

inline Vec3 vec(const Position& p) { return {p[0], p[1], p[2]}; }
inline Position position(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

// The nearest float. Through memory: GCC 12 vectorises conversions to float and back of neighbouring doubles to
// nothing.
inline double round_to_float(double x) {
  const volatile float rounded = static_cast<float>(x);
  return static_cast<double>(rounded);
}

// The nearest point whose coordinates are floats.
inline Position round_to_floats(const Vec3& v) {
  return {round_to_float(v.x()), round_to_float(v.y()), round_to_float(v.z())};
}

}  // namespace prcage
