// The arithmetic of the dual active-set method, once for all: V is a double, or a vector of doubles with a problem in
// each lane.
//
// Every operation acts on each lane alone and rounds as IEEE 754 says, nothing is fused or reordered: a problem has the
// same solution, bit for bit, whichever V computes it.
//
// For the sources named qp3*.cpp only. All is in an unnamed namespace, although a header, and uses plain types only:
// an inline function compiled for AVX must never be the copy that the linker picks for everybody.
#pragma once

#include <cstddef>

#include "core/qp3_problem.h"

namespace prcage {
namespace {

constexpr double infinity = __builtin_huge_val();

// Most steps that a problem gets; more than ten are rare already.
constexpr int max_steps = 100;

// A double is a batch of one lane.
inline double select(bool condition, double yes, double no) { return condition ? yes : no; }
inline bool any(bool condition) { return condition; }

// Whether to compute what only lanes with the condition need. A vector does not ask: too often some lane does, and a
// branch that was foreseen wrongly costs more than the arithmetic.
inline bool worthwhile(bool condition) { return condition; }
template <class M>
inline bool worthwhile(const M&) {
  return true;
}

inline double sqrt(double x) { return __builtin_sqrt(x); }

template <class V>
using Mask = decltype(V() < V());

template <class V>
struct Triple {
  V x, y, z;
};

template <class V>
inline V dot(const Triple<V>& a, const Triple<V>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class V>
inline Triple<V> cross(const Triple<V>& a, const Triple<V>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class V>
inline Triple<V> times(const V& s, const Triple<V>& a) {
  return {s * a.x, s * a.y, s * a.z};
}

template <class V>
inline Triple<V> operator+(const Triple<V>& a, const Triple<V>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

template <class V>
inline Triple<V> operator-(const Triple<V>& a, const Triple<V>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <class V>
inline Triple<V> select(const Mask<V>& condition, const Triple<V>& yes, const Triple<V>& no) {
  return {select(condition, yes.x, no.x), select(condition, yes.y, no.y), select(condition, yes.z, no.z)};
}

// Lower Cholesky factor L of the form, G = L L^T, with the reciprocals of its diagonal. In whitened coordinates
// y = L^T x the form is half the squared norm.
template <class V>
struct Cholesky {
  V i00, l10, i11, l20, l21, i22;

  // L^-1 v
  Triple<V> forward(const Triple<V>& v) const {
    const V y0 = v.x * i00;
    const V y1 = (v.y - l10 * y0) * i11;
    const V y2 = (v.z - l20 * y0 - l21 * y1) * i22;
    return {y0, y1, y2};
  }
  // L^-T v
  Triple<V> backward(const Triple<V>& v) const {
    const V x2 = v.z * i22;
    const V x1 = (v.y - l21 * x2) * i11;
    const V x0 = (v.x - l10 * x1 - l20 * x2) * i00;
    return {x0, x1, x2};
  }
};

// True where G is positive definite, as far as rounding tells.
template <class V>
inline Mask<V> factorize(const V G[6], Cholesky<V>& factor) {
  const V one(1.0), zero(0.0);
  const V d0 = G[0];
  factor.i00 = one / sqrt(d0);
  factor.l10 = G[1] * factor.i00;
  factor.l20 = G[2] * factor.i00;
  const V d1 = G[3] - factor.l10 * factor.l10;
  factor.i11 = one / sqrt(d1);
  factor.l21 = (G[4] - factor.l20 * factor.l10) * factor.i11;
  const V d2 = G[5] - factor.l20 * factor.l20 - factor.l21 * factor.l21;
  factor.i22 = one / sqrt(d2);
  return (d0 > zero) & (d1 > zero) & (d2 > zero);
}

// The dual active-set method between two looks at the planes, whitened coordinates: the iterate, the independent
// normals of the active planes with their multipliers, and the plane on its way into the set.
template <class V>
struct ActiveSet {
  Triple<V> y;
  Triple<V> n[3];  // zero beyond size
  V u[3];
  V size;
  Triple<V> entering;
  V entering_multiplier;
  V slack;  // of the entering plane, negative
};

// What one step did; neither: it dropped an active plane and the next step goes on with the same entering one.
template <class V>
struct StepResult {
  Mask<V> entered;     // the plane is active now
  Mask<V> infeasible;  // no point satisfies the active planes and the entering one
};

// The entering normal as a sum of r_j n_j and of z, orthogonal to all n_j. No lane has more than `most` active planes;
// those not in `live` may compute nonsense.
template <int most, class V>
inline void decompose(const ActiveSet<V>& s, const Mask<V>& live, V r[3], Triple<V>& z) {
  const V zero(0.0), one(1.0);
  const Triple<V>& a = s.entering;
  const Mask<V> several = s.size > one;
  r[0] = r[1] = r[2] = zero;
  z = a;
  if constexpr (most == 0) return;
  if (any(live & (s.size < V(2.0)))) {
    const V square = select(s.size < one, one, dot(s.n[0], s.n[0]));
    r[0] = dot(s.n[0], a) / square;
    z = a - times(r[0], s.n[0]);
  }
  if (most > 1 && worthwhile(several)) {
    // With two normals their cross product completes the basis, and the share along it is z.
    const Mask<V> all = s.size > V(2.0);
    const Triple<V> across = cross(s.n[0], s.n[1]);
    const Triple<V> third = select<V>(all, s.n[2], across);
    const Triple<V> dual0 = cross(s.n[1], third);
    const Triple<V> dual1 = cross(third, s.n[0]);
    const V scale = one / dot(s.n[0], dual0);
    const V share = dot(a, across) * scale;
    r[0] = select(several, dot(a, dual0) * scale, r[0]);
    r[1] = select(several, dot(a, dual1) * scale, zero);
    r[2] = select(all, share, zero);
    z = select<V>(several, times(select(all, zero, share), across), z);
  }
}

// Appends the entering plane to the active ones of the lanes in `where`.
template <int most, class V>
inline void append(ActiveSet<V>& s, const Mask<V>& where) {
  const Mask<V> first = where & (s.size < V(1.0));
  const Mask<V> third = where & (s.size > V(1.0));
  const Mask<V> second = where & (s.size > V(0.0)) & (s.size < V(2.0));
  const Mask<V> slot[3] = {first, second, third};
  for (int j = 0; j < (most < 3 ? most + 1 : 3); ++j) {
    s.n[j] = select<V>(slot[j], s.entering, s.n[j]);
    s.u[j] = select(slot[j], s.entering_multiplier, s.u[j]);
  }
  s.size = select(where, s.size + V(1.0), s.size);
}

// Takes active plane `which` out of the lanes in `where`.
template <class V>
inline void drop(ActiveSet<V>& s, const Mask<V>& where, const V& which) {
  const V zero(0.0), one(1.0);
  const Mask<V> from_first = where & (which < one);
  const Mask<V> from_second = where & (which < V(2.0));
  s.n[0] = select<V>(from_first, s.n[1], s.n[0]);
  s.u[0] = select(from_first, s.u[1], s.u[0]);
  s.n[1] = select<V>(from_second, s.n[2], s.n[1]);
  s.u[1] = select(from_second, s.u[2], s.u[1]);
  s.n[2] = select<V>(where, {zero, zero, zero}, s.n[2]);
  s.u[2] = select(where, zero, s.u[2]);
  s.size = select(where, s.size - one, s.size);
}

// One step of the entering plane: moves y along the boundary of the active set until the plane is reached or the
// multiplier of an active plane vanishes. `most` and `live` as for decompose().
template <int most, class V>
[[gnu::always_inline]] inline StepResult<V> step(ActiveSet<V>& s, const Mask<V>& live) {
  const V zero(0.0), never(infinity);
  V r[3];
  Triple<V> z;
  decompose<most>(s, live, r, z);
  const V zz = dot(z, s.entering);
  const Mask<V> independent = zz > V(1e-12) * dot(s.entering, s.entering);
  const V full = select(independent, (zero - s.slack) / zz, never);

  const V threshold(1e-14);
  V partial = never;
  V blocking = zero;
  for (int j = 0; j < most; ++j) {
    const Mask<V> falls = r[j] > threshold;
    if (!worthwhile(falls)) continue;
    const V length = select(falls, s.u[j] / r[j], never);
    const Mask<V> earlier = length < partial;
    partial = select(earlier, length, partial);
    blocking = select(earlier, V(static_cast<double>(j)), blocking);
  }

  // The entering plane is reached first, or an active one leaves first, or neither and there is no way on.
  const Mask<V> entered = (full <= partial) & (full < never);
  const Mask<V> leaves = partial < full;
  const V t = select(full < partial, full, partial);
  for (int j = 0; j < most; ++j) s.u[j] = s.u[j] - t * r[j];
  s.entering_multiplier = s.entering_multiplier + t;
  s.y = select<V>(independent, s.y + times(t, z), s.y);
  s.slack = select(independent, s.slack + t * zz, s.slack);
  append<most>(s, entered);
  if (most > 0 && any(live & leaves)) drop(s, leaves, blocking);
  return {entered, t >= never};
}

inline SlabRows slabs_of(const QpBatchArrays& batch, std::size_t i) {
  return {batch.rows + batch.first_row[i], batch.row_length[i]};
}

// The plane that a point violates most, the first of several.
struct Violation {
  std::size_t plane;
  double slack;
};

// False if no plane is violated by more than the tolerance.
inline bool find_violation(const PlaneArrays& planes, const Triple<double>& x, double tolerance, Violation& found) {
  found = {planes.count, -tolerance};
  for (std::size_t i = 0; i < planes.count; ++i) {
    const double slack = planes.nx[i] * x.x + planes.ny[i] * x.y + planes.nz[i] * x.z - planes.offset[i];
    if (slack < found.slack) found = {i, slack};
  }
  return found.plane < planes.count;
}

// False if no plane is violated by more than the tolerance. Lower bounds come before upper ones, and these before the
// half-spaces. Conditions that hold now and then, without a pattern, are marked as such: better no branch.
inline bool find_violation(const SlabRows& slabs, const Triple<double>& x, double tolerance, Violation& found) {
  const std::size_t n = slabs.length;
  const double* const nx = slabs.rows;
  const double *const ny = nx + n, *const nz = ny + n;
  const double *const lower_bound = nx + slab_lower * n, *const upper_bound = nx + slab_upper * n;
  Violation lower{3 * n, -tolerance}, upper = lower, side = lower;
  for (std::size_t i = 0; i < n; ++i) {
    const double d = nx[i] * x.x + ny[i] * x.y + nz[i] * x.z;
    const double above = d - lower_bound[i], below = upper_bound[i] - d;
    if (__builtin_expect_with_probability(above < lower.slack, 1, 0.5)) lower = {i, above};
    if (__builtin_expect_with_probability(below < upper.slack, 1, 0.5)) upper = {i, below};
  }
  const double* const ix = nx + slab_inward * n;
  const double *const iy = ix + n, *const iz = iy + n, *const inward_offset = nx + slab_inward_offset * n;
  for (std::size_t i = 0; i < n; ++i) {
    const double inside = ix[i] * x.x + iy[i] * x.y + iz[i] * x.z - inward_offset[i];
    if (__builtin_expect_with_probability(inside < side.slack, 1, 0.5)) side = {i, inside};
  }
  found = lower;
  if (upper.slack < found.slack) found = {n + upper.plane, upper.slack};
  if (side.slack < found.slack) found = {2 * n + side.plane, side.slack};
  return found.plane < 3 * n;
}

inline Triple<double> normal_of(const PlaneArrays& planes, std::size_t i) {
  return {planes.nx[i], planes.ny[i], planes.nz[i]};
}

inline Triple<double> normal_of(const SlabRows& slabs, std::size_t i) {
  const std::size_t n = slabs.length;
  const double* const row = slabs.rows + (i < 2 * n ? slab_normal : slab_inward) * n + i % n;
  const Triple<double> a{row[0], row[n], row[2 * n]};
  return i >= n && i < 2 * n ? Triple<double>{-a.x, -a.y, -a.z} : a;
}

// Of a point that violates no plane. Numbers that overflow violate none either.
inline QpStatus status_at(const Triple<double>& x) {
  const bool finite = x.x - x.x == 0 && x.y - x.y == 0 && x.z - x.z == 0;
  return finite ? QpStatus::solved : QpStatus::not_converged;
}

}  // namespace
}  // namespace prcage
