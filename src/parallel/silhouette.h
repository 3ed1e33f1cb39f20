// How much the outlines of a surface differ from those of its input, seen from all around. Must be called inside an
// Arena; the result does not depend on the number of threads.
#pragma once

#include <cstddef>

#include "parallel/box_tree.h"

namespace prcage {

// Orthographic views along directions that are spread evenly over half the sphere; the other half shows the same
// outlines. `frame` holds both meshes, which have some area.
SilhouetteDeviation measure_silhouettes(const TreeDevice& device, const UnitFrame& frame, const Mesh& input,
                                        const Mesh& surface, std::size_t views);

}  // namespace prcage
