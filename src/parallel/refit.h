// Refitting: vertices move to where the surface is nearest to the input, and the input to it, in the sense of least
// squares over both. Collapses place vertices by what is left of the surface then, and their errors add up; thin parts
// swell, since their few planes go round them. For bands on both sides; every move passes the tests of a collapse.
#pragma once

#include <cstdint>

#include "parallel/coverage.h"
#include "parallel/side_test.h"

namespace prcage {

struct RefitSettings {
  BandLimits limits;
  int passes = 1;
  double sample_area = 0;  // of the input, that a sample stands for
  double shortest = 0;     // moves shorter than this, input's unit, are not worth their tests
  bool float_positions = false;
  std::uint64_t seed = 0;
  Coverage* coverage = nullptr;
  const SideTest* side_test = nullptr;  // where the two sides differ
};

// Returns the number of moves. The surface is valid after every round. Runs inside an Arena.
std::size_t refit(CageState& state, const RefitSettings& settings, const UnitFrame& frame, const TreeDevice& device,
                  DistanceBand& band, const Control* control);

}  // namespace prcage
