// The closest face of a surface. Embree finds the candidates by their boxes in single precision; every candidate is
// measured in double precision, and ties go to the lowest face, so that the answer depends on nothing but the surface.
#pragma once

#include <cstdint>
#include <span>

#include "core/adjacency.h"
#include "core/distance.h"
#include "parallel/surface_tree.h"

namespace prcage {

class ClosestFace {
 public:
  // A face of the surface and the distance from the query point to it.
  struct Near {
    std::uint32_t face;
    double distance;
  };

  // The surface must outlive this. Points far outside of its frame's scene are beyond single precision.
  explicit ClosestFace(const SurfaceTree& surface) : surface_(&surface) {}

  // A face that is near already saves time and does not change the answer. Thread-safe.
  Near nearest(const Vec3& x, std::uint32_t hint = none) const;

  double distance_to_face(const Vec3& x, std::uint32_t face) const;
  // The point of the face that is nearest to x.
  Vec3 nearest_point(const Vec3& x, std::uint32_t face) const;
  // Normal of the face, twice as long as its area is large.
  Vec3 area_normal(std::uint32_t face) const;
  // Is x on the inner side of the plane of the face?
  bool behind_face(const Vec3& x, std::uint32_t face) const;
  TriangleDistance distance_from(std::uint32_t face) const;

 private:
  Vec3 corner(std::uint32_t face, std::size_t i) const {
    return vec(surface_->positions()[surface_->triangles()[face][i]]);
  }

  const SurfaceTree* surface_;
};

}  // namespace prcage
