// Strict tolerances that differ on the two sides of the input: a point of the surface that is farther from the input
// than the narrower one allows must be on the side of the wider one.
//
// A new face is divided into pieces until each is either within the narrower tolerance of one input face, as far as all
// its points go, or farther from the input than its own radius. The latter do not touch the input, so that one point
// tells the side of all of them; the exact winding number of the input there decides.
#pragma once

#include <vector>

#include "parallel/distance_band.h"
#include "parallel/intersections.h"
#include "parallel/patches.h"

namespace prcage {

class SideTest {
 public:
  // All must outlive this.
  SideTest(const SurfaceTree& input, const DistanceBand& band, const TreeDevice& device)
      : input_(input), band_(band), device_(device) {}

  // Rejects patches of which it is not proved that they keep to the tolerances of their side. That they keep to the
  // wider one must be known.
  void reject_wrong_sides(const CageState& state, const BandLimits& limits, PatchBatch& batch) const;

 private:
  // Points that stand for the pieces of a face; false if it is on the wrong side, or that cannot be told.
  bool add_points(const TriangleRef& face, std::uint32_t near, double narrow, bool inside,
                  std::vector<Position>& points) const;

  const SurfaceTree& input_;
  const DistanceBand& band_;
  const TreeDevice& device_;
};

}  // namespace prcage
