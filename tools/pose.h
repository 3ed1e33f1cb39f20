// A deformed cage for those who have no modelling program at hand: bent or twisted along an axis.
#pragma once

#include <cstddef>
#include <optional>

#include "core/prcage.h"

namespace prcage {

struct PoseOptions {
  double bend = 0;                  // degrees from end to end, along an arc as long as the mesh
  double twist = 0;                 // degrees from end to end
  std::optional<std::size_t> axis;  // 0 to 2; none: the longest side of the bounding box
};

// Twists the mesh round the axis through the middle of its box, then bends it: in the direction of the shorter of the
// two other sides of the box, the middle staying where it is.
Mesh posed(Mesh mesh, const PoseOptions& options);

}  // namespace prcage
