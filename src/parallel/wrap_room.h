// How far the faces of a surface may go outward before they leave a wrap of the input (paper eq. 10): the wrap passes
// over hollows, which may be filled up to it, and lies close to all that is convex. A guide for placements, not a
// proof.
#pragma once

#include "parallel/closest_face.h"
#include "parallel/intersections.h"
#include "parallel/patches.h"

namespace prcage {

class WrapRoom {
 public:
  // The tree, with one for point queries, must outlive this.
  explicit WrapRoom(const SurfaceTree& wrap) : closest_(wrap) {}

  // Of a point: how far inside of the wrap it is.
  float at(const Vec3& x) const;

  // Writes face_room, of all faces or of those of the accepted patches, which must have been committed.
  void measure(CageState& state) const;
  void measure(const PatchBatch& batch, CageState& state) const;

 private:
  float at(const CornerTable& mesh, std::uint32_t face) const;

  ClosestFace closest_;
};

}  // namespace prcage
