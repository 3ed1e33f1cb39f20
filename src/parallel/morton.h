// Order along a space-filling curve: what is near in it is near in space.
#pragma once

#include <algorithm>
#include <cstdint>

#include "parallel/box_tree.h"

namespace prcage {

// Bits of a 10-bit number, two apart.
inline std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

// Place of a box's centre on the Morton curve through a grid of 1024^3 cells over the unit frame.
inline std::uint32_t morton_code(const Box& box) {
  std::uint32_t code = 0;
  for (int k = 0; k < 3; ++k) {
    const float x = 0.5f * (box.lower[k] + box.upper[k]) + 0.5f;
    code |= spread_bits(static_cast<std::uint32_t>(std::clamp(x * 1000.0f + 12.0f, 0.0f, 1023.0f))) << k;
  }
  return code;
}

}  // namespace prcage
