#include "tools/render_camera.h"

#include <algorithm>
#include <cmath>

namespace prcage::raycast {
namespace {

constexpr float tan_half_view = 0.21f;  // 24 degrees: little distortion, still depth
constexpr float margin = 1.12f;

}  // namespace

Camera::Camera(const RenderOptions& options, int columns, int rows)
    : columns_(static_cast<float>(columns)), rows_(static_cast<float>(rows)) {
  const float azimuth = static_cast<float>(options.azimuth) * pi / 180;
  const float elevation = static_cast<float>(options.elevation) * pi / 180;
  const auto world = [&](float x, float y, float z) { return options.z_up ? Vec3f(x, -z, y) : Vec3f(x, y, z); };
  world_up_ = world(0, 1, 0);
  const float level = std::cos(elevation);
  back_ = world(std::sin(azimuth) * level, std::sin(elevation), std::cos(azimuth) * level);
  right_ = world(std::cos(azimuth), 0, -std::sin(azimuth));
  up_ = back_.cross(right_);
  tan_x_ = tan_half_view * std::min(1.0f, columns_ / rows_);
  tan_y_ = tan_x_ * rows_ / columns_;
}

// Calls visit(x, y, towards the camera) relative to the target.
template <class Visit>
void Camera::for_each_point(const std::vector<const Body*>& bodies, const Vec3f& target, const Visit& visit) const {
  for (const Body* body : bodies) {
    for (std::size_t v = 0; v < body->vertex_count(); ++v) {
      const Vec3f d = body->point(v) - target;
      visit(Vec3f(d.dot(right_), d.dot(up_), d.dot(back_)));
    }
  }
}

float Camera::distance_for(const std::vector<const Body*>& bodies, const Vec3f& target) const {
  float distance = 0;
  for_each_point(bodies, target, [&](const Vec3f& p) {
    const float needed = std::max(std::abs(p.x()) / tan_x_, std::abs(p.y()) / tan_y_);
    distance = std::max(distance, p.z() + margin * needed);
  });
  return distance;
}

// Centring changes the distance that is needed and the reverse; a few rounds settle it.
void Camera::fit(const std::vector<const Body*>& bodies) {
  Vec3f target = Vec3f::Zero();
  for (int round = 0; round < 4; ++round) {
    const float distance = distance_for(bodies, target);
    Vec2f low(infinity, infinity), high(-infinity, -infinity);
    for_each_point(bodies, target, [&](const Vec3f& p) {
      const Vec2f on_screen = Vec2f(p.x(), p.y()) / (distance - p.z());
      low = low.cwiseMin(on_screen);
      high = high.cwiseMax(on_screen);
    });
    const Vec2f shift = 0.5f * distance * (low + high);
    target += shift.x() * right_ + shift.y() * up_;
  }
  eye_ = target + distance_for(bodies, target) * back_;
}

Vec3f Camera::direction(float x, float y) const {
  const float a = (2 * x / columns_ - 1) * tan_x_, b = (1 - 2 * y / rows_) * tan_y_;
  return (a * right_ + b * up_ - back_).normalized();
}

Vec3f Camera::project(const Vec3f& point) const {
  const Vec3f d = point - eye_;
  const float depth = -d.dot(back_);
  return {(1 + d.dot(right_) / (depth * tan_x_)) * columns_ / 2, (1 - d.dot(up_) / (depth * tan_y_)) * rows_ / 2,
          depth};
}

float Camera::inset(const Vec3f& point) const {
  const Vec3f p = project(point);
  const float side = std::min(p.x(), columns_ - p.x()) / columns_, bottom = (rows_ - p.y()) / rows_;
  return smoothstep(0, 0.12f, side) * smoothstep(0, 0.08f, bottom);
}

}  // namespace prcage::raycast
