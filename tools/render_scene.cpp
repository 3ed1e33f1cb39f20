#include "tools/render_scene.h"

#include "parallel/closest_face.h"
#include "parallel/surface_tree.h"
#include "tools/scale_bar.h"

namespace prcage::raycast {
namespace {

RTCRay make_ray(const Vec3f& origin, const Vec3f& direction, float from, float to) {
  RTCRay ray{};
  ray.org_x = origin.x(), ray.org_y = origin.y(), ray.org_z = origin.z();
  ray.dir_x = direction.x(), ray.dir_y = direction.y(), ray.dir_z = direction.z();
  ray.tnear = from, ray.tfar = to;
  ray.mask = 0xffffffffu;
  return ray;
}

}  // namespace

Placement place_in_unit_ball(const Mesh& input, const Mesh* cage) {
  Eigen::AlignedBox3d box;
  for (const Mesh* mesh : {&input, cage}) {
    if (mesh == nullptr) continue;
    for (const Position& p : mesh->positions) box.extend(vec(p));
  }
  const double diagonal = box.diagonal().norm();
  return {box.center(), diagonal > 0 ? 2 / diagonal : 1};
}

Body::Body(const Mesh& mesh, const Placement& place, RTCDevice device) : triangles_(mesh.triangles) {
  points_.reserve(mesh.positions.size() + 1);
  for (const Position& p : mesh.positions) points_.push_back(place(p));
  points_.push_back(Vec3f::Zero());  // Embree reads 16 bytes at the last vertex
  gather_incident_faces();
  build_scene(device);
}

std::optional<Hit> Body::intersect(const Vec3f& origin, const Vec3f& direction, float from, float to) const {
  RTCRayHit query{};
  query.ray = make_ray(origin, direction, from, to);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene_.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return Hit{query.ray.tfar, query.hit.primID, query.hit.u, query.hit.v};
}

bool Body::occluded(const Vec3f& origin, const Vec3f& direction, float from, float to) const {
  RTCRay query = make_ray(origin, direction, from, to);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene_.get(), &context, &query);
  return query.tfar < 0;
}

Vec3f Body::smooth_normal(const Hit& hit) const {
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

Vec3f Body::area_normal(std::uint32_t face) const {
  const Triangle& t = triangles_[face];
  return (points_[t[1]] - points_[t[0]]).cross(points_[t[2]] - points_[t[0]]);
}

void Body::gather_incident_faces() {
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

void Body::build_scene(RTCDevice device) {
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

struct DistanceColors::Surface {
  TreeDevice device;
  SurfaceTree tree{device};
};

DistanceColors::DistanceColors(const Mesh& input, const Placement& place, double largest)
    : place_(place), largest_(largest), surface_(std::make_unique<Surface>()) {
  surface_->tree.build(unit_frame(input.positions), input.positions, input.triangles);
}

DistanceColors::~DistanceColors() = default;

Vec3f DistanceColors::operator()(const Vec3f& point) const {
  const ClosestFace closest(surface_->tree);
  const double distance = closest.nearest(place_.inverse(point)).distance;
  return linear_color(scale_color(largest_ > 0 ? distance / largest_ : 0));
}

}  // namespace prcage::raycast
