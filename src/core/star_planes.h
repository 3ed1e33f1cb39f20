// The constraints and the quadrics of many stars at once (paper eq. 1, 4, 5), by the best vector instructions that the
// CPU has. The results are the same, bit for bit, whatever the instruction set.
#pragma once

#include "core/simd.h"
#include "core/star_planes_problem.h"

namespace prcage {

// Writes the planes and the quadric of every star. No allocation, thread-safe. The level must be an available one.
void make_star_planes(const StarArrays& arrays, SimdLevel level = simd_level());

}  // namespace prcage
