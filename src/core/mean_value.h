// Mean value coordinates of points with respect to a closed triangle cage (Ju, Schaefer, Warren 2005), by the best
// vector instructions that the CPU has. The results are the same, bit for bit, whatever the instruction set.
//
// The weights of a point add up to 1, and the vertices of the cage so weighted to the point, as far as rounding allows:
// both to some 1e-12 of the size of the cage. The weights themselves are good to some 1e-11, and to 1e-6 at worst where
// the point is nearly in the plane of a face that it is not on, or in line with an edge. They are positive within a
// convex cage, and smooth except at the surface of the cage, where they are the barycentric coordinates on the face.
#pragma once

#include "core/mean_value_problem.h"
#include "core/simd.h"

namespace prcage {

// No allocation, thread-safe. The level must be an available one.
void find_mean_values(const MeanValueArrays& arrays, SimdLevel level = simd_level());

}  // namespace prcage
