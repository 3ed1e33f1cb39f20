// Pairs of elements that a join finds, from many threads at once.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <new>
#include <vector>

namespace prcage {

inline constexpr std::size_t no_limit = std::numeric_limits<std::size_t>::max();

struct FacePairs {
  std::size_t count = 0;                            // of all pairs, whatever the limit
  std::vector<std::array<std::uint32_t, 2>> pairs;  // ascending; the lowest ones if there are more than the limit
};

// Keeps the lowest `limit` pairs.
class PairCollector {
 public:
  explicit PairCollector(std::size_t limit = no_limit) : limit_(limit) {}

  // Called from within Embree, which exceptions must not cross: running out of memory is remembered.
  void add(std::uint32_t i, std::uint32_t j) noexcept {
    try {
      Local& local = locals_.local();
      ++local.count;
      local.pairs.push_back({i, j});
      if (limit_ < local.pairs.size() / 2) keep_lowest(local.pairs);
    } catch (const std::bad_alloc&) {
      out_of_memory_.store(true, std::memory_order_relaxed);
    }
  }

  // Throws std::bad_alloc if pairs were lost. Not thread-safe.
  FacePairs result() {
    if (out_of_memory_.load(std::memory_order_relaxed)) throw std::bad_alloc();
    FacePairs all;
    for (const Local& local : locals_) {
      all.count += local.count;
      all.pairs.insert(all.pairs.end(), local.pairs.begin(), local.pairs.end());
    }
    keep_lowest(all.pairs);
    return all;
  }

 private:
  struct Local {
    std::size_t count = 0;
    std::vector<std::array<std::uint32_t, 2>> pairs;
  };

  void keep_lowest(std::vector<std::array<std::uint32_t, 2>>& pairs) const {
    std::sort(pairs.begin(), pairs.end());
    if (pairs.size() > limit_) pairs.resize(limit_);
  }

  std::size_t limit_;
  tbb::enumerable_thread_specific<Local> locals_;
  std::atomic<bool> out_of_memory_{false};
};

}  // namespace prcage
