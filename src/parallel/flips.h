// Edge flips after the collapses of a cycle (paper sec. 3.2, "Edge-flip Stage"): rounds of independent flips that raise
// the smallest angle of their quadrilateral, add volume on the outside only and stay within the band. When a cage is
// tightened, flips that take volume away come as well: as moves inward they must touch nothing of the obstacle.
#pragma once

#include "parallel/cage_state.h"
#include "parallel/coverage.h"
#include "parallel/obstacle.h"
#include "parallel/side_test.h"
#include "parallel/wrap_room.h"

namespace prcage {

enum class FlipGoal { angle, volume, fit };

struct FlipSettings {
  BandLimits limits;
  std::uint64_t seed = 0;
  Coverage* coverage = nullptr;        // if samples of the input are to stay within limits.centroids
  const Obstacle* obstacle = nullptr;  // if a flip might take in a component, or takes volume away
  const SideTest* side_test = nullptr;
  FlipGoal goal = FlipGoal::angle;
  // Degrees. Smallest angles of this size are wide enough: they are not raised for their own sake, and the other goals
  // may be followed as long as they stay so.
  double wide_enough = 180;
  const WrapRoom* room = nullptr;
  double misfit_unit = 1;  // see misfit.h
};

// Flips until no flip is left, or the caller cancels. The cage is valid after every round.
void flip_edges(CageState& state, const FlipSettings& settings, const UnitFrame& frame, const TreeDevice& device,
                DistanceBand& band, const Control* control, Counts& counts);

}  // namespace prcage
