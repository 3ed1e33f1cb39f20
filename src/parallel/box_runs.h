// Boxes joined by runs: all pairs of boxes that overlap, for sets so large that a tree over every box costs more than
// the pairs are worth.
//
// The boxes are put in the order of a space-filling curve and cut into runs of a few. A tree over the boxes of the runs
// finds the pairs of runs, plain loops find the pairs of boxes in them. The tree is a small fraction of one over all
// boxes, and Embree reports, and leaves to be tested, far fewer pairs.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <xsimd/xsimd.hpp>

#include "parallel/box_tree.h"
#include "parallel/parallel_for.h"

namespace prcage {

class BoxRuns {
 public:
  explicit BoxRuns(const TreeDevice& device) : tree_(device) {}

  // The boxes are copied; empty ones are left out, all others must be finite and in about the unit cube.
  void build(std::span<const Box> boxes);

  std::uint32_t runs() const { return static_cast<std::uint32_t>(runs_.size()); }
  const BoxTree& tree() const { return tree_; }  // over the boxes of the runs
  const Box& run_box(std::uint32_t run) const { return run_box_[run]; }

  // Calls visit(number) for the boxes of a run that overlap `box`.
  template <class Visit>
  void for_each_overlap(std::uint32_t run, const Box& box, const Visit& visit) const {
    for_each_bit(runs_[run].overlapping(box), [&](std::uint32_t k) { visit(runs_[run].number[k]); });
  }

  // Calls visit(number) for the boxes of a run that are nearer to x than a distance, in single precision; visit returns
  // the square of the distance that counts from then on.
  template <class Visit>
  void for_each_nearer(std::uint32_t run, const std::array<float, 3>& x, float squared, const Visit& visit) const {
    std::array<float, length> squared_distance;
    for_each_bit(runs_[run].nearer(x, squared, squared_distance), [&](std::uint32_t k) {
      if (squared_distance[k] < squared) squared = visit(runs_[run].number[k]);
    });
  }

  // Calls visit(i, j) for the boxes i of `run` and j of `run_of_other` that overlap.
  template <class Visit>
  void join_run(std::uint32_t run, const BoxRuns& other, std::uint32_t run_of_other, const Visit& visit) const {
    // Of two runs side by side few boxes reach over the border: most rows of the table of pairs are skipped.
    const Run& own = runs_[run];
    for_each_bit(own.overlapping(other.run_box_[run_of_other]), [&](std::uint32_t k) {
      other.for_each_overlap(run_of_other, own.box(k), [&](std::uint32_t j) { visit(own.number[k], j); });
    });
  }

 private:
  static constexpr std::uint32_t length = 16;
  static constexpr std::array<float, length> power_of_two = [] {
    std::array<float, length> powers{};
    for (std::uint32_t k = 0; k < length; ++k) powers[k] = static_cast<float>(1u << k);
    return powers;
  }();

  using Lanes = xsimd::batch<float>;
  static Lanes load(const float* values, std::uint32_t k) { return Lanes::load_unaligned(values + k); }

  // Boxes side by side for vector instructions; what is missing in the last run is empty.
  struct Run {
    float lower[3][length];
    float upper[3][length];
    std::uint32_t number[length];

    Run() : number{} {
      for (std::uint32_t k = 0; k < length; ++k) set(k, Box{});
    }
    void set(std::uint32_t k, const Box& b) {
      for (int axis = 0; axis < 3; ++axis) {
        lower[axis][k] = b.lower[axis];
        upper[axis][k] = b.upper[axis];
      }
    }
    Box box(std::uint32_t k) const {
      Box b;
      for (int axis = 0; axis < 3; ++axis) {
        b.lower[axis] = lower[axis][k];
        b.upper[axis] = upper[axis][k];
      }
      return b;
    }

    // Bit k: test(k) of the lanes from k.
    template <class Test>
    static std::uint32_t bits(const Test& test) {
      // Powers of two of the lanes that pass, added up: exact in single precision.
      Lanes sum(0.0f);
      for (std::uint32_t k = 0; k < length; k += Lanes::size)
        sum += xsimd::select(test(k), load(power_of_two.data(), k), Lanes(0.0f));
      return static_cast<std::uint32_t>(xsimd::hadd(sum));
    }

    // Bit k: does box k overlap b?
    std::uint32_t overlapping(const Box& b) const {
      return bits([&](std::uint32_t k) {
        return (load(lower[0], k) <= b.upper[0]) & (load(lower[1], k) <= b.upper[1]) &
               (load(lower[2], k) <= b.upper[2]) & (load(upper[0], k) >= b.lower[0]) &
               (load(upper[1], k) >= b.lower[1]) & (load(upper[2], k) >= b.lower[2]);
      });
    }

    // Bit k: is the square of box k's distance from x, which is written as well, less than `squared`?
    std::uint32_t nearer(const std::array<float, 3>& x, float squared, std::array<float, length>& distance) const {
      return bits([&](std::uint32_t k) {
        Lanes sum(0.0f);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const Lanes beyond = xsimd::max(load(lower[axis], k) - x[axis], x[axis] - load(upper[axis], k));
          const Lanes away = xsimd::max(beyond, Lanes(0.0f));
          sum += away * away;
        }
        sum.store_unaligned(distance.data() + k);
        return sum < Lanes(squared);
      });
    }
  };

  template <class Visit>
  static void for_each_bit(std::uint32_t bits, const Visit& visit) {
    for (; bits != 0; bits &= bits - 1) visit(static_cast<std::uint32_t>(std::countr_zero(bits)));
  }

  std::vector<Run> runs_;
  std::vector<Box> run_box_;
  BoxTree tree_;
};

// Calls visit(i, j) for every box i of a and j of b that overlap, touching included, each pair once; concurrently and
// in no particular order. visit must not throw.
template <class Visit>
void join(const BoxRuns& a, const BoxRuns& b, const Visit& visit) {
  join(a.tree(), b.tree(), [&](std::uint32_t r, std::uint32_t s) { a.join_run(r, b, s, visit); });
}

// The same with a tree over boxes of different sizes or few of them.
template <class Visit>
void join(const BoxTree& a, const BoxRuns& b, const Visit& visit) {
  join(a, b.tree(), [&](std::uint32_t i, std::uint32_t run) {
    b.for_each_overlap(run, a.boxes()[i], [&](std::uint32_t j) { visit(i, j); });
  });
}

// The same for all unordered pairs i < j of one set.
template <class Visit>
void self_join(const BoxRuns& set, const Visit& visit) {
  const auto ordered = [&visit](std::uint32_t i, std::uint32_t j) { visit(std::min(i, j), std::max(i, j)); };
  self_join(set.tree(), [&](std::uint32_t r, std::uint32_t s) { set.join_run(r, set, s, ordered); });
  parallel_each(set.runs(), 64, [&](std::size_t run) {
    const auto r = static_cast<std::uint32_t>(run);
    set.join_run(r, set, r, [&visit](std::uint32_t i, std::uint32_t j) {
      if (i < j) visit(i, j);
    });
  });
}

}  // namespace prcage
