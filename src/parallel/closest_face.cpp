#include "parallel/closest_face.h"

#include <cmath>
#include <limits>

namespace prcage {
namespace {

// Squared distances are compared: their roots would make ties of distances that differ.
struct Query {
  const ClosestFace* faces;
  Vec3 x;
  double scale;  // of the frame of the tree
  std::uint32_t face = none;
  double squared = std::numeric_limits<double>::infinity();
};

// A little too large, so that faces at equal distance are all seen and the lowest wins.
float search_radius(const Query& query) {
  return static_cast<float>(std::sqrt(query.squared) * query.scale) * 1.00001f + 1e-6f;
}

// Embree calls this for faces whose box may be within the radius, which shrinks as better faces turn up.
bool visit_face(RTCPointQueryFunctionArguments* args) {
  auto& query = *static_cast<Query*>(args->userPtr);
  const double squared = query.faces->distance_from(args->primID).squared(query.x);
  if (squared > query.squared || (squared == query.squared && args->primID > query.face)) return false;
  query.face = args->primID;
  query.squared = squared;
  args->query->radius = search_radius(query);
  return true;
}

}  // namespace

TriangleDistance ClosestFace::distance_from(std::uint32_t face) const {
  const Triangle& t = triangles_[face];
  return {vec(positions_[t[0]]), vec(positions_[t[1]]), vec(positions_[t[2]])};
}

double ClosestFace::distance_to_face(const Vec3& x, std::uint32_t face) const {
  return std::sqrt(distance_from(face).squared(x));
}

Vec3 ClosestFace::nearest_point(const Vec3& x, std::uint32_t face) const {
  const auto weights = distance_from(face).nearest_weights(x);
  Vec3 point = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) point += weights[k] * vec(positions_[triangles_[face][k]]);
  return point;
}

Vec3 ClosestFace::area_normal(std::uint32_t face) const {
  const Triangle& t = triangles_[face];
  const Vec3 a = vec(positions_[t[0]]);
  return (vec(positions_[t[1]]) - a).cross(vec(positions_[t[2]]) - a);
}

bool ClosestFace::behind_face(const Vec3& x, std::uint32_t face) const {
  return area_normal(face).dot(x - vec(positions_[triangles_[face][0]])) < 0;
}

ClosestFace::Near ClosestFace::nearest(const Vec3& x, std::uint32_t hint) const {
  const Vec3 y = (x - frame_.centre) * frame_.scale;
  RTCPointQuery query;
  query.x = static_cast<float>(y.x());
  query.y = static_cast<float>(y.y());
  query.z = static_cast<float>(y.z());
  query.time = 0;
  query.radius = std::numeric_limits<float>::infinity();
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  Query state{this, x, frame_.scale};
  if (hint != none) {
    state.face = hint;
    state.squared = distance_from(hint).squared(x);
    query.radius = search_radius(state);
  }
  rtcPointQuery(tree_->scene(), &query, &context, visit_face, &state);
  return {state.face, std::sqrt(state.squared)};
}

}  // namespace prcage
