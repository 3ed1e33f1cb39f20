// The solver of many problems for one instruction set, PRCAGE_ARCH as xsimd names it. Two ways to use the lanes of a
// vector alternate:
//
// - A step of the active-set method treats a group of problems at once, one a lane.
// - Before a step each problem looks for its most violated plane by itself, with the planes in the lanes: nothing is
//   transposed or padded, and no lane works for a problem that is solved. What the lanes of a problem found is reduced
//   for a vector of problems at once. The least slack and the first plane that has it do not depend on the order of the
//   comparisons, so that the width of the vectors does not show.
//
// Groups are runs of neighbours: the planes are read in order, and while one group is solved those of the next arrive.
// A problem's solution depends neither on its group nor on its place in it.
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

// What xsimd 8 lacks: a mask as bits, and the smallest number of each row of a square matrix, row l in lane l. There
// are no NaNs among them.
inline ProblemSet mask_bits(__m128d mask) { return static_cast<ProblemSet>(_mm_movemask_pd(mask)); }
inline __m128d row_minima(const __m128d rows[2]) {
  return _mm_min_pd(_mm_unpacklo_pd(rows[0], rows[1]), _mm_unpackhi_pd(rows[0], rows[1]));
}
#ifdef __AVX2__
inline ProblemSet mask_bits(__m256d mask) { return static_cast<ProblemSet>(_mm256_movemask_pd(mask)); }
inline __m256d row_minima(const __m256d rows[4]) {
  const auto halves = [](__m256d a, __m256d b) {
    return _mm256_min_pd(_mm256_permute2f128_pd(a, b, 0x20), _mm256_permute2f128_pd(a, b, 0x31));
  };
  const __m256d even = halves(rows[0], rows[2]), odd = halves(rows[1], rows[3]);
  return _mm256_min_pd(_mm256_unpacklo_pd(even, odd), _mm256_unpackhi_pd(even, odd));
}
#endif
#ifdef __AVX512F__
inline ProblemSet mask_bits(__mmask8 mask) { return mask; }
inline __m512d row_minima(const __m512d rows[8]) {
  const auto halves = [](__m512d a, __m512d b) {
    return _mm512_min_pd(_mm512_shuffle_f64x2(a, b, 0x44), _mm512_shuffle_f64x2(a, b, 0xee));
  };
  const auto quarters = [](__m512d a, __m512d b) {
    return _mm512_min_pd(_mm512_shuffle_f64x2(a, b, 0x88), _mm512_shuffle_f64x2(a, b, 0xdd));
  };
  const __m512d even = quarters(halves(rows[0], rows[2]), halves(rows[4], rows[6]));
  const __m512d odd = quarters(halves(rows[1], rows[3]), halves(rows[5], rows[7]));
  return _mm512_min_pd(_mm512_unpacklo_pd(even, odd), _mm512_unpackhi_pd(even, odd));
}
#endif

using Register = Lanes::register_type;

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

// The planes that the problems of a vector violate most. A row is a problem's: planes are dealt to its lanes in turn,
// and what remains in a lane is the least slack, the tolerance at most, with the number of the first plane that has it.
struct Looks {
  Register slack[Lanes::size];
  Register plane[Lanes::size];
};

// As find_violation, a vector of planes at a time and without a branch on what is found.
inline void look_in_lanes(const PlaneArrays& planes, const Triple<double>& point, double tolerance, Looks& looks,
                          std::size_t row) {
  constexpr std::size_t width = Lanes::size;
  alignas(64) static constexpr double numbers[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  const Lanes x(point.x), y(point.y), z(point.z);
  Lanes least(-tolerance), plane(0.0);
  const auto compare = [&](std::size_t i, const Lanes& number) {
    const Lanes slack = Lanes::load_unaligned(planes.nx + i) * x + Lanes::load_unaligned(planes.ny + i) * y +
                        Lanes::load_unaligned(planes.nz + i) * z - Lanes::load_unaligned(planes.offset + i);
    plane = select(slack < least, number, plane);
    least = min(slack, least);  // the second if the first is a NaN
  };
  const std::size_t last = planes.count - width;
  Lanes number = Lanes::load_aligned(numbers);
  for (std::size_t i = 0; i < last; i += width) {
    compare(i, number);
    number = number + Lanes(static_cast<double>(width));
  }
  // Overlaps the vector before: planes seen twice change nothing.
  compare(last, Lanes::load_aligned(numbers) + Lanes(static_cast<double>(last)));
  looks.slack[row] = least;
  looks.plane[row] = plane;
}

// Solves one group after the other.
class GroupSolver {
 public:
  explicit GroupSolver(const QpBatchArrays& batch) : batch_(batch) {}

  // Up to group_size problems.
  void solve(std::size_t begin, std::size_t count) {
    begin_ = begin;
    const ProblemSet all = (1u << count) - 1;
    const ProblemSet positive = start_group(count);
    finish(all & ~positive, QpStatus::not_converged);
    ProblemSet running = all & positive;
    ProblemSet looking = running;
    const double* const arrays[] = {batch_.nx, batch_.ny, batch_.nz, batch_.offset};
    for (int steps = 0;; ++steps) {
      ahead_ = steps < 4 ? arrays[steps] : nullptr;
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
      const std::size_t i = begin_ + (l < count ? l : 0);
      for (std::size_t k = 0; k < 6; ++k) form[k].of[l] = batch_.form[6 * i + k];
      for (std::size_t k = 0; k < 3; ++k) linear[k].of[l] = batch_.linear[3 * i + k];
    }
    return start(form, linear, group_);
  }

  // Finds the plane to enter for each problem of `looking`. Finishes and returns those that violate none.
  ProblemSet look(ProblemSet looking) {
    ProblemSet done = looking;
    for (std::size_t at = 0; at < group_size; at += Lanes::size) {
      const ProblemSet part = looking & (((1u << Lanes::size) - 1) << at);
      for (ProblemSet rest = part; rest != 0; rest &= rest - 1) look_at(first_of(rest), at);
      if (part != 0) done &= ~choose_planes(part, at);
    }
    for (ProblemSet rest = done; rest != 0; rest &= rest - 1) finish_at(first_of(rest));
    return done;
  }

  void look_at(std::size_t l, std::size_t at) {
    const std::size_t i = begin_ + l;
    const PlaneArrays planes = planes_of(batch_, i);
    // Of the next group's problem, one of the four arrays at each of the first looks: so the memory is busy all the
    // time. Most problems have about 32 planes.
    if (ahead_ != nullptr && i + group_size < batch_.count)
      for (std::size_t k = 0; k < 32; k += 8) __builtin_prefetch(ahead_ + batch_.first_plane[i + group_size] + k);
    const Triple<double> x{group_.x[0].of[l], group_.x[1].of[l], group_.x[2].of[l]};
    if (planes.count >= Lanes::size) return look_in_lanes(planes, x, batch_.tolerance, looks_, l - at);
    Violation worst;
    if (!find_violation(planes, x, batch_.tolerance, worst)) worst = {0, -batch_.tolerance};
    looks_.slack[l - at] = Lanes(worst.slack);
    looks_.plane[l - at] = Lanes(static_cast<double>(worst.plane));
  }

  // Writes the planes to enter of the problems of `looking`, all of one vector. Returns the problems that have one.
  ProblemSet choose_planes(ProblemSet looking, std::size_t at) {
    const Lanes slack = row_minima(looks_.slack);
    Row least, plane;
    store(slack, least, 0);
    Register number[Lanes::size];
    for (std::size_t l = 0; l < Lanes::size; ++l)
      number[l] = select(Lanes(looks_.slack[l]) == Lanes(least.of[l]), Lanes(looks_.plane[l]), Lanes(infinity));
    store(row_minima(number), plane, 0);
    const ProblemSet entering = looking & (bits(slack < Lanes(-batch_.tolerance)) << at);
    for (std::size_t l = at; l < at + Lanes::size; ++l) {
      if ((entering >> l & 1) == 0) continue;
      const std::size_t worst = batch_.first_plane[begin_ + l] + static_cast<std::uint32_t>(plane.of[l - at]);
      group_.plane[0].of[l] = batch_.nx[worst];
      group_.plane[1].of[l] = batch_.ny[worst];
      group_.plane[2].of[l] = batch_.nz[worst];
      group_.slack.of[l] = least.of[l - at];
    }
    return entering;
  }

  void finish_at(std::size_t l) {
    const Triple<double> x{group_.x[0].of[l], group_.x[1].of[l], group_.x[2].of[l]};
    const std::size_t i = begin_ + l;
    batch_.status[i] = status_at(x);
    if (batch_.status[i] != QpStatus::solved) return;
    batch_.x[3 * i] = x.x;
    batch_.x[3 * i + 1] = x.y;
    batch_.x[3 * i + 2] = x.z;
  }

  void finish(ProblemSet done, QpStatus status) {
    for (ProblemSet rest = done; rest != 0; rest &= rest - 1) batch_.status[begin_ + first_of(rest)] = status;
  }

  const QpBatchArrays& batch_;
  std::size_t begin_ = 0;
  const double* ahead_ = nullptr;  // the array to fetch for the next group
  Group group_{};
  Looks looks_{};
};

inline void solve_in_lanes(const QpBatchArrays& batch) {
  GroupSolver solver(batch);
  for (std::size_t begin = 0; begin < batch.count; begin += group_size)
    solver.solve(begin, batch.count - begin < group_size ? batch.count - begin : group_size);
}

}  // namespace
}  // namespace prcage
