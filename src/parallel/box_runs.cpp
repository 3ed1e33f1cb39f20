#include "parallel/box_runs.h"

#include <tbb/parallel_sort.h>

#include <algorithm>

#include "parallel/morton.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

// Numbers of the boxes that are not empty.
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

void enlarge(Box& box, const Box& by) {
  for (int k = 0; k < 3; ++k) {
    box.lower[k] = std::min(box.lower[k], by.lower[k]);
    box.upper[k] = std::max(box.upper[k], by.upper[k]);
  }
}

}  // namespace

void BoxRuns::build(std::span<const Box> boxes) {
  const std::vector<std::uint32_t> order = along_curve(boxes);
  const std::size_t count = (order.size() + length - 1) / length;
  runs_.assign(count, Run{});
  run_box_.assign(count, Box{});
  parallel_each(count, default_grain / length, [&](std::size_t r) {
    const std::size_t first = r * length;
    for (std::size_t k = first; k < std::min(order.size(), first + length); ++k) {
      const Box& box = boxes[order[k]];
      runs_[r].set(static_cast<std::uint32_t>(k - first), box);
      runs_[r].number[k - first] = order[k];
      enlarge(run_box_[r], box);
    }
  });
  tree_.build(run_box_, TreeQuality::fast_query);
}

}  // namespace prcage
