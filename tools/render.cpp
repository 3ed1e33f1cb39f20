// Ray-cast pictures of meshes and cages, on Embree.
//
// A picture is a row of panels. A panel has an opaque body, and may have a translucent shell around it and wires. It
// is rendered in bands of rows; within a band, first the wires are marked on the sample grid, then every sample is
// shaded and the samples of a pixel are averaged. Wires are drawn in screen space, so that they have one width
// everywhere, and ask the scene at each sample whether the point of the edge can be seen.
#include "render.h"

#include <embree3/rtcore.h>
#include <fmt/core.h>
#include <png.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/surface.h"
#include "core/vec3.h"
#include "io/mesh_file.h"
#include "parallel/closest_face.h"
#include "parallel/intersections.h"
#include "tools/scale_bar.h"

namespace prcage {
namespace {

using Vec3f = Eigen::Vector3f;
using Vec2f = Eigen::Vector2f;

constexpr float pi = 3.14159265f;
constexpr float infinity = std::numeric_limits<float>::infinity();

// The scene is scaled to radius 1. Secondary rays start this far off the surface: far above float rounding there,
// far below anything that can be seen.
constexpr float ray_offset = 2e-4f;

// ---------------------------------------------------------------------------------------------------- colour

float to_linear(double srgb) {
  return static_cast<float>(srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4));
}

std::uint8_t to_srgb_byte(float linear) {
  const float x = std::clamp(linear, 0.0f, 1.0f);
  const float srgb = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255 * srgb));
}

Vec3f linear_color(const Color& c) { return {to_linear(c[0]), to_linear(c[1]), to_linear(c[2])}; }

float smoothstep(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

// -------------------------------------------------------------------------------------------------- sampling

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
Vec3f cosine_direction(const Frame& frame, const Vec2f& u) {
  const float r = std::sqrt(u.x()), angle = 2 * pi * u.y();
  return frame(r * std::cos(angle), r * std::sin(angle), std::sqrt(std::max(0.0f, 1 - u.x())));
}

// ---------------------------------------------------------------------------------------------------- bodies

struct DeviceDeleter {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneDeleter {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceDeleter>;
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneDeleter>;

// Moves the box of the scene to the origin and scales its diagonal to 2.
struct Placement {
  Vec3 centre;
  double scale;

  Vec3f operator()(const Position& p) const { return ((vec(p) - centre) * scale).cast<float>(); }
  Vec3 inverse(const Vec3f& p) const { return p.cast<double>() / scale + centre; }
};

struct Hit {
  float distance;
  std::uint32_t face;
  float u, v;  // weights of the face's second and third corner
};

// A mesh in scene coordinates with its ray-tracing scene.
class Body {
 public:
  Body(const Mesh& mesh, const Placement& place, RTCDevice device) : triangles_(mesh.triangles) {
    points_.reserve(mesh.positions.size() + 1);
    for (const Position& p : mesh.positions) points_.push_back(place(p));
    points_.push_back(Vec3f::Zero());  // Embree reads 16 bytes at the last vertex
    gather_incident_faces();
    build_scene(device);
  }

  std::size_t vertex_count() const { return points_.size() - 1; }
  const Vec3f& point(std::size_t v) const { return points_[v]; }
  const std::vector<Triangle>& triangles() const { return triangles_; }

  std::optional<Hit> intersect(const Vec3f& origin, const Vec3f& direction, float from, float to) const {
    RTCRayHit query{};
    query.ray = make_ray(origin, direction, from, to);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_.get(), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return Hit{query.ray.tfar, query.hit.primID, query.hit.u, query.hit.v};
  }

  bool occluded(const Vec3f& origin, const Vec3f& direction, float from, float to) const {
    RTCRay query = make_ray(origin, direction, from, to);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_.get(), &context, &query);
    return query.tfar < 0;
  }

  Vec3f face_normal(std::uint32_t face) const { return area_normal(face).normalized(); }

  // Interpolates normals that are averaged over the faces around a vertex which make no crease with the face.
  Vec3f smooth_normal(const Hit& hit) const {
    constexpr float crease_cosine = 0.5f;  // 60 degrees
    const Vec3f flat = face_normal(hit.face);
    const float weights[3] = {1 - hit.u - hit.v, hit.u, hit.v};
    Vec3f sum = Vec3f::Zero();
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t v = triangles_[hit.face][corner];
      Vec3f around = Vec3f::Zero();
      for (std::uint32_t i = first_face_[v]; i < first_face_[v + 1]; ++i) {
        const Vec3f normal = area_normal(incident_faces_[i]);
        if (normal.dot(flat) >= crease_cosine * normal.norm()) around += normal;
      }
      sum += weights[corner] * around.normalized();
    }
    return sum.norm() > 0 ? sum.normalized() : flat;
  }

 private:
  static RTCRay make_ray(const Vec3f& origin, const Vec3f& direction, float from, float to) {
    RTCRay ray{};
    ray.org_x = origin.x(), ray.org_y = origin.y(), ray.org_z = origin.z();
    ray.dir_x = direction.x(), ray.dir_y = direction.y(), ray.dir_z = direction.z();
    ray.tnear = from, ray.tfar = to;
    ray.mask = 0xffffffffu;
    return ray;
  }

  // Length is twice the area.
  Vec3f area_normal(std::uint32_t face) const {
    const Triangle& t = triangles_[face];
    return (points_[t[1]] - points_[t[0]]).cross(points_[t[2]] - points_[t[0]]);
  }

  void gather_incident_faces() {
    first_face_.assign(vertex_count() + 2, 0);
    for (const Triangle& t : triangles_) {
      for (std::uint32_t v : t) ++first_face_[v + 2];
    }
    for (std::size_t v = 2; v < first_face_.size(); ++v) first_face_[v] += first_face_[v - 1];
    incident_faces_.resize(3 * triangles_.size());
    for (std::uint32_t f = 0; f < triangles_.size(); ++f) {
      for (std::uint32_t v : triangles_[f]) incident_faces_[first_face_[v + 1]++] = f;
    }
  }

  void build_scene(RTCDevice device) {
    scene_.reset(rtcNewScene(device));
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, points_.data(), 0, sizeof(Vec3f),
                               vertex_count());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles_.data(), 0,
                               sizeof(Triangle), triangles_.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_.get());
  }

  std::vector<Vec3f> points_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> first_face_, incident_faces_;  // around vertex v: from first_face_[v] to first_face_[v+1]
  Scene scene_;
};

// The distance of points of the scene to the input, as colours.
class DistanceColors {
 public:
  // `largest`, where the scale ends, is in the unit of the input.
  DistanceColors(const Mesh& input, const Placement& place, double largest)
      : place_(place), largest_(largest), tree_(device_) {
    tree_.build(unit_frame(input.positions), input.positions, input.triangles);
  }

  Vec3f operator()(const Vec3f& point) const {
    const ClosestFace closest(tree_);
    const double distance = closest.nearest(place_.inverse(point)).distance;
    return linear_color(scale_color(largest_ > 0 ? distance / largest_ : 0));
  }

 private:
  Placement place_;
  double largest_;
  TreeDevice device_;
  SurfaceTree tree_;
};

// ---------------------------------------------------------------------------------------------------- camera

// Perspective camera for one panel, in samples: x to the right, y down, from the panel's upper left corner.
class Camera {
 public:
  Camera(const RenderOptions& options, int columns, int rows)
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

  // Backs off and shifts sideways until all points are inside, with a margin. Centring changes the distance that is
  // needed and the reverse; a few rounds settle it.
  void fit(const std::vector<const Body*>& bodies) {
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

  const Vec3f& eye() const { return eye_; }
  const Vec3f& right() const { return right_; }
  const Vec3f& back() const { return back_; }
  const Vec3f& world_up() const { return world_up_; }

  Vec3f direction(float x, float y) const {
    const float a = (2 * x / columns_ - 1) * tan_x_, b = (1 - 2 * y / rows_) * tan_y_;
    return (a * right_ + b * up_ - back_).normalized();
  }

  // Sample coordinates and the depth along the view.
  Vec3f project(const Vec3f& point) const {
    const Vec3f d = point - eye_;
    const float depth = -d.dot(back_);
    return {(1 + d.dot(right_) / (depth * tan_x_)) * columns_ / 2, (1 - d.dot(up_) / (depth * tan_y_)) * rows_ / 2,
            depth};
  }

  // 1 in the middle of the panel, 0 at its left and right border and below.
  float inset(const Vec3f& point) const {
    const Vec3f p = project(point);
    const float side = std::min(p.x(), columns_ - p.x()) / columns_, bottom = (rows_ - p.y()) / rows_;
    return smoothstep(0, 0.12f, side) * smoothstep(0, 0.08f, bottom);
  }

 private:
  static constexpr float tan_half_view = 0.21f;  // 24 degrees: little distortion, still depth
  static constexpr float margin = 1.12f;

  // Calls visit(x, y, towards the camera) relative to the target.
  template <class Visit>
  void for_each_point(const std::vector<const Body*>& bodies, const Vec3f& target, const Visit& visit) const {
    for (const Body* body : bodies) {
      for (std::size_t v = 0; v < body->vertex_count(); ++v) {
        const Vec3f d = body->point(v) - target;
        visit(Vec3f(d.dot(right_), d.dot(up_), d.dot(back_)));
      }
    }
  }

  float distance_for(const std::vector<const Body*>& bodies, const Vec3f& target) const {
    float distance = 0;
    for_each_point(bodies, target, [&](const Vec3f& p) {
      const float needed = std::max(std::abs(p.x()) / tan_x_, std::abs(p.y()) / tan_y_);
      distance = std::max(distance, p.z() + margin * needed);
    });
    return distance;
  }

  float columns_, rows_, tan_x_ = 0, tan_y_ = 0;
  Vec3f eye_ = Vec3f::Zero(), right_, up_, back_, world_up_;
};

// ----------------------------------------------------------------------------------------------------- wires

enum class Wire : std::uint8_t { none, back, front };  // back: seen through the shell

struct ProjectedEdge {
  Vec3f from, to;  // sample coordinates and depth
  Vec3f from_point, to_point;
};

std::vector<ProjectedEdge> project_edges(const Body& body, const Camera& camera) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;
  for (const Triangle& t : body.triangles()) {
    for (std::size_t i = 0; i < 3; ++i) ends.push_back(std::minmax(t[i], t[(i + 1) % 3]));
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  std::vector<ProjectedEdge> edges;
  edges.reserve(ends.size());
  for (const auto& [a, b] : ends) {
    edges.push_back({camera.project(body.point(a)), camera.project(body.point(b)), body.point(a), body.point(b)});
  }
  return edges;
}

// ---------------------------------------------------------------------------------------------------- panels

struct Panel {
  const Body* opaque = nullptr;
  const Body* shell = nullptr;  // translucent, may be null
  const Body* wired = nullptr;  // its edges are drawn, may be null
  bool smooth = false;
  Vec3f color;
  const DistanceColors* distance = nullptr;  // colours the opaque body instead of `color`, may be null
};

// What is common to all panels.
struct Style {
  Vec3f shell_color, line_color;
  bool shadow;
  float line_width;  // in samples
  int samples;
};

class PanelRenderer {
 public:
  PanelRenderer(const Panel& panel, const Style& style, const Camera& camera, int width)
      : panel_(panel), style_(style), camera_(camera), width_(width) {
    if (panel.wired != nullptr) edges_ = project_edges(*panel.wired, camera);
    const Vec3f &side = camera.right(), &up = camera.world_up(), &front = camera.back();
    key_ = (-0.55f * side + 0.95f * up + 0.65f * front).normalized();
    fill_ = (0.9f * side + 0.25f * up + 0.55f * front).normalized();
    rim_ = (0.3f * side + 0.6f * up - 0.9f * front).normalized();
    const Body& caster = shadow_caster();
    floor_ = infinity;
    for (std::size_t v = 0; v < caster.vertex_count(); ++v) floor_ = std::min(floor_, caster.point(v).dot(up));
  }

  // Rows [first, last) of pixels; put(x, y, linear colour) takes the result.
  template <class Put>
  void render_rows(int first, int last, const Put& put) const {
    const std::vector<Wire> wires = mark_wires(first * style_.samples, last * style_.samples);
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < width_; ++x) put(x, y, render_pixel(x, y, first * style_.samples, wires));
    }
  }

 private:
  const Body& shadow_caster() const { return panel_.shell != nullptr ? *panel_.shell : *panel_.opaque; }

  // The wires on the samples of a band of sample rows.
  std::vector<Wire> mark_wires(int first_row, int last_row) const {
    const int columns = width_ * style_.samples;
    const auto offset = [&](int row) {
      return static_cast<std::size_t>(row - first_row) * static_cast<std::size_t>(columns);
    };
    std::vector<Wire> wires(offset(last_row), Wire::none);
    const float radius = style_.line_width / 2;
    for (const ProjectedEdge& edge : edges_) {
      const auto [low, high] = std::minmax({edge.from.y(), edge.to.y()});
      const int begin = std::max(first_row, static_cast<int>(std::floor(low - radius)));
      const int end = std::min(last_row, static_cast<int>(std::ceil(high + radius)));
      for (int row = begin; row < end; ++row) mark_row(edge, row, columns, &wires[offset(row)]);
    }
    return wires;
  }

  // Marks the samples of one row that are within half a line width of the edge.
  void mark_row(const ProjectedEdge& edge, int row, int columns, Wire* wires) const {
    const float radius = style_.line_width / 2, y = static_cast<float>(row) + 0.5f;
    const Vec2f a = edge.from.head<2>(), along = edge.to.head<2>() - a;
    // The part of the edge that is at most a radius above or below the row bounds the columns.
    float s0 = 0, s1 = 1;
    if (along.y() != 0) {
      const float t0 = (y - radius - a.y()) / along.y(), t1 = (y + radius - a.y()) / along.y();
      s0 = std::clamp(std::min(t0, t1), 0.0f, 1.0f);
      s1 = std::clamp(std::max(t0, t1), 0.0f, 1.0f);
    }
    const float x0 = a.x() + s0 * along.x(), x1 = a.x() + s1 * along.x();
    const int begin = std::max(0, static_cast<int>(std::floor(std::min(x0, x1) - radius)));
    const int end = std::min(columns, static_cast<int>(std::ceil(std::max(x0, x1) + radius)));
    const float length_squared = std::max(along.squaredNorm(), 1e-12f);
    for (int column = begin; column < end; ++column) {
      const Vec2f offset = Vec2f(static_cast<float>(column) + 0.5f, y) - a;
      const float s = std::clamp(offset.dot(along) / length_squared, 0.0f, 1.0f);
      if (wires[column] == Wire::front || (offset - s * along).squaredNorm() > radius * radius) continue;
      wires[column] = std::max(wires[column], visibility(edge, s));
    }
  }

  // How the edge is seen at the share s of its length on the screen.
  Wire visibility(const ProjectedEdge& edge, float s) const {
    const float t = s * edge.from.z() / ((1 - s) * edge.to.z() + s * edge.from.z());
    const Vec3f ray = edge.from_point + t * (edge.to_point - edge.from_point) - camera_.eye();
    // Short of the edge itself, so that its own faces do not hide it.
    constexpr float nearly = 1 - 3 * ray_offset;
    if (panel_.opaque->occluded(camera_.eye(), ray, 0, nearly)) return Wire::none;
    if (panel_.shell != nullptr && panel_.shell->occluded(camera_.eye(), ray, 0, nearly)) return Wire::back;
    return Wire::front;
  }

  Vec3f render_pixel(int x, int y, int first_row, const std::vector<Wire>& wires) const {
    const int n = style_.samples;
    PixelSequence sequence(x, y);
    Vec3f sum = Vec3f::Zero();
    for (int row = y * n; row < (y + 1) * n; ++row) {
      for (int column = x * n; column < (x + 1) * n; ++column) {
        const auto entry = static_cast<std::size_t>(row - first_row) * static_cast<std::size_t>(width_ * n);
        const Vec3f ray = camera_.direction(static_cast<float>(column) + 0.5f, static_cast<float>(row) + 0.5f);
        sum += over_wire(wires[entry + static_cast<std::size_t>(column)], shade(ray, sequence));
      }
    }
    return sum / static_cast<float>(n * n);
  }

  Vec3f over_wire(Wire wire, const Vec3f& color) const {
    if (wire == Wire::none) return color;
    const float opacity = wire == Wire::front ? 0.92f : 0.3f;
    return (1 - opacity) * color + opacity * style_.line_color;
  }

  Vec3f shade(const Vec3f& ray, PixelSequence& sequence) const {
    const std::optional<Hit> hit = panel_.opaque->intersect(camera_.eye(), ray, 0, infinity);
    const Vec3f behind = hit ? shade_surface(ray, *hit, sequence) : shade_floor(ray, sequence);
    return panel_.shell == nullptr ? behind : over_shell(ray, hit ? hit->distance : infinity, behind);
  }

  // Lays the sheets of the shell over what is behind them. They are denser where they are seen edge-on, as glass is.
  Vec3f over_shell(const Vec3f& ray, float end, const Vec3f& behind) const {
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

  Vec3f shade_surface(const Vec3f& ray, const Hit& hit, PixelSequence& sequence) const {
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
  Vec3f shade_floor(const Vec3f& ray, PixelSequence& sequence) const {
    const Vec3f white = Vec3f::Ones();
    const Vec3f& up = camera_.world_up();
    const float slope = ray.dot(up), height = floor_ - camera_.eye().dot(up);
    if (!style_.shadow || slope > -1e-3f || height > 0) return white;
    const Vec3f point = camera_.eye() + height / slope * ray;
    const float strength = (1 - smoothstep(0.35f, 1.05f, (point - point.dot(up) * up).norm())) * camera_.inset(point);
    if (strength <= 0) return white;
    const Vec3f start = point + ray_offset * up;
    const Body& caster = shadow_caster();
    const float closed = 1 - openness(caster, start, up, 0.45f, sequence),
                dark = 1 - key_light(caster, start, sequence);
    return white - strength * (0.62f * closed + 0.10f * dark) * Vec3f(1.0f, 0.98f, 0.95f);
  }

  // Share of the hemisphere, by cosine, that is free within a radius.
  float openness(const Body& body, const Vec3f& point, const Vec3f& normal, float reach,
                 PixelSequence& sequence) const {
    constexpr int rays = 5;
    const Frame frame(normal);
    int free = 0;
    for (int i = 0; i < rays; ++i) {
      if (!body.occluded(point, cosine_direction(frame, sequence.hemisphere.next()), 0, reach)) ++free;
    }
    return static_cast<float>(free) / rays;
  }

  // Share of a round area light that is visible.
  float key_light(const Body& body, const Vec3f& point, PixelSequence& sequence) const {
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

  const Panel& panel_;
  const Style& style_;
  const Camera& camera_;
  int width_;
  std::vector<ProjectedEdge> edges_;
  Vec3f key_, fill_, rim_;
  float floor_ = 0;
};

// ------------------------------------------------------------------------------------------------- a picture

std::vector<Panel> make_panels(const Body& input, const Body* cage, const DistanceColors* distance,
                               const RenderOptions& options) {
  const Vec3f input_color = linear_color(options.input_color), cage_color = linear_color(options.cage_color);
  const Panel plain{&input, nullptr, nullptr, options.smooth, input_color};
  if (cage == nullptr) return {plain};
  const Panel caged{&input, cage, cage, options.smooth, input_color};
  const Panel alone{cage, nullptr, cage, false, cage_color, distance};
  if (!options.panels) return {distance != nullptr ? alone : caged};
  return {plain, caged, alone};
}

// Draws a panel into columns [left, left + width) of the picture.
void draw_panel(const Panel& panel, const Style& style, const Camera& camera, int left, int width, Picture& picture) {
  constexpr int band = 8;
  const PanelRenderer renderer(panel, style, camera, width);
  tbb::parallel_for(0, (picture.height + band - 1) / band, [&](int b) {
    renderer.render_rows(b * band, std::min((b + 1) * band, picture.height), [&](int x, int y, const Vec3f& color) {
      std::uint8_t* const pixel = picture.pixel(left + x, y);
      for (int channel = 0; channel < 3; ++channel) pixel[channel] = to_srgb_byte(color[channel]);
    });
  });
}

Placement place_in_unit_ball(const Mesh& input, const Mesh* cage) {
  Eigen::AlignedBox3d box;
  for (const Mesh* mesh : {&input, cage}) {
    if (mesh == nullptr) continue;
    for (const Position& p : mesh->positions) box.extend(vec(p));
  }
  const double diagonal = box.diagonal().norm();
  return {box.center(), diagonal > 0 ? 2 / diagonal : 1};
}

Picture render(const Mesh& input, const Mesh* cage, const RenderOptions& options) {
  const Device device(rtcNewDevice(nullptr));
  const Placement place = place_in_unit_ball(input, cage);
  const Body input_body(input, place, device.get());
  std::optional<Body> cage_body;
  if (cage != nullptr) cage_body.emplace(*cage, place, device.get());
  const Body* const cage_or_null = cage_body ? &*cage_body : nullptr;
  std::optional<DistanceColors> distance;
  if (cage != nullptr && options.distance_max > 0)
    distance.emplace(input, place, options.distance_max * extent(input.positions).diagonal());

  const std::vector<Panel> panels = make_panels(input_body, cage_or_null, distance ? &*distance : nullptr, options);
  const int count = static_cast<int>(panels.size());
  const int width = (options.width - (distance ? scale_bar_width(options.width, options.height) : 0)) / count;
  Camera camera(options, width * options.samples, options.height * options.samples);
  camera.fit(cage_or_null != nullptr ? std::vector{&input_body, cage_or_null} : std::vector{&input_body});

  const Style style{linear_color(options.cage_color), linear_color(options.line_color), options.shadow,
                    static_cast<float>(options.line_width * options.samples), options.samples};
  const std::size_t pixels = static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
  Picture picture{options.width, options.height, std::vector<std::uint8_t>(3 * pixels, 255)};
  int left = 0;
  for (const Panel& panel : panels) {
    draw_panel(panel, style, camera, left, width, picture);
    left += width;
  }
  if (distance) draw_scale_bar(picture, options.distance_max);
  return picture;
}

// ------------------------------------------------------------------------------------------------------ file

bool encode_png(const Picture& picture, std::vector<std::uint8_t>& bytes, std::string& error) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  bytes.resize(size);
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.rgb.data(), 0, nullptr) == 0) {
    error = std::string("cannot encode the picture: ") + image.message;
    return false;
  }
  bytes.resize(size);
  return true;
}

bool check_options(const RenderOptions& options, std::string& error) {
  const auto in_range = [](double x, double low, double high) { return x >= low && x <= high; };
  if (!in_range(options.width, 16, 16384) || !in_range(options.height, 16, 16384)) {
    error = "width and height must be 16 to 16384 pixels";
  } else if (!in_range(options.samples, 1, 16)) {
    error = "samples must be 1 to 16";
  } else if (!in_range(options.line_width, 0, 100)) {
    error = "line width must be 0 to 100 pixels";
  } else if (!(options.distance_max >= 0 && std::isfinite(options.distance_max))) {
    error = "the end of the scale of distances must be a finite number, not negative";
  } else if (options.distance_max > 0 && options.width < least_width_with_scale) {
    error = fmt::format("a picture with a scale must be at least {} pixels wide", least_width_with_scale);
  } else if (!in_range(options.elevation, -90, 90) || !std::isfinite(options.azimuth)) {
    error = "elevation must be -90 to 90 degrees and azimuth finite";
  } else {
    return true;
  }
  return false;
}

bool check_mesh(const Mesh& mesh, const std::string& name, std::string& error) {
  const auto finite = [](const Position& p) { return vec(p).allFinite(); };
  const auto in_range = [&](const Triangle& t) { return std::max({t[0], t[1], t[2]}) < mesh.positions.size(); };
  if (mesh.triangles.empty()) {
    error = "the " + name + " has no faces";
  } else if (!std::all_of(mesh.triangles.begin(), mesh.triangles.end(), in_range)) {
    error = "the " + name + " has a face with a vertex that does not exist";
  } else if (!std::all_of(mesh.positions.begin(), mesh.positions.end(), finite)) {
    error = "the " + name + " has a position that is not finite";
  } else {
    return true;
  }
  return false;
}

}  // namespace

bool render_png(const Mesh& input, const Mesh* cage, const RenderOptions& options, const std::string& path,
                std::string& error) {
  if (!check_options(options, error) || !check_mesh(input, "input", error)) return false;
  if (cage != nullptr && !check_mesh(*cage, "cage", error)) return false;
  // An arena of our own: Embree changes floating-point modes on workers, and those must not be the caller's. Embree
  // also limits the process to the machine's threads, and TBB complains about an arena of more.
  const int machine = tbb::info::default_concurrency();
  tbb::task_arena arena(options.threads > 0 ? std::min(options.threads, machine) : machine);
  const Picture picture = arena.execute([&] { return render(input, cage, options); });
  std::vector<std::uint8_t> bytes;
  if (!encode_png(picture, bytes, error)) return false;
  const WriteResult written = write_file(path, bytes.data(), bytes.size());
  if (!written.ok) error = written.error;
  return written.ok;
}

}  // namespace prcage
