// improper_contact() on small integer coordinates, where nearly every case is a degenerate one, against definitions in
// integers that share nothing with its way of deciding: separating axes, common rays of angles, sides of an edge.
#include "core/triangle_pair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>

#include "core/predicates.h"
#include "core/vec3.h"

namespace prcage {
namespace {

using I3 = Eigen::Matrix<std::int64_t, 3, 1>;
using Corners = std::array<I3, 3>;

I3 normal(const Corners& t) { return (t[1] - t[0]).cross(t[2] - t[0]); }

bool separates(const I3& axis, const Corners& a, const Corners& b) {
  const auto [a_low, a_high] = std::minmax({axis.dot(a[0]), axis.dot(a[1]), axis.dot(a[2])});
  const auto [b_low, b_high] = std::minmax({axis.dot(b[0]), axis.dot(b[1]), axis.dot(b[2])});
  return a_high < b_low || b_high < a_low;
}

// Two triangles of positive area are apart exactly if one of these axes says so.
bool meet(const Corners& a, const Corners& b) {
  const I3 na = normal(a), nb = normal(b);
  bool apart = separates(na, a, b) || separates(nb, a, b);
  for (std::size_t i = 0; i < 3; ++i) {
    const I3 ea = a[(i + 1) % 3] - a[i], eb = b[(i + 1) % 3] - b[i];
    apart = apart || separates(na.cross(ea), a, b) || separates(nb.cross(eb), a, b);
    for (std::size_t j = 0; j < 3; ++j) apart = apart || separates(ea.cross(b[(j + 1) % 3] - b[j]), a, b);
  }
  return !apart;
}

// Is direction d in the closed angle between u and v, whose plane has the normal n = u x v?
bool in_angle(const I3& d, const I3& u, const I3& v, const I3& n) {
  return n.dot(d) == 0 && n.dot(u.cross(d)) >= 0 && n.dot(d.cross(v)) >= 0;
}

// Triangles with corner 0 in common meet elsewhere exactly if their angles there have a ray in common: both are convex.
bool angles_meet(const Corners& a, const Corners& b) {
  const I3 na = normal(a), nb = normal(b);
  const I3 a1 = a[1] - a[0], a2 = a[2] - a[0], b1 = b[1] - b[0], b2 = b[2] - b[0];
  const I3 line = na.cross(nb);
  if (line.isZero()) {
    return in_angle(a1, b1, b2, nb) || in_angle(a2, b1, b2, nb) || in_angle(b1, a1, a2, na) || in_angle(b2, a1, a2, na);
  }
  return (in_angle(line, a1, a2, na) && in_angle(line, b1, b2, nb)) ||
         (in_angle(-line, a1, a2, na) && in_angle(-line, b1, b2, nb));
}

// Triangles with corners 0 and 1 in common overlap if they are coplanar with their third corners on the same side.
bool folded(const Corners& a, const Corners& b) {
  const I3 na = normal(a), nb = (b[1] - b[0]).cross(b[2] - b[0]);
  return na.cross(nb).isZero() && na.dot(nb) > 0;
}

struct Pair {
  Corners a, b;
  std::size_t shared;  // corners 0 .. shared-1 are the same
};

bool improper(const Pair& pair) {
  switch (pair.shared) {
    case 0:
      return meet(pair.a, pair.b);
    case 1:
      return angles_meet(pair.a, pair.b);
    case 2:
      return folded(pair.a, pair.b);
    default:
      return true;
  }
}

class RandomPairs {
 public:
  RandomPairs(std::uint64_t seed, int range) : random_(seed), coordinate_(0, range) {}

  Pair next(std::size_t shared) {
    Pair pair;
    pair.shared = shared;
    do {
      for (std::size_t i = 0; i < 3; ++i) {
        pair.a[i] = point();
        pair.b[i] = i < shared ? pair.a[i] : point();
      }
    } while (normal(pair.a).isZero() || normal(pair.b).isZero());
    return pair;
  }

 private:
  I3 point() { return {coordinate_(random_), coordinate_(random_), coordinate_(random_)}; }
  std::mt19937_64 random_;
  std::uniform_int_distribution<int> coordinate_;
};

// The answer for every order of the corners of both and for both orders of the triangles must be the same.
void expect_answer(const Pair& pair, bool expected) {
  std::array<Position, 3> p, q;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      p[i][k] = static_cast<double>(pair.a[i][static_cast<int>(k)]);
      q[i][k] = static_cast<double>(pair.b[i][static_cast<int>(k)]);
    }
  const auto name = [&](std::size_t i) { return static_cast<std::uint32_t>(i < pair.shared ? 10 + i : 20 + i); };
  std::array<std::size_t, 3> s{0, 1, 2};
  do {
    std::array<std::size_t, 3> t{0, 1, 2};
    do {
      const TriangleRef a{{p[s[0]].data(), p[s[1]].data(), p[s[2]].data()},
                          {static_cast<std::uint32_t>(10 + s[0]), static_cast<std::uint32_t>(10 + s[1]),
                           static_cast<std::uint32_t>(10 + s[2])}};
      const TriangleRef b{{q[t[0]].data(), q[t[1]].data(), q[t[2]].data()}, {name(t[0]), name(t[1]), name(t[2])}};
      ASSERT_EQ(improper_contact(a, b), expected);
      ASSERT_EQ(improper_contact(b, a), expected);
    } while (std::next_permutation(t.begin(), t.end()));
  } while (std::next_permutation(s.begin(), s.end()));
}

TEST(TrianglePairs, AgreeWithIntegerDefinitionsInEveryOrder) {
  for (const int range : {2, 3, 8, 100})
    for (const std::size_t shared : {0u, 1u, 2u, 3u}) {
      RandomPairs pairs(shared + 1, range);
      int yes = 0, no = 0;
      for (int trial = 0; trial < 1500; ++trial) {
        const Pair pair = pairs.next(shared);
        const bool expected = improper(pair);
        ASSERT_NO_FATAL_FAILURE(expect_answer(pair, expected)) << "range " << range << ", " << shared << " shared";
        ++(expected ? yes : no);
      }
      EXPECT_TRUE(yes > 0 || (shared == 2 && range == 100));
      EXPECT_TRUE(no > 0 || shared == 3);
    }
}

TEST(TrianglePairs, CertainSeparationNeverContradictsThem) {
  int certain = 0;
  for (const int range : {2, 3, 100}) {
    RandomPairs pairs(9, range);
    for (int trial = 0; trial < 5000; ++trial) {
      const Pair pair = pairs.next(0);
      std::array<Position, 3> p, q;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
          p[i][k] = static_cast<double>(pair.a[i][static_cast<int>(k)]);
          q[i][k] = static_cast<double>(pair.b[i][static_cast<int>(k)]);
        }
      const double* const a[3] = {p[0].data(), p[1].data(), p[2].data()};
      const double* const b[3] = {q[0].data(), q[1].data(), q[2].data()};
      if (!certainly_separated(a, b) && !certainly_separated(b, a)) continue;
      ++certain;
      EXPECT_FALSE(meet(pair.a, pair.b));
    }
  }
  EXPECT_GT(certain, 1000);
}

// Triangles of one plane are separated by their edges: pairs on flat parts must not need exact arithmetic.
TEST(TrianglePairs, CoplanarOnesAreSeparatedWithoutExactArithmetic) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  int separated = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const auto point = [&](double x) {
      const double s = x + unit(random), t = unit(random);
      return Position{s, t, 0.25 * s - 0.5 * t};  // on one plane up to rounding
    };
    const std::array<Position, 3> p{point(0), point(0), point(0)}, q{point(1.1), point(1.1), point(1.1)};
    const double* const a[3] = {p[0].data(), p[1].data(), p[2].data()};
    const double* const b[3] = {q[0].data(), q[1].data(), q[2].data()};
    const bool found = certainly_separated(a, b) || certainly_separated(b, a);
    EXPECT_FALSE(found && exact::triangles_intersect(a[0], a[1], a[2], b[0], b[1], b[2]));
    separated += found ? 1 : 0;
  }
  EXPECT_GT(separated, 350);
}

}  // namespace
}  // namespace prcage
