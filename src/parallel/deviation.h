// How far a simplified surface is from its input, as measured: the check on what strict tolerances prove. Must be
// called inside an Arena; the result does not depend on the number of threads.
#pragma once

#include <cstddef>

#include "parallel/intersections.h"

namespace prcage {

// Both surfaces have a tree and some area; the input is closed and oriented. `diagonal` is l.
TwoSidedDeviation measure_deviation(const TreeDevice& device, const SurfaceTree& input, const SurfaceTree& surface,
                                    double diagonal, std::size_t samples);

}  // namespace prcage
