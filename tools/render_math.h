// What the parts of the renderer reckon with: float vectors, light as linear colours, and even samples of a pixel.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <Eigen/Geometry>

#include "tools/picture.h"

namespace prcage::raycast {

using Vec3f = Eigen::Vector3f;
using Vec2f = Eigen::Vector2f;

inline constexpr float pi = 3.14159265f;
inline constexpr float infinity = std::numeric_limits<float>::infinity();

// The scene is scaled to radius 1. Secondary rays start this far off the surface: far above float rounding there,
// far below anything that can be seen.
inline constexpr float ray_offset = 2e-4f;

inline float to_linear(double srgb) {
  return static_cast<float>(srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4));
}

inline std::uint8_t to_srgb_byte(float linear) {
  const float x = std::clamp(linear, 0.0f, 1.0f);
  const float srgb = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255 * srgb));
}

inline Vec3f linear_color(const Color& c) { return {to_linear(c[0]), to_linear(c[1]), to_linear(c[2])}; }

inline float smoothstep(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

// Points spread evenly over the unit square: the R2 sequence (Roberts 2018), shifted by a hash.
class Sequence {
 public:
  explicit Sequence(std::uint64_t hash) {
    hash = (hash + 1) * 0x9e3779b97f4a7c15u;
    hash = (hash ^ (hash >> 31)) * 0xbf58476d1ce4e5b9u;
    hash ^= hash >> 29;
    u_ = static_cast<std::uint32_t>(hash);
    v_ = static_cast<std::uint32_t>(hash >> 32);
  }

  Vec2f next() {
    u_ += 3242174889u;  // 2^32 / g and 2^32 / g^2 for the plastic number g
    v_ += 2447445414u;
    return {static_cast<float>(u_ >> 8) * 0x1p-24f, static_cast<float>(v_ >> 8) * 0x1p-24f};
  }

 private:
  std::uint32_t u_, v_;
};

// All samples of a pixel draw from the same two sequences, so that together they cover hemisphere and light evenly.
// Pixels are uncorrelated.
struct PixelSequence {
  Sequence hemisphere, light;

  PixelSequence(int x, int y)
      : hemisphere(static_cast<std::uint64_t>(x) << 32 | static_cast<std::uint64_t>(y) << 1),
        light(static_cast<std::uint64_t>(x) << 32 | static_cast<std::uint64_t>(y) << 1 | 1) {}
};

struct Frame {
  Vec3f x, y, z;

  explicit Frame(const Vec3f& normal) : z(normal) {
    x = (std::abs(z.x()) < 0.7f ? Vec3f::UnitX() : Vec3f::UnitY()).cross(z).normalized();
    y = z.cross(x);
  }

  Vec3f operator()(float a, float b, float c) const { return a * x + b * y + c * z; }
};

// Direction in the hemisphere of the frame, with density proportional to the cosine.
inline Vec3f cosine_direction(const Frame& frame, const Vec2f& u) {
  const float r = std::sqrt(u.x()), angle = 2 * pi * u.y();
  return frame(r * std::cos(angle), r * std::sin(angle), std::sqrt(std::max(0.0f, 1 - u.x())));
}

}  // namespace prcage::raycast
