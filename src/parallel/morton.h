// Order along a space-filling curve: what is near in it is near in space.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "parallel/box_tree.h"

namespace prcage {

// Numbers of the boxes that are not empty, by the places of their centres on the Morton curve through a grid of 1024^3
// cells over the unit frame; equals in ascending order.
std::vector<std::uint32_t> along_curve(std::span<const Box> boxes);

}  // namespace prcage
