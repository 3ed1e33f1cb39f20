// Tightening: vertices of the cage move inward and edges flip inward, off the slack that collapses leave behind, since
// those only ever move outward. The cage stays valid: a move or flip is kept only if, exactly, the new faces touch
// neither the obstacle nor the rest of the cage, and no whole component of the obstacle may lie between the old faces
// and the new ones. The obstacle was inside before and cannot get out without touching the surface.
//
// Distance is not paid for with slivers: flips that raise the smallest angle go in between, and in the end vertices
// slide along the surface where that widens the narrowest faces around them and adds no volume. Passes before that may
// polish the cage: vertices move and edges flip either way, where that makes the cage fit the input better (misfit.h),
// in normals above all, which moves for the sake of volume alone spoil.
#pragma once

#include <cstdint>

#include "parallel/coverage.h"
#include "parallel/obstacle.h"

namespace prcage {

struct TightenSettings {
  BandLimits limits;
  int passes = 1;
  int fitting_passes = 0;  // after those
  bool flips = true;
  // Moves shorter than this, input's unit, are not worth their tests.
  double shortest = 0;
  bool float_positions = false;
  std::uint64_t seed = 0;
  Coverage* coverage = nullptr;  // if samples of the input are to stay within limits.centroids
  double sample_area = 0;        // of the input, that a sample stands for
  double misfit_unit = 1;        // for the polish, see misfit.h
};

// The cage is valid after every round. Runs inside an Arena.
void tighten(CageState& state, const TightenSettings& settings, const Obstacle& obstacle, const UnitFrame& frame,
             const TreeDevice& device, DistanceBand& band, const Control* control, Counts& counts);

}  // namespace prcage
