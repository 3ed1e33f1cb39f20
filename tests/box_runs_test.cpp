// Joins of runs of boxes against loops over all pairs.
#include "parallel/box_runs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <random>
#include <vector>

#include "parallel/arena.h"

namespace prcage {
namespace {

using Pairs = std::vector<std::array<std::uint32_t, 2>>;

// Boxes on a coarse grid, so that many only just touch; every seventh is empty.
std::vector<Box> random_boxes(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Box> boxes(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 7 == 3) continue;
    for (int k = 0; k < 3; ++k) {
      boxes[i].lower[k] = static_cast<float>(random() % 60) / 64 - 0.5f;
      boxes[i].upper[k] = boxes[i].lower[k] + static_cast<float>(random() % 8) / 64;
    }
  }
  return boxes;
}

Pairs sorted(Pairs pairs) {
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

template <class Join>
Pairs collected(const Join& join_all) {
  Pairs found;
  std::mutex mutex;
  join_all([&](std::uint32_t i, std::uint32_t j) {
    const std::lock_guard lock(mutex);
    found.push_back({i, j});
  });
  return sorted(found);
}

TEST(BoxRuns, JoinsFindAllOverlapsOnce) {
  for (const std::size_t count : {1u, 15u, 16u, 17u, 33u, 700u}) {
    const std::vector<Box> a = random_boxes(count, count), b = random_boxes(300, 77);
    Pairs expected, expected_self;
    for (std::uint32_t i = 0; i < a.size(); ++i) {
      for (std::uint32_t j = 0; j < b.size(); ++j)
        if (a[i].overlaps(b[j])) expected.push_back({i, j});
      for (std::uint32_t j = i + 1; j < a.size(); ++j)
        if (a[i].overlaps(a[j])) expected_self.push_back({i, j});
    }
    for (const int threads : {1, 2})
      Arena(threads).run([&] {
        const TreeDevice device;
        BoxRuns runs_a(device), runs_b(device);
        runs_a.build(a);
        runs_b.build(b);
        BoxTree tree(device);
        tree.build(a, TreeQuality::fast_build);
        EXPECT_EQ(collected([&](const auto& visit) { join(runs_a, runs_b, visit); }), expected);
        EXPECT_EQ(collected([&](const auto& visit) { join(tree, runs_b, visit); }), expected);
        EXPECT_EQ(collected([&](const auto& visit) { self_join(runs_a, visit); }), expected_self);
      });
  }
}

TEST(BoxRuns, NothingJoinsWithNothing) {
  Arena(1).run([] {
    const TreeDevice device;
    BoxRuns nothing(device), some(device);
    nothing.build(std::vector<Box>(5));
    some.build(random_boxes(20, 1));
    EXPECT_TRUE(collected([&](const auto& visit) { join(nothing, some, visit); }).empty());
    EXPECT_TRUE(collected([&](const auto& visit) { self_join(nothing, visit); }).empty());
  });
}

}  // namespace
}  // namespace prcage
