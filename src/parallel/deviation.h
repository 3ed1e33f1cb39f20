// How far a surface is from its input, as measured at samples. Must be called inside an Arena; the results do not
// depend on the number of threads.
#pragma once

#include <cstddef>

#include "parallel/intersections.h"

namespace prcage {

// The Hausdorff distance, absolute, from below. Both surfaces have a tree and some area.
double measured_hausdorff(const SurfaceTree& input, const SurfaceTree& surface, std::size_t samples);

// The check on what strict tolerances prove. Both surfaces have a tree and some area; the input is closed and oriented.
// `diagonal` is l.
TwoSidedDeviation measure_deviation(const TreeDevice& device, const SurfaceTree& input, const SurfaceTree& surface,
                                    double diagonal, std::size_t samples);

}  // namespace prcage
