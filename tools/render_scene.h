// The meshes of a picture, placed within the unit ball, with what rays find of them (Embree), and how far points of
// them are from the input.
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <type_traits>
#include <vector>

#include "core/prcage.h"
#include "core/vec3.h"
#include "tools/render_math.h"

namespace prcage::raycast {

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

// `cage` may be null.
Placement place_in_unit_ball(const Mesh& input, const Mesh* cage);

struct Hit {
  float distance;
  std::uint32_t face;
  float u, v;  // weights of the face's second and third corner
};

// A mesh in scene coordinates with its ray-tracing scene.
class Body {
 public:
  Body(const Mesh& mesh, const Placement& place, RTCDevice device);

  std::size_t vertex_count() const { return points_.size() - 1; }
  const Vec3f& point(std::size_t v) const { return points_[v]; }
  const std::vector<Triangle>& triangles() const { return triangles_; }

  std::optional<Hit> intersect(const Vec3f& origin, const Vec3f& direction, float from, float to) const;
  bool occluded(const Vec3f& origin, const Vec3f& direction, float from, float to) const;

  Vec3f face_normal(std::uint32_t face) const { return area_normal(face).normalized(); }

  // Interpolates normals that are averaged over the faces around a vertex which make no crease with the face.
  Vec3f smooth_normal(const Hit& hit) const;

 private:
  Vec3f area_normal(std::uint32_t face) const;  // its length is twice the area
  void gather_incident_faces();
  void build_scene(RTCDevice device);

  std::vector<Vec3f> points_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> first_face_, incident_faces_;  // around vertex v: from first_face_[v] to first_face_[v+1]
  Scene scene_;
};

// The distance of points of the scene to the input, as colours.
class DistanceColors {
 public:
  // `largest`, where the scale ends, is in the unit of the input.
  DistanceColors(const Mesh& input, const Placement& place, double largest);
  ~DistanceColors();

  Vec3f operator()(const Vec3f& point) const;

 private:
  struct Surface;  // the input, to be asked for distances

  Placement place_;
  double largest_;
  std::unique_ptr<Surface> surface_;
};

}  // namespace prcage::raycast
