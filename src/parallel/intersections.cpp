#include "parallel/intersections.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <new>

#include "core/predicates.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

using Pair = std::array<std::uint32_t, 2>;

// Collects pairs from many threads at once and keeps the lowest `limit` of them.
class PairCollector {
 public:
  explicit PairCollector(std::size_t limit) : limit_(limit) {}

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
    std::vector<Pair> pairs;
  };

  void keep_lowest(std::vector<Pair>& pairs) const {
    std::sort(pairs.begin(), pairs.end());
    if (pairs.size() > limit_) pairs.resize(limit_);
  }

  std::size_t limit_;
  tbb::enumerable_thread_specific<Local> locals_;
  std::atomic<bool> out_of_memory_{false};
};

bool touch(const SurfaceTree& a, std::uint32_t i, const SurfaceTree& b, std::uint32_t j) {
  const double* const s[3] = {a.corner(i, 0), a.corner(i, 1), a.corner(i, 2)};
  const double* const t[3] = {b.corner(j, 0), b.corner(j, 1), b.corner(j, 2)};
  return !certainly_separated(s, t) && exact::triangles_intersect(s[0], s[1], s[2], t[0], t[1], t[2]);
}

}  // namespace

void SurfaceTree::build(const UnitFrame& frame, std::span<const Position> positions,
                        std::span<const Triangle> triangles, TreeQuality quality, std::span<const std::uint8_t> keep) {
  frame_ = frame;
  positions_ = positions;
  triangles_ = triangles;
  boxes_.resize(triangles.size());
  parallel_each(triangles.size(), default_grain, [&](std::size_t f) {
    const auto face = static_cast<std::uint32_t>(f);
    const bool kept = keep.empty() || keep[f] != 0;
    boxes_[f] = kept ? bounding_box(frame, {corner(face, 0), corner(face, 1), corner(face, 2)}) : Box{};
  });
  tree_.build(boxes_, quality);
}

FacePairs self_intersections(const SurfaceTree& surface, std::size_t limit) {
  PairCollector found(limit);
  self_join(surface.tree(), [&](std::uint32_t i, std::uint32_t j) {
    if (improper_contact(surface.triangle(i), surface.triangle(j))) found.add(i, j);
  });
  return found.result();
}

FacePairs self_intersections(const SurfaceTree& surface, const SurfaceTree& changed,
                             std::span<const std::uint8_t> is_changed, std::size_t limit) {
  PairCollector found(limit);
  join(changed.tree(), surface.tree(), [&](std::uint32_t i, std::uint32_t j) {
    if (i == j || (is_changed[j] != 0 && i > j)) return;  // pairs of two changed faces come twice
    if (improper_contact(surface.triangle(i), surface.triangle(j))) found.add(std::min(i, j), std::max(i, j));
  });
  return found.result();
}

FacePairs contacts(const SurfaceTree& a, const SurfaceTree& b, std::size_t limit) {
  PairCollector found(limit);
  join(a.tree(), b.tree(), [&](std::uint32_t i, std::uint32_t j) {
    if (touch(a, i, b, j)) found.add(i, j);
  });
  return found.result();
}

}  // namespace prcage
