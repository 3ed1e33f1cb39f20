#include "parallel/morton.h"

#include <tbb/parallel_sort.h>

#include <algorithm>

#include "parallel/parallel_for.h"

namespace prcage {
namespace {

// Bits of a 10-bit number, two apart.
std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

std::uint32_t morton_code(const Box& box) {
  std::uint32_t code = 0;
  for (int k = 0; k < 3; ++k) {
    const float x = 0.5f * (box.lower[k] + box.upper[k]) + 0.5f;
    code |= spread_bits(static_cast<std::uint32_t>(std::clamp(x * 1000.0f + 12.0f, 0.0f, 1023.0f))) << k;
  }
  return code;
}

}  // namespace

std::vector<std::uint32_t> along_curve(std::span<const Box> boxes) {
  auto order = parallel_gather<std::uint64_t>(
      boxes.size(), std::size_t{1} << 14, [&](std::size_t begin, std::size_t end, std::vector<std::uint64_t>& list) {
        list.reserve(end - begin);
        for (std::size_t i = begin; i < end; ++i)
          if (!boxes[i].empty()) list.push_back(std::uint64_t{morton_code(boxes[i])} << 32 | i);
      });
  tbb::parallel_sort(order);
  std::vector<std::uint32_t> numbers(order.size());
  parallel_each(order.size(), default_grain, [&](std::size_t i) { numbers[i] = static_cast<std::uint32_t>(order[i]); });
  return numbers;
}

}  // namespace prcage
