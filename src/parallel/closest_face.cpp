#include "parallel/closest_face.h"

#include <array>
#include <cmath>
#include <limits>

namespace prcage {
namespace {

// Squared distances are compared: their roots would make ties of distances that differ.
struct Query {
  const ClosestFace* faces;
  const BoxRuns* runs;
  Vec3 x;
  std::array<float, 3> x_in_frame;
  double scale;  // of the frame
  std::uint32_t face = none;
  double squared = std::numeric_limits<double>::infinity();

  // In the frame. A little too large, so that faces at equal distance are all seen and the lowest wins.
  float radius() const { return static_cast<float>(std::sqrt(squared) * scale) * 1.00001f + 1e-6f; }
};

// Embree calls this for runs whose box may be within the radius, which shrinks as better faces turn up.
bool visit_run(RTCPointQueryFunctionArguments* args) {
  auto& query = *static_cast<Query*>(args->userPtr);
  float radius = args->query->radius;
  query.runs->for_each_nearer(args->primID, query.x_in_frame, radius * radius, [&](std::uint32_t face) {
    const double squared = query.faces->distance_from(face).squared(query.x);
    if (squared < query.squared || (squared == query.squared && face < query.face)) {
      query.face = face;
      query.squared = squared;
      radius = query.radius();
    }
    return radius * radius;
  });
  const bool smaller = radius < args->query->radius;
  args->query->radius = radius;
  return smaller;
}

}  // namespace

TriangleDistance ClosestFace::distance_from(std::uint32_t face) const {
  return {corner(face, 0), corner(face, 1), corner(face, 2)};
}

double ClosestFace::distance_to_face(const Vec3& x, std::uint32_t face) const {
  return std::sqrt(distance_from(face).squared(x));
}

Vec3 ClosestFace::nearest_point(const Vec3& x, std::uint32_t face) const {
  const auto weights = distance_from(face).nearest_weights(x);
  Vec3 point = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) point += weights[k] * corner(face, k);
  return point;
}

Vec3 ClosestFace::area_normal(std::uint32_t face) const {
  const Vec3 a = corner(face, 0);
  return (corner(face, 1) - a).cross(corner(face, 2) - a);
}

bool ClosestFace::behind_face(const Vec3& x, std::uint32_t face) const {
  return area_normal(face).dot(x - corner(face, 0)) < 0;
}

ClosestFace::Near ClosestFace::nearest(const Vec3& x, std::uint32_t hint) const {
  const UnitFrame& frame = surface_->frame();
  const Vec3 y = (x - frame.centre) * frame.scale;
  Query state{this,
              &surface_->runs(),
              x,
              {static_cast<float>(y.x()), static_cast<float>(y.y()), static_cast<float>(y.z())},
              frame.scale};
  if (hint != none) {
    state.face = hint;
    state.squared = distance_from(hint).squared(x);
  }
  RTCPointQuery query{state.x_in_frame[0], state.x_in_frame[1], state.x_in_frame[2], 0, state.radius()};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(surface_->runs().tree().scene(), &query, &context, visit_run, &state);
  return {state.face, std::sqrt(state.squared)};
}

}  // namespace prcage
