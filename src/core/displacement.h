// The first step off the input (paper sec. 3.2 and DESIGN sec. 3 "Displacement"): a direction per vertex along which
// every incident face plane moves outward at least as far as the step.
#pragma once

#include <cstdint>

#include "core/corner_table.h"

namespace prcage {

// Solves min |x|^2 s.t. n_f . x >= 1 over the faces f of a vertex. Faces without a reliable normal are left out. False
// if the vertex is singular: there is no such x, or only a very long one; the direction is then the mean normal.
bool displacement_direction(const CornerTable& mesh, std::uint32_t vertex, Vec3& direction);

}  // namespace prcage
