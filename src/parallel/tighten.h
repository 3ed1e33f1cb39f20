// Tightening: vertices of the cage move inward, off the slack that collapses leave behind, since those only ever move
// outward. The cage stays valid: a move is kept only if, exactly, the new star touches neither the obstacle nor the
// rest of the cage, and no whole component of the obstacle may lie between the old star and the new one. The obstacle
// was inside before and cannot get out without touching the surface.
#pragma once

#include <cstdint>

#include "parallel/coverage.h"
#include "parallel/obstacle.h"

namespace prcage {

struct TightenSettings {
  BandLimits limits;
  int passes = 1;
  // Moves shorter than this, input's unit, are not worth their tests.
  double shortest = 0;
  bool float_positions = false;
  std::uint64_t seed = 0;
  Coverage* coverage = nullptr;  // if samples of the input are to stay within limits.centroids
};

// Returns the number of moves. The cage is valid after every round. Runs inside an Arena.
std::size_t tighten(CageState& state, const TightenSettings& settings, const Obstacle& obstacle, const UnitFrame& frame,
                    const TreeDevice& device, DistanceBand& band, const Control* control);

}  // namespace prcage
