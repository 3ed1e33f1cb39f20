// The input as an obstacle to the cage: what the cage must keep enclosed.
//
// Patches that touch nothing can still leave a whole component of the input on the wrong side, if it lies between the
// old faces and the new ones: a collapse beside a small part would take it in, a move inward would leave it behind.
#pragma once

#include <vector>

#include "core/surface.h"
#include "parallel/intersections.h"
#include "parallel/patches.h"

namespace prcage {

class Obstacle {
 public:
  // Both must outlive this. The boxes of patches must be in the frame of the surface.
  Obstacle(const SurfaceTree& surface, const Components& components, const TreeDevice& device);

  // Rejects patches whose faces touch the surface. Exact.
  void reject_hits(const CageState& state, PatchBatch& batch) const;
  // Rejects patches that sweep over a whole component. Components do not touch the cage, before or after.
  void reject_sweeps(const CageState& state, PatchBatch& batch) const;

  std::size_t components() const { return component_box_.size(); }

 private:
  const SurfaceTree& surface_;
  const TreeDevice& device_;
  std::vector<Position> component_point_;
  std::vector<Box> component_box_;
  BoxTree component_tree_;
};

// The same where the components of the surface itself are in each other's way and all of them move: rejects patches
// that sweep over a whole component as it is now. Those of the same round cannot interfere: no patch moves a whole
// component, and what it leaves of one is on the side of another patch on which all of it is, since nothing of it
// touches that.
void reject_sweeps_of_components(const CageState& state, const TreeDevice& device, PatchBatch& batch);

}  // namespace prcage
