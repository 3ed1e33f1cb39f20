#include <algorithm>
#include <cmath>
#include <optional>

#include "tools/render_panel.h"

namespace prcage::raycast {
namespace {

// Share of the hemisphere, by cosine, that is free within a radius.
float openness(const Body& body, const Vec3f& point, const Vec3f& normal, float reach, PixelSequence& sequence) {
  constexpr int rays = 5;
  const Frame frame(normal);
  int free = 0;
  for (int i = 0; i < rays; ++i) {
    if (!body.occluded(point, cosine_direction(frame, sequence.hemisphere.next()), 0, reach)) ++free;
  }
  return static_cast<float>(free) / rays;
}

}  // namespace

Shading::Shading(const Panel& panel, const Style& style, const Camera& camera)
    : panel_(panel), style_(style), camera_(camera) {
  const Vec3f &side = camera.right(), &up = camera.world_up(), &front = camera.back();
  key_ = (-0.55f * side + 0.95f * up + 0.65f * front).normalized();
  fill_ = (0.9f * side + 0.25f * up + 0.55f * front).normalized();
  rim_ = (0.3f * side + 0.6f * up - 0.9f * front).normalized();
  const Body& caster = shadow_caster();
  floor_ = infinity;
  for (std::size_t v = 0; v < caster.vertex_count(); ++v) floor_ = std::min(floor_, caster.point(v).dot(up));
}

Vec3f Shading::operator()(const Vec3f& ray, PixelSequence& sequence) const {
  const std::optional<Hit> hit = panel_.opaque->intersect(camera_.eye(), ray, 0, infinity);
  const Vec3f behind = hit ? surface(ray, *hit, sequence) : floor(ray, sequence);
  return panel_.shell == nullptr ? behind : over_shell(ray, hit ? hit->distance : infinity, behind);
}

// Lays the sheets of the shell over what is behind them. They are denser where they are seen edge-on, as glass is.
Vec3f Shading::over_shell(const Vec3f& ray, float end, const Vec3f& behind) const {
  constexpr int most_sheets = 16;
  Vec3f color = Vec3f::Zero();
  float transmitted = 1, from = 0;
  for (int sheet = 0; sheet < most_sheets; ++sheet) {
    const std::optional<Hit> hit = panel_.shell->intersect(camera_.eye(), ray, from, end);
    if (!hit) break;
    const Vec3f normal = panel_.shell->face_normal(hit->face);
    const float facing = -normal.dot(ray), grazing = 1 - std::abs(facing);
    const float opacity = (facing > 0 ? 0.15f : 0.10f) + 0.40f * grazing * grazing * grazing;
    const float light = 0.78f + 0.32f * std::max(0.0f, key_.dot(facing > 0 ? normal : Vec3f(-normal)));
    color += transmitted * opacity * light * style_.shell_color;
    transmitted *= 1 - opacity;
    from = hit->distance * (1 + 1e-5f);
  }
  return color + transmitted * behind;
}

Vec3f Shading::surface(const Vec3f& ray, const Hit& hit, PixelSequence& sequence) const {
  const Body& body = *panel_.opaque;
  Vec3f flat = body.face_normal(hit.face);
  Vec3f normal = panel_.smooth ? body.smooth_normal(hit) : flat;
  if (flat.dot(ray) > 0) {
    flat = -flat;
    normal = -normal;
  }
  if (panel_.distance != nullptr) {
    // Shaded just enough to see the form: the colour is a measure.
    const float light = 0.82f - 0.18f * flat.dot(ray);
    return light * (*panel_.distance)(camera_.eye() + hit.distance * ray);
  }
  const Vec3f point = camera_.eye() + hit.distance * ray + ray_offset * flat;
  const float open = openness(body, point, flat, 1.2f, sequence);
  const float sky = 0.5f + 0.5f * normal.dot(camera_.world_up());
  const float key = std::max(0.0f, normal.dot(key_)) * key_light(body, point, sequence);
  const float fill = std::max(0.0f, normal.dot(fill_)), rim = std::max(0.0f, normal.dot(rim_));
  const float edge = 1 + std::min(0.0f, normal.dot(ray));
  // Warm key, cool rest: keeps form readable in the shade.
  const Vec3f light = key * Vec3f(0.86f, 0.82f, 0.76f) + open * (0.16f + 0.20f * sky) * Vec3f(0.92f, 0.98f, 1.10f) +
                      open * (0.20f * fill + 0.25f * rim) * Vec3f(0.94f, 0.98f, 1.06f);
  const float sheen = 0.06f * open * edge * edge * edge;
  return panel_.color.cwiseProduct(light) + Vec3f::Constant(sheen);
}

// White, darkened near the body and in the shadow of the key light; fades out before the border of the panel.
Vec3f Shading::floor(const Vec3f& ray, PixelSequence& sequence) const {
  const Vec3f white = Vec3f::Ones();
  const Vec3f& up = camera_.world_up();
  const float slope = ray.dot(up), height = floor_ - camera_.eye().dot(up);
  if (!style_.shadow || slope > -1e-3f || height > 0) return white;
  const Vec3f point = camera_.eye() + height / slope * ray;
  const float strength = (1 - smoothstep(0.35f, 1.05f, (point - point.dot(up) * up).norm())) * camera_.inset(point);
  if (strength <= 0) return white;
  const Vec3f start = point + ray_offset * up;
  const Body& caster = shadow_caster();
  const float closed = 1 - openness(caster, start, up, 0.45f, sequence), dark = 1 - key_light(caster, start, sequence);
  return white - strength * (0.62f * closed + 0.10f * dark) * Vec3f(1.0f, 0.98f, 0.95f);
}

// Share of a round area light that is visible.
float Shading::key_light(const Body& body, const Vec3f& point, PixelSequence& sequence) const {
  constexpr int rays = 2;
  constexpr float size = 0.14f;
  const Frame frame(key_);
  int visible = 0;
  for (int i = 0; i < rays; ++i) {
    const Vec2f u = sequence.light.next();
    const float r = size * std::sqrt(u.x()), angle = 2 * pi * u.y();
    if (!body.occluded(point, frame(r * std::cos(angle), r * std::sin(angle), 1), 0, infinity)) ++visible;
  }
  return static_cast<float>(visible) / rays;
}

}  // namespace prcage::raycast
