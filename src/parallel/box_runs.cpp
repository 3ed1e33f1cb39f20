#include "parallel/box_runs.h"

#include <algorithm>

#include "parallel/morton.h"
#include "parallel/parallel_for.h"

namespace prcage {

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
      run_box_[r].unite(box);
    }
  });
  tree_.build(run_box_, TreeQuality::fast_query);
}

}  // namespace prcage
