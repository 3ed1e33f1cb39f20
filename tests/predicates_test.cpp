// The exact predicates against answers known by construction or computed in integers, where floating point alone is
// wrong; and the tests on triangle pairs, all ways to share vertices included.
#include "core/predicates.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "core/triangle_pair.h"
#include "core/vec3.h"
#include "parallel/arena.h"
#include "solids.h"

namespace prcage {
namespace {

using P = Position;

__extension__ using Int128 = __int128;

int sign(Int128 x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

// Exact for integer coordinates below 2^32.
int integer_orient3d(const P& a, const P& b, const P& c, const P& d) {
  Int128 m[3][3];
  for (std::size_t k = 0; k < 3; ++k) {
    m[0][k] = static_cast<std::int64_t>(b[k]) - static_cast<std::int64_t>(a[k]);
    m[1][k] = static_cast<std::int64_t>(c[k]) - static_cast<std::int64_t>(a[k]);
    m[2][k] = static_cast<std::int64_t>(d[k]) - static_cast<std::int64_t>(a[k]);
  }
  return sign(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
              m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]));
}

int orient3d(const P& a, const P& b, const P& c, const P& d) {
  return exact::orient3d(a.data(), b.data(), c.data(), d.data());
}

TEST(Predicates, OrientationSidesFollowTheNormal) {
  const P a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0};
  EXPECT_EQ(orient3d(a, b, c, {0, 0, 1}), 1);
  EXPECT_EQ(orient3d(a, b, c, {0, 0, -1}), -1);
  EXPECT_EQ(orient3d(a, b, c, {5, 7, 0}), 0);
}

// d is a plus an integer combination of b - a and c - a, then moved by at most one unit: the determinant is a tiny
// fraction of its terms, so that floating point alone cannot tell its sign.
TEST(Predicates, OrientationIsExactNextToThePlane) {
  std::mt19937_64 random(1);
  std::uniform_int_distribution<int> coordinate(-(1 << 26), 1 << 26), factor(-8, 8), nudge(-1, 1);
  int seen[3] = {0, 0, 0};
  for (int trial = 0; trial < 20000; ++trial) {
    P a, b, c, d;
    const int s = factor(random), t = factor(random);
    for (std::size_t k = 0; k < 3; ++k) {
      a[k] = coordinate(random);
      b[k] = coordinate(random);
      c[k] = coordinate(random);
      d[k] = a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]) + (trial % 4 == 0 ? 0 : nudge(random));
    }
    const int expected = integer_orient3d(a, b, c, d);
    ASSERT_EQ(orient3d(a, b, c, d), expected);
    ++seen[expected + 1];
  }
  for (const int n : seen) EXPECT_GT(n, 1000);
}

// The line through (0.5, 0.5), (12, 12), (24, 24) and points a few ulp beside it: the classical example in which
// rounding gives all three signs at random.
TEST(Predicates, CollinearIsExactBesideTheDiagonal) {
  const P q{12, 12, 0}, r{24, 24, 0};
  for (int i = 0; i < 32; ++i)
    for (int j = 0; j < 32; ++j) {
      const P p{0.5 + i * 0x1p-53, 0.5 + j * 0x1p-53, 0};
      ASSERT_EQ(exact::collinear(p.data(), q.data(), r.data()), i == j) << i << ' ' << j;
      const P above{0, 0, 1};
      ASSERT_EQ(orient3d(p, q, r, above), i == j ? 0 : i > j ? -1 : 1) << i << ' ' << j;
    }
}

TEST(Predicates, CollinearAtTheEndsOfTheRange) {
  for (const double scale : {1e-150, 1.0, 1e15}) {
    const P a{scale, 2 * scale, 3 * scale}, b{2 * scale, 4 * scale, 6 * scale}, c{4 * scale, 8 * scale, 12 * scale};
    P off = c;
    off[1] = std::nextafter(off[1], 0.0);
    EXPECT_TRUE(exact::collinear(a.data(), b.data(), c.data())) << scale;
    EXPECT_FALSE(exact::collinear(a.data(), b.data(), off.data())) << scale;
    EXPECT_TRUE(exact::collinear(a.data(), a.data(), c.data())) << scale;
  }
}

TEST(Predicates, DenormalsCount) {
  const double tiny = std::numeric_limits<double>::denorm_min();
  Arena(1).run([&] {
    EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, tiny}), 1);
    EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, -tiny}), -1);
  });
}

TEST(Predicates, CoplanarSide) {
  const P p{0, 0, 0}, q{1, 0, 0}, r{0.5, 1, 0};
  const auto side = [&](const P& s) { return exact::coplanar_side(p.data(), q.data(), r.data(), s.data()); };
  EXPECT_EQ(side({9, 1e-300, 0}), 1);
  EXPECT_EQ(side({-4, 0, 0}), 0);
  EXPECT_EQ(side({0.5, -1, 0}), -1);
}

bool meet(const std::array<P, 3>& a, const std::array<P, 3>& b) {
  return exact::triangles_intersect(a[0].data(), a[1].data(), a[2].data(), b[0].data(), b[1].data(), b[2].data());
}

TEST(Predicates, TrianglesTouchOrMissByOneUlp) {
  const std::array<P, 3> flat{P{0, 0, 0}, P{1, 0, 0}, P{0, 1, 0}};
  const auto spike = [](double z) { return std::array<P, 3>{P{0.25, 0.25, z}, P{0.3, 0.25, 1}, P{0.25, 0.3, 1}}; };
  EXPECT_TRUE(meet(flat, spike(0)));
  EXPECT_TRUE(meet(flat, spike(-1e-300)));
  EXPECT_FALSE(meet(flat, spike(1e-300)));
  EXPECT_FALSE(meet(flat, {P{0.5, std::nextafter(0.5, 1), 0}, P{1, 1, 0}, P{1, 2, 0}}));
  EXPECT_TRUE(meet(flat, {P{0.5, 0.5, 0}, P{1, 1, 0}, P{1, 2, 0}}));
}

TEST(Predicates, DegenerateTrianglesAreSegmentsAndPoints) {
  const std::array<P, 3> flat{P{0, 0, 0}, P{1, 0, 0}, P{0, 1, 0}};
  const std::array<P, 3> segment{P{0.2, 0.2, 0}, P{0.2, 0.2, 2}, P{0.2, 0.2, -1}};
  const std::array<P, 3> short_segment{P{0.2, 0.2, 0.5}, P{0.2, 0.2, 2}, P{0.2, 0.2, 1}};
  const std::array<P, 3> point{P{0.2, 0.2, 0}, P{0.2, 0.2, 0}, P{0.2, 0.2, 0}};
  EXPECT_TRUE(meet(flat, segment));
  EXPECT_TRUE(meet(segment, flat));
  EXPECT_FALSE(meet(flat, short_segment));
  EXPECT_FALSE(meet(short_segment, flat));
  EXPECT_TRUE(meet(flat, point));
  EXPECT_TRUE(meet(point, segment));
  EXPECT_FALSE(meet(point, short_segment));
  EXPECT_TRUE(meet(segment, short_segment));
  EXPECT_TRUE(meet(point, point));
}

int volume_sign(const Mesh& mesh) {
  std::vector<const double*> corners;
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) corners.push_back(mesh.positions[v].data());
  return exact::volume_sign(corners.data(), mesh.triangles.size());
}

TEST(Predicates, VolumeSign) {
  const Mesh cube = testing::cube(1, {3, 4, 5});
  EXPECT_EQ(volume_sign(cube), 1);
  EXPECT_EQ(volume_sign(testing::inside_out(cube)), -1);
  EXPECT_EQ(volume_sign(testing::scaled(cube, 1e-60)), 1);
  EXPECT_EQ(volume_sign(testing::scaled(testing::inside_out(cube), 1e-100)), -1);
  EXPECT_EQ(exact::volume_sign(nullptr, 0), 0);

  Mesh flat = testing::tetrahedron();
  flat.positions[3] = {0.25, 0.5, 0};
  EXPECT_EQ(volume_sign(flat), 0);
  flat.positions[3][2] = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(volume_sign(flat), 1);
}

// A box of one unit in the last place, far from the origin.
TEST(Predicates, VolumeSignFarAway) {
  Mesh mesh = testing::cube(1);
  for (auto& p : mesh.positions)
    for (double& x : p) x = x > 0 ? std::nextafter(1e15, 2e15) : 1e15;
  EXPECT_EQ(volume_sign(mesh), 1);
  EXPECT_EQ(volume_sign(testing::inside_out(mesh)), -1);
}

// ------------------------------------------------------------------------------- triangle pairs

bool improper(const std::vector<P>& p, Triangle a, Triangle b) {
  const auto ref = [&](const Triangle& t) {
    return TriangleRef{{p[t[0]].data(), p[t[1]].data(), p[t[2]].data()}, {t[0], t[1], t[2]}};
  };
  const bool result = improper_contact(ref(a), ref(b));
  EXPECT_EQ(improper_contact(ref(b), ref(a)), result);
  EXPECT_EQ(improper_contact(ref({a[1], a[2], a[0]}), ref({b[2], b[1], b[0]})), result);
  return result;
}

TEST(TrianglePair, WithoutCommonVertexTouchingCounts) {
  std::vector<P> p{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {-1, 0, 1}, {0, -1, 1}};
  EXPECT_TRUE(improper(p, {0, 1, 2}, {3, 4, 5}));  // equal positions under different numbers
  p[3][2] = 1e-300;
  EXPECT_FALSE(improper(p, {0, 1, 2}, {3, 4, 5}));
}

TEST(TrianglePair, WithOneCommonVertexTheOppositeEdgesDecide) {
  std::vector<P> p{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 1}, {1, 1, 2}};
  EXPECT_FALSE(improper(p, {0, 1, 2}, {0, 3, 4}));
  p[4] = {1, 1, -1};
  EXPECT_TRUE(improper(p, {0, 1, 2}, {0, 3, 4}));  // pierces
  p[3] = {1, 0, 0};
  EXPECT_TRUE(improper(p, {0, 1, 2}, {0, 3, 4}));  // a vertex on an edge
  p[3] = {-1, -1, 0};
  p[4] = {-2, 0, 0};
  EXPECT_FALSE(improper(p, {0, 1, 2}, {0, 3, 4}));  // coplanar, apart
  p[3] = {2, 3, 0};
  p[4] = {-2, 3, 0};
  EXPECT_TRUE(improper(p, {0, 1, 2}, {0, 3, 4}));  // coplanar, overlapping
}

TEST(TrianglePair, WithACommonEdgeOnlyAFoldCounts) {
  std::vector<P> p{{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, -1, 0}};
  EXPECT_FALSE(improper(p, {0, 1, 2}, {1, 0, 3}));
  p[3] = {0.5, 2, 0};
  EXPECT_TRUE(improper(p, {0, 1, 2}, {1, 0, 3}));
  p[3][2] = 1e-300;
  EXPECT_FALSE(improper(p, {0, 1, 2}, {1, 0, 3}));
  EXPECT_TRUE(improper(p, {0, 1, 2}, {0, 2, 1}));  // the same three vertices
}

TEST(TrianglePair, SeparationIsNeverClaimedWrongly) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> coordinate(0, 3);
  int separated = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::array<P, 6> p;
    for (P& x : p) x = {0.1 * coordinate(random), 0.1 * coordinate(random), 0.1 * coordinate(random)};
    const double* const a[3] = {p[0].data(), p[1].data(), p[2].data()};
    const double* const b[3] = {p[3].data(), p[4].data(), p[5].data()};
    if (!certainly_separated(a, b)) continue;
    ++separated;
    ASSERT_FALSE(meet({p[0], p[1], p[2]}, {p[3], p[4], p[5]}));
  }
  EXPECT_GT(separated, 1000);
}

}  // namespace
}  // namespace prcage
