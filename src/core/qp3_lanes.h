// The solver of many problems for one instruction set, PRCAGE_ARCH as xsimd names it. Two ways to use the lanes of a
// vector alternate:
//
// - A step of the active-set method treats a group of problems at once, one a lane.
// - Before a step each problem looks for its most violated plane by itself, with the planes in the lanes: nothing is
//   transposed or padded, and no lane works for a problem that is solved. The least slack and the first plane that has
//   it do not depend on the order of the comparisons, so that the width of the vectors does not show.
//
// The groups are made of problems with about equally many planes: then the branches are predictable. A problem's
// solution depends neither on its group nor on its place in it.
//
// For the sources named qp3_<instruction set>.cpp only; see qp3_kernel.h for what must not be used here.
#pragma once

#include <xsimd/xsimd.hpp>

#include "core/qp3_kernel.h"

namespace prcage {
namespace {

using Lanes = xsimd::batch<double, xsimd::PRCAGE_ARCH>;
using LaneMask = xsimd::batch_bool<double, xsimd::PRCAGE_ARCH>;

// Two vectors hide the latency of each other's divisions.
constexpr std::size_t group_size = 2 * Lanes::size;

// A set of problems of a group, a bit each.
using ProblemSet = unsigned;

// What xsimd 8 lacks: the smallest lane of a vector without NaNs, and a mask as bits.
inline double smallest_lane(__m128d v) { return _mm_cvtsd_f64(_mm_min_pd(v, _mm_unpackhi_pd(v, v))); }
inline ProblemSet mask_bits(__m128d mask) { return static_cast<ProblemSet>(_mm_movemask_pd(mask)); }
#ifdef __AVX2__
inline double smallest_lane(__m256d v) {
  return smallest_lane(_mm_min_pd(_mm256_castpd256_pd128(v), _mm256_extractf128_pd(v, 1)));
}
inline ProblemSet mask_bits(__m256d mask) { return static_cast<ProblemSet>(_mm256_movemask_pd(mask)); }
#endif
#ifdef __AVX512F__
inline double smallest_lane(__m512d v) {
  return smallest_lane(_mm256_min_pd(_mm512_castpd512_pd256(v), _mm512_extractf64x4_pd(v, 1)));
}
inline ProblemSet mask_bits(__mmask8 mask) { return mask; }
#endif

inline double smallest(const Lanes& v) { return smallest_lane(static_cast<Lanes::register_type>(v)); }
inline ProblemSet bits(const LaneMask& m) { return mask_bits(static_cast<LaneMask::register_type>(m)); }

// First element of a set that is not empty.
inline std::size_t first_of(ProblemSet set) { return static_cast<std::size_t>(__builtin_ctz(set)); }

// One number for each problem of a group.
struct alignas(64) Row {
  double of[group_size];
};

inline Lanes load(const Row& row, std::size_t at) { return Lanes::load_aligned(row.of + at); }
inline void store(const Lanes& v, Row& row, std::size_t at) { v.store_aligned(row.of + at); }

inline Triple<Lanes> load3(const Row rows[3], std::size_t at) {
  return {load(rows[0], at), load(rows[1], at), load(rows[2], at)};
}
inline void store3(const Triple<Lanes>& v, Row rows[3], std::size_t at) {
  store(v.x, rows[0], at);
  store(v.y, rows[1], at);
  store(v.z, rows[2], at);
}

// A group at work: what the scalar solver holds in its variables.
struct Group {
  Row factor[6];
  Row x[3];
  Row y[3];
  Row n[3][3];
  Row u[3];
  Row size;
  Row plane[3];  // normal of the entering plane, not whitened
  Row entering_multiplier;
  Row slack;
};

inline Cholesky<Lanes> load_factor(const Group& group, std::size_t at) {
  const Row* f = group.factor;
  return {load(f[0], at), load(f[1], at), load(f[2], at), load(f[3], at), load(f[4], at), load(f[5], at)};
}

inline void store_factor(const Cholesky<Lanes>& factor, Group& group, std::size_t at) {
  store(factor.i00, group.factor[0], at);
  store(factor.l10, group.factor[1], at);
  store(factor.i11, group.factor[2], at);
  store(factor.l20, group.factor[3], at);
  store(factor.l21, group.factor[4], at);
  store(factor.i22, group.factor[5], at);
}

inline ActiveSet<Lanes> load_active(const Group& group, const Cholesky<Lanes>& factor, std::size_t at) {
  ActiveSet<Lanes> active;
  active.y = load3(group.y, at);
  for (std::size_t j = 0; j < 3; ++j) {
    active.n[j] = load3(group.n[j], at);
    active.u[j] = load(group.u[j], at);
  }
  active.size = load(group.size, at);
  active.entering = factor.forward(load3(group.plane, at));
  active.entering_multiplier = load(group.entering_multiplier, at);
  active.slack = load(group.slack, at);
  return active;
}

inline void store_active(const ActiveSet<Lanes>& active, Group& group, std::size_t at) {
  store3(active.y, group.y, at);
  for (std::size_t j = 0; j < 3; ++j) {
    store3(active.n[j], group.n[j], at);
    store(active.u[j], group.u[j], at);
  }
  store(active.size, group.size, at);
  store(active.entering_multiplier, group.entering_multiplier, at);
  store(active.slack, group.slack, at);
}

// Sets out from the unconstrained minima. Returns the problems whose forms are positive definite; what becomes of the
// others is nonsense.
inline ProblemSet start(const Row form[6], const Row linear[3], Group& group) {
  ProblemSet positive = 0;
  for (std::size_t at = 0; at < group_size; at += Lanes::size) {
    const Lanes zero(0.0);
    Lanes G[6];
    for (std::size_t k = 0; k < 6; ++k) G[k] = load(form[k], at);
    Cholesky<Lanes> factor;
    positive |= bits(factorize(G, factor)) << at;
    const Triple<Lanes> origin{zero, zero, zero};
    ActiveSet<Lanes> active{origin, {origin, origin, origin}, {zero, zero, zero}, zero, origin, zero, zero};
    active.y = origin - factor.forward(load3(linear, at));
    store_factor(factor, group, at);
    store_active(active, group, at);
    store3(factor.backward(active.y), group.x, at);
  }
  return positive;
}

struct GroupResult {
  ProblemSet entered = 0;
  ProblemSet infeasible = 0;
};

// One step of the running problems; the others compute nonsense.
inline GroupResult step_group(ProblemSet running, Group& group) {
  GroupResult results;
  for (std::size_t at = 0; at < group_size; at += Lanes::size) {
    if ((running >> at & ((1u << Lanes::size) - 1)) == 0) continue;
    const Cholesky<Lanes> factor = load_factor(group, at);
    ActiveSet<Lanes> active = load_active(group, factor, at);
    const StepResult<Lanes> result = step(active);
    active.entering_multiplier = select(result.entered, Lanes(0.0), active.entering_multiplier);
    store_active(active, group, at);
    store3(factor.backward(active.y), group.x, at);
    results.entered |= bits(result.entered) << at;
    results.infeasible |= bits(result.infeasible) << at;
  }
  return results;
}

// The lowest number in `plane` among the lanes of `holders`.
inline std::size_t lowest_plane(const Lanes& plane, ProblemSet holders) {
  alignas(64) double number[Lanes::size];
  plane.store_aligned(number);
  double lowest = number[first_of(holders)];
  while ((holders &= holders - 1) != 0) {
    const double other = number[first_of(holders)];
    lowest = other < lowest ? other : lowest;
  }
  return static_cast<std::size_t>(lowest);
}

// As find_violation, a vector of planes at a time.
inline bool find_violation_in_lanes(const PlaneArrays& planes, const Triple<double>& point, double tolerance,
                                    Violation& found) {
  constexpr std::size_t width = Lanes::size;
  alignas(64) static constexpr double numbers[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  if (planes.count < width) return find_violation(planes, point, tolerance, found);
  const Lanes x(point.x), y(point.y), z(point.z);
  Lanes worst(-tolerance), plane(0.0);
  const auto compare = [&](std::size_t i, const Lanes& number) {
    const Lanes slack = Lanes::load_unaligned(planes.nx + i) * x + Lanes::load_unaligned(planes.ny + i) * y +
                        Lanes::load_unaligned(planes.nz + i) * z - Lanes::load_unaligned(planes.offset + i);
    plane = select(slack < worst, number, plane);
    worst = min(slack, worst);  // the second if the first is a NaN
  };
  const std::size_t last = planes.count - width;
  Lanes number = Lanes::load_aligned(numbers);
  for (std::size_t i = 0; i < last; i += width) {
    compare(i, number);
    number = number + Lanes(static_cast<double>(width));
  }
  // Overlaps the vector before: planes seen twice change nothing.
  compare(last, Lanes::load_aligned(numbers) + Lanes(static_cast<double>(last)));
  found.slack = smallest(worst);
  if (!(found.slack < -tolerance)) return false;
  found.plane = lowest_plane(plane, bits(worst == Lanes(found.slack)));
  return true;
}

// Solves one group after the other.
class GroupSolver {
 public:
  explicit GroupSolver(const QpBatchArrays& batch) : batch_(batch) {}

  // Up to group_size problems.
  void solve(const std::uint32_t* problem, std::size_t count) {
    problem_ = problem;
    const ProblemSet all = (1u << count) - 1;
    const ProblemSet positive = start_group(count);
    finish(all & ~positive, QpStatus::not_converged);
    ProblemSet running = all & positive;
    ProblemSet looking = running;
    for (int steps = 0;; ++steps) {
      running &= ~look(looking);
      if (running == 0) return;
      if (steps == max_steps) break;
      const GroupResult result = step_group(running, group_);
      finish(running & result.infeasible, QpStatus::infeasible);
      running &= ~result.infeasible;
      looking = running & result.entered;
    }
    finish(running, QpStatus::not_converged);
  }

 private:
  // The lanes of a group that is not full repeat its first problem.
  ProblemSet start_group(std::size_t count) {
    Row form[6], linear[3];
    for (std::size_t l = 0; l < group_size; ++l) {
      const std::size_t i = problem_[l < count ? l : 0];
      for (std::size_t k = 0; k < 6; ++k) form[k].of[l] = batch_.form[6 * i + k];
      for (std::size_t k = 0; k < 3; ++k) linear[k].of[l] = batch_.linear[3 * i + k];
    }
    return start(form, linear, group_);
  }

  // Finds the plane to enter for each problem of `looking`. Finishes and returns those that violate none.
  ProblemSet look(ProblemSet looking) {
    ProblemSet done = 0;
    for (ProblemSet rest = looking; rest != 0; rest &= rest - 1) {
      const std::size_t l = first_of(rest);
      const PlaneArrays planes = planes_of(batch_, problem_[l]);
      const Triple<double> x{group_.x[0].of[l], group_.x[1].of[l], group_.x[2].of[l]};
      Violation worst;
      if (find_violation_in_lanes(planes, x, batch_.tolerance, worst)) {
        group_.plane[0].of[l] = planes.nx[worst.plane];
        group_.plane[1].of[l] = planes.ny[worst.plane];
        group_.plane[2].of[l] = planes.nz[worst.plane];
        group_.slack.of[l] = worst.slack;
      } else {
        finish_at(problem_[l], x);
        done |= 1u << l;
      }
    }
    return done;
  }

  void finish_at(std::size_t i, const Triple<double>& x) {
    batch_.status[i] = status_at(x);
    if (batch_.status[i] != QpStatus::solved) return;
    batch_.x[3 * i] = x.x;
    batch_.x[3 * i + 1] = x.y;
    batch_.x[3 * i + 2] = x.z;
  }

  void finish(ProblemSet done, QpStatus status) {
    for (ProblemSet rest = done; rest != 0; rest &= rest - 1) batch_.status[problem_[first_of(rest)]] = status;
  }

  const QpBatchArrays& batch_;
  const std::uint32_t* problem_ = nullptr;
  Group group_{};
};

// Problems [begin, begin + count) in order of their numbers of planes, a counting sort.
inline void sort_by_planes(const QpBatchArrays& batch, std::size_t begin, std::size_t count, std::uint32_t* sorted) {
  constexpr std::size_t buckets = 32, planes_per_bucket = 4;
  const auto bucket = [&](std::size_t i) {
    const std::size_t b = (batch.first_plane[i + 1] - batch.first_plane[i]) / planes_per_bucket;
    return b < buckets ? b : buckets - 1;
  };
  std::uint32_t position[buckets + 1] = {};
  for (std::size_t i = begin; i < begin + count; ++i) ++position[bucket(i) + 1];
  for (std::size_t b = 0; b < buckets; ++b) position[b + 1] += position[b];
  for (std::size_t i = begin; i < begin + count; ++i) sorted[position[bucket(i)]++] = static_cast<std::uint32_t>(i);
}

inline void solve_in_lanes(const QpBatchArrays& batch) {
  constexpr std::size_t chunk = 128;  // planes of so many problems stay in the cache
  std::uint32_t sorted[chunk];
  GroupSolver solver(batch);
  for (std::size_t begin = 0; begin < batch.count; begin += chunk) {
    const std::size_t count = batch.count - begin < chunk ? batch.count - begin : chunk;
    sort_by_planes(batch, begin, count, sorted);
    for (std::size_t i = 0; i < count; i += group_size)
      solver.solve(sorted + i, count - i < group_size ? count - i : group_size);
  }
}

}  // namespace
}  // namespace prcage
