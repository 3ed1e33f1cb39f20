// The solver of many problems for one instruction set, PRCAGE_ARCH as xsimd names it. Two ways to use the lanes of a
// vector alternate:
//
// - A step of the active-set method treats a group of problems at once, one a lane.
// - Before a step each problem looks for its most violated plane by itself, with the faces in the lanes: nothing is
//   transposed, and no lane works for a problem that is solved. What the lanes of a problem found is reduced
//   for a vector of problems at once. The least slack and the first plane that has it do not depend on the order of the
//   comparisons, so that the width of the vectors does not show.
//
// Groups are runs of neighbours: the planes are read in order, and while one group is solved those of the next arrive.
// A problem's solution depends neither on its group nor on its place in it.
//
// What costs most besides the arithmetic are branches that are foreseen wrongly. So stars of the usual size take the
// same way through a look, and the first steps, which know how many planes can be active, have code of their own.
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

// Stands for a star without faces.
alignas(64) constexpr double free_rows[slab_rows * least_row_length] = {};

// A set of problems of a group, a bit each.
using ProblemSet = unsigned;

// What xsimd 8 lacks: a mask as bits and back, numbers from one address a lane, and the smallest number of each row of
// a square matrix, row l in lane l. There are no NaNs among them.
inline ProblemSet mask_bits(__m128d mask) { return static_cast<ProblemSet>(_mm_movemask_pd(mask)); }
inline void set_mask(ProblemSet set, __m128d& mask) {
  mask = _mm_castsi128_pd(_mm_set_epi64x(-static_cast<long long>(set >> 1 & 1), -static_cast<long long>(set & 1)));
}
#ifndef __AVX2__
inline __m128d gather(const double* const from[2]) { return _mm_loadh_pd(_mm_load_sd(from[0]), from[1]); }
#endif
inline __m128d row_minima(const __m128d rows[2]) {
  return _mm_min_pd(_mm_unpacklo_pd(rows[0], rows[1]), _mm_unpackhi_pd(rows[0], rows[1]));
}
#ifdef __AVX2__
inline ProblemSet mask_bits(__m256d mask) { return static_cast<ProblemSet>(_mm256_movemask_pd(mask)); }
inline void set_mask(ProblemSet set, __m256d& mask) {
  const __m256i bit = _mm256_set_epi64x(8, 4, 2, 1);
  mask = _mm256_castsi256_pd(_mm256_cmpeq_epi64(_mm256_and_si256(_mm256_set1_epi64x(set), bit), bit));
}
#ifndef __AVX512F__
// Faster than the instruction of that name.
inline __m256d gather(const double* const from[4]) {
  const __m128d low = _mm_loadh_pd(_mm_load_sd(from[0]), from[1]);
  const __m128d high = _mm_loadh_pd(_mm_load_sd(from[2]), from[3]);
  return _mm256_insertf128_pd(_mm256_castpd128_pd256(low), high, 1);
}
#endif
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
inline void set_mask(ProblemSet set, __mmask8& mask) { mask = static_cast<__mmask8>(set); }
inline __m512d gather(const double* const from[8]) { return _mm512_i64gather_pd(_mm512_loadu_si512(from), nullptr, 1); }
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

inline LaneMask mask_of(ProblemSet set) {
  LaneMask::register_type mask;
  set_mask(set, mask);
  return mask;
}

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
  Row plane;  // number of the entering plane, see Looks
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

// All but the entering plane itself.
inline ActiveSet<Lanes> load_active(const Group& group, std::size_t at) {
  ActiveSet<Lanes> active;
  active.y = load3(group.y, at);
  for (std::size_t j = 0; j < 3; ++j) {
    active.n[j] = load3(group.n[j], at);
    active.u[j] = load(group.u[j], at);
  }
  active.size = load(group.size, at);
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
    store(zero, group.plane, at);
    store3(factor.backward(active.y), group.x, at);
  }
  return positive;
}

// The planes that the problems of a group violate most. A row is a problem's: its faces are dealt to its lanes in turn,
// and what remains in a lane is the least slack, the tolerance at most, with the first plane that has it. Face k's
// planes have the numbers k, upper_numbers + k, inward_numbers + k, ordered as the scalar solver visits them.
struct Looks {
  Register slack[group_size];
  Register plane[group_size];
};

constexpr std::uint32_t upper_numbers = 1 << 20;
constexpr std::uint32_t inward_numbers = 2 << 20;

// The least slack in each lane, and the face it belongs to.
struct Least {
  Lanes slack, face;

  void see(const Lanes& other_slack, const Lanes& other_face) {
    face = select(other_slack < slack, other_face, face);
    slack = min(other_slack, slack);  // the second if the first is a NaN
  }
};

// As find_violation, a vector of faces at a time and without a branch on what is found.
class Look {
 public:
  Look(const Triple<double>& point, double tolerance)
      : x_(point.x), y_(point.y), z_(point.z), lower_{Lanes(-tolerance), Lanes(0.0)}, upper_(lower_), inward_(lower_) {}

  // The last vector may overlap the one before: faces seen twice change nothing.
  void see(const SlabRows& slabs) {
    constexpr std::size_t width = Lanes::size;
    for (std::size_t i = 0; i < least_row_length; i += width) {
      const std::size_t at = i + width < least_row_length ? i : least_row_length - width;
      see(slabs.rows + at, slabs.length, static_cast<double>(at));
    }
    for (std::size_t i = least_row_length; __builtin_expect(i < slabs.length, false); i += width) {
      const std::size_t at = i + width < slabs.length ? i : slabs.length - width;
      see(slabs.rows + at, slabs.length, static_cast<double>(at));
    }
  }

  void store(Looks& looks, std::size_t row) const {
    Least all = lower_;
    all.see(upper_.slack, upper_.face + Lanes(double{upper_numbers}));
    all.see(inward_.slack, inward_.face + Lanes(double{inward_numbers}));
    looks.slack[row] = all.slack;
    looks.plane[row] = all.face;
  }

 private:
  // The faces from number k on; `row` points to them in the first row.
  void see(const double* row, std::size_t length, double k) {
    alignas(64) static constexpr double numbers[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    static_assert(slab_lower == 3 && slab_upper == 4 && slab_inward == 5 && slab_inward_offset == 8);
    const double* const middle = row + 3 * length;
    const double* const end = middle + 3 * length;
    const Lanes face = Lanes::load_aligned(numbers) + Lanes(k);
    const Lanes d = load(row) * x_ + load(row + length) * y_ + load(row + 2 * length) * z_;
    const Lanes inward = load(middle + 2 * length) * x_ + load(end) * y_ + load(end + length) * z_;
    lower_.see(d - load(middle), face);
    upper_.see(load(middle + length) - d, face);
    inward_.see(inward - load(end + 2 * length), face);
  }

  static Lanes load(const double* from) { return Lanes::load_unaligned(from); }

  Lanes x_, y_, z_;
  Least lower_, upper_, inward_;
};

// Solves one group after the other.
class GroupSolver {
 public:
  explicit GroupSolver(const QpBatchArrays& batch) : batch_(batch), ahead_(batch.rows) {}

  // Up to group_size problems.
  void solve(std::size_t begin, std::size_t count) {
    begin_ = begin;
    const ProblemSet all = (1u << count) - 1;
    fetch_next(begin + group_size);
    running_ = looking_ = all & start_group(count);
    for (int steps = 0;; ++steps) {
      const ProblemSet done = look();
      solved_ |= done;
      running_ &= ~done;
      if (running_ == 0 || steps == max_steps) break;
      // A step adds an active plane at most.
      if (steps == 0)
        step_group<0>();
      else if (steps == 1)
        step_group<1>();
      else
        step_group<3>();
    }
    finish(count);
  }

 private:
  static constexpr ProblemSet one_vector = (1u << Lanes::size) - 1;

  // The lanes of a group that is not full repeat its first problem. Returns the problems whose forms are positive
  // definite.
  ProblemSet start_group(std::size_t count) {
    Row form[6], linear[3];
    for (std::size_t l = 0; l < group_size; ++l) {
      const std::size_t i = begin_ + (l < count ? l : 0);
      for (std::size_t k = 0; k < 6; ++k) form[k].of[l] = batch_.form[6 * i + k];
      for (std::size_t k = 0; k < 3; ++k) linear[k].of[l] = batch_.linear[3 * i + k];
      slabs_[l] = batch_.row_length[i] != 0 ? slabs_of(batch_, i) : SlabRows{free_rows, least_row_length};
    }
    solved_ = infeasible_ = 0;
    return start(form, linear, group_);
  }

  // Finds the plane to enter for each problem that looks. Returns those that violate none.
  ProblemSet look() {
    for (ProblemSet rest = looking_; rest != 0; rest &= rest - 1) look_at(first_of(rest));
    ProblemSet entering = 0;
    for (std::size_t at = 0; at < group_size; at += Lanes::size) {
      const ProblemSet part = looking_ >> at & one_vector;
      if (part != 0) entering |= choose_planes(part, at) << at;
    }
    return looking_ & ~entering;
  }

  void look_at(std::size_t l) {
    fetch_ahead();
    const Triple<double> x{group_.x[0].of[l], group_.x[1].of[l], group_.x[2].of[l]};
    Look look(x, batch_.tolerance);
    look.see(slabs_[l]);
    look.store(looks_, l);
  }

  // The planes of the next groups, a few lines at each look: so the memory is busy all the time and never too busy.
  void fetch_ahead() {
    constexpr std::size_t line = 64 / sizeof(double);
    constexpr std::size_t lines = 5;
    for (std::size_t k = 0; k < lines; ++k) __builtin_prefetch(ahead_ + k * line);
    ahead_ += ahead_ < fetched_ ? lines * line : 0;
  }

  // From the end of this group to that of the next.
  void fetch_next(std::size_t next) {
    ahead_ = ahead_ < rows_end(next) ? rows_end(next) : ahead_;
    fetched_ = rows_end(next + group_size);
  }

  // Where the rows of the problems before number i end.
  const double* rows_end(std::size_t i) const {
    const SlabRows last = slabs_of(batch_, (i < batch_.count ? i : batch_.count) - 1);
    return last.rows + slab_rows * last.length;
  }

  // Writes the planes to enter of the problems of `looking`, in the vector at `at`. Returns the problems that have one.
  ProblemSet choose_planes(ProblemSet looking, std::size_t at) {
    const Lanes slack = row_minima(looks_.slack + at);
    Row least;
    store(slack, least, 0);
    Register number[Lanes::size];
    for (std::size_t l = 0; l < Lanes::size; ++l)
      number[l] =
          select(Lanes(looks_.slack[at + l]) == Lanes(least.of[l]), Lanes(looks_.plane[at + l]), Lanes(infinity));
    const Lanes plane = row_minima(number);
    const ProblemSet entering = looking & bits(slack < Lanes(-batch_.tolerance));
    // The others are done, or go on with the plane of their last step.
    const LaneMask chosen = mask_of(entering);
    store(select(chosen, plane, load(group_.plane, at)), group_.plane, at);
    store(select(chosen, slack, load(group_.slack, at)), group_.slack, at);
    return entering;
  }

  // One step of the running problems, which have up to `most` active planes.
  template <int most>
  void step_group() {
    ProblemSet entered = 0, infeasible = 0;
    for (std::size_t at = 0; at < group_size; at += Lanes::size) {
      const ProblemSet part = running_ >> at & one_vector;
      if (part == 0) continue;
      const StepResult<Lanes> result = step_vector<most>(mask_of(part), at);
      entered |= bits(result.entered) << at;
      infeasible |= bits(result.infeasible) << at;
    }
    infeasible_ |= running_ & infeasible;
    running_ &= ~infeasible;
    looking_ = running_ & entered;
  }

  // The lanes that do not run compute nonsense, but keep their x.
  template <int most>
  StepResult<Lanes> step_vector(const LaneMask& running, std::size_t at) {
    const Cholesky<Lanes> factor = load_factor(group_, at);
    ActiveSet<Lanes> active = load_active(group_, at);
    active.entering = factor.forward(entering_normals(at));
    const StepResult<Lanes> result = step<most>(active, running);
    active.entering_multiplier = select(result.entered, Lanes(0.0), active.entering_multiplier);
    store_active(active, group_, at);
    store3(select<Lanes>(running, factor.backward(active.y), load3(group_.x, at)), group_.x, at);
    return result;
  }

  Triple<Lanes> entering_normals(std::size_t at) const {
    const double* x[Lanes::size];
    const double* y[Lanes::size];
    const double* z[Lanes::size];
    for (std::size_t l = 0; l < Lanes::size; ++l) {
      // Without a branch: nobody foresees which kind of plane enters.
      const auto number = static_cast<std::uint32_t>(static_cast<std::int32_t>(group_.plane.of[at + l]));
      const std::size_t inward = number / inward_numbers;
      const SlabRows& slabs = slabs_[at + l];
      x[l] = slabs.rows + number % upper_numbers + inward * slab_inward * slabs.length;
      y[l] = x[l] + slabs.length;
      z[l] = y[l] + slabs.length;
    }
    const Lanes plane = load(group_.plane, at);
    const LaneMask turned = (plane >= Lanes(double{upper_numbers})) & (plane < Lanes(double{inward_numbers}));
    const Lanes sign = select(turned, Lanes(-0.0), Lanes(0.0));
    return {Lanes(gather(x)) ^ sign, Lanes(gather(y)) ^ sign, Lanes(gather(z)) ^ sign};
  }

  void finish(std::size_t count) {
    for (std::size_t l = 0; l < count; ++l)
      batch_.status[begin_ + l] = (infeasible_ >> l & 1) != 0 ? QpStatus::infeasible : QpStatus::not_converged;
    for (ProblemSet rest = solved_; rest != 0; rest &= rest - 1) finish_at(first_of(rest));
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

  const QpBatchArrays& batch_;
  std::size_t begin_ = 0;
  ProblemSet running_ = 0, looking_ = 0, solved_ = 0, infeasible_ = 0;
  const double* ahead_;              // what to fetch next
  const double* fetched_ = nullptr;  // where to stop
  SlabRows slabs_[group_size];
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
