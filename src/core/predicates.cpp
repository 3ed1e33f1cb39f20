#include "core/predicates.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Gmpq.h>
#include <CGAL/Segment_3.h>
#include <CGAL/Triangle_3.h>
#include <xmmintrin.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace prcage::exact {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Segment = Kernel::Segment_3;
using TriangleK = Kernel::Triangle_3;

Point point(const double* p) { return {p[0], p[1], p[2]}; }

bool equal(const double* p, const double* q) { return p[0] == q[0] && p[1] == q[1] && p[2] == q[2]; }

// Interval filters and their exact fallback are wrong when denormals are flushed to zero.
void assert_denormals_live() { assert((_mm_getcsr() & 0x8040u) == 0); }

// The two extreme points of three collinear points: on a line the lexicographic order is the order along it.
std::array<const double*, 2> extremes(const double* a, const double* b, const double* c) {
  const auto less = [](const double* p, const double* q) { return std::lexicographical_compare(p, p + 3, q, q + 3); };
  return {std::min({a, b, c}, less), std::max({a, b, c}, less)};
}

// A closed segment that may be a point.
struct Span {
  const double* p;
  const double* q;
  bool is_point() const { return equal(p, q); }
};

bool point_on_segment(const double* x, const Span& s) { return Segment(point(s.p), point(s.q)).has_on(point(x)); }

bool intersect(const Span& s, const Span& t) {
  if (s.is_point() && t.is_point()) return equal(s.p, t.p);
  if (s.is_point()) return point_on_segment(s.p, t);
  if (t.is_point()) return point_on_segment(t.p, s);
  return CGAL::do_intersect(Segment(point(s.p), point(s.q)), Segment(point(t.p), point(t.q)));
}

bool intersect(const Span& s, const TriangleK& triangle) {
  if (s.is_point()) return triangle.has_on(point(s.p));
  return CGAL::do_intersect(Segment(point(s.p), point(s.q)), triangle);
}

}  // namespace

int orient3d(const double* a, const double* b, const double* c, const double* d) {
  assert_denormals_live();
  return static_cast<int>(CGAL::orientation(point(a), point(b), point(c), point(d)));
}

bool collinear(const double* a, const double* b, const double* c) {
  assert_denormals_live();
  return CGAL::collinear(point(a), point(b), point(c));
}

int coplanar_side(const double* p, const double* q, const double* r, const double* s) {
  assert_denormals_live();
  return static_cast<int>(CGAL::coplanar_orientation(point(p), point(q), point(r), point(s)));
}

bool segment_triangle_intersect(const double* p, const double* q, const double* a, const double* b, const double* c) {
  assert_denormals_live();
  const Span segment{p, q};
  if (collinear(a, b, c)) {
    const auto ends = extremes(a, b, c);
    return intersect(segment, Span{ends[0], ends[1]});
  }
  return intersect(segment, TriangleK(point(a), point(b), point(c)));
}

bool triangles_intersect(const double* a0, const double* a1, const double* a2, const double* b0, const double* b1,
                         const double* b2) {
  assert_denormals_live();
  if (collinear(a0, a1, a2)) {
    const auto ends = extremes(a0, a1, a2);
    return segment_triangle_intersect(ends[0], ends[1], b0, b1, b2);
  }
  if (collinear(b0, b1, b2)) {
    const auto ends = extremes(b0, b1, b2);
    return segment_triangle_intersect(ends[0], ends[1], a0, a1, a2);
  }
  return CGAL::do_intersect(TriangleK(point(a0), point(a1), point(a2)), TriangleK(point(b0), point(b1), point(b2)));
}

int volume_sign(const double* const* corners, std::size_t face_count) {
  assert_denormals_live();
  if (face_count == 0) return 0;
  // Floating-point sum with a running bound first. The origin is moved to a corner, which changes nothing for a
  // closed surface and keeps the terms small. Each determinant has a relative error below 16 ulp of the sum of its
  // absolute terms (three differences, two products, two sums), each addition half an ulp of the sum of magnitudes;
  // what is lost to underflow is far below the constant.
  const double* const o = corners[0];
  double sum = 0;
  double magnitude = 0;
  for (std::size_t f = 0; f < face_count; ++f) {
    double x[3][3];
    for (std::size_t i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) x[i][j] = corners[3 * f + i][j] - o[j];
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const int k = (i + 2) % 3;
      const double jk = x[1][j] * x[2][k];
      const double kj = x[1][k] * x[2][j];
      sum += x[0][i] * (jk - kj);
      magnitude += std::abs(x[0][i]) * (std::abs(jk) + std::abs(kj));
    }
  }
  const double bound = magnitude * (32.0 + 4.0 * static_cast<double>(face_count)) * 1.2e-16 + 1e-280;
  if (sum > bound) return 1;
  if (sum < -bound) return -1;
  CGAL::Gmpq exact_sum(0);
  for (std::size_t f = 0; f < face_count; ++f) {
    std::array<std::array<CGAL::Gmpq, 3>, 3> x;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) x[i][j] = CGAL::Gmpq(corners[3 * f + i][j]);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      const std::size_t k = (i + 2) % 3;
      exact_sum += x[0][i] * (x[1][j] * x[2][k] - x[1][k] * x[2][j]);
    }
  }
  return static_cast<int>(CGAL::sign(exact_sum));
}

void unit_normal(const double* a, const double* b, const double* c, double* normal) {
  std::array<CGAL::Gmpq, 3> u, v, n;
  for (std::size_t k = 0; k < 3; ++k) {
    u[k] = CGAL::Gmpq(b[k]) - CGAL::Gmpq(a[k]);
    v[k] = CGAL::Gmpq(c[k]) - CGAL::Gmpq(a[k]);
  }
  CGAL::Gmpq largest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    largest = std::max(largest, CGAL::abs(n[k]));
  }
  double squared = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    normal[k] = largest == 0 ? 0 : CGAL::to_double(n[k] / largest);
    squared += normal[k] * normal[k];
  }
  for (std::size_t k = 0; k < 3 && squared > 0; ++k) normal[k] /= std::sqrt(squared);
}

}  // namespace prcage::exact
