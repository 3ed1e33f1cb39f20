// The projection tests against exact predicates: what they are certain of is so.
#include "core/projection.h"

#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <random>
#include <vector>

#include "core/predicates.h"
#include "core/triangle_pair.h"
#include "test_meshes.h"

namespace prcage {
namespace {

// The sign of det(b - a, c - a, n) is that of orient3d with a fourth point a + n, if that is representable.
TEST(Projection, FacingIsCertainOnlyIfItIsExact) {
  std::mt19937_64 random(1);
  std::uniform_int_distribution<int> grid(-3, 3);
  std::size_t certain = 0, flat = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const auto point = [&] { return Position{0.5 * grid(random), 0.5 * grid(random), 0.5 * grid(random)}; };
    const Position a = point(), b = point(), c = point(), n = point();
    const Position tip{a[0] + n[0], a[1] + n[1], a[2] + n[2]};
    const int sign = exact::orient3d(a.data(), b.data(), c.data(), tip.data());
    const bool faces = certainly_faces(vec(n), a.data(), b.data(), c.data());
    EXPECT_EQ(faces, sign > 0);  // small integers are computed exactly, so nothing is uncertain but zero
    certain += faces ? 1 : 0;
    flat += sign == 0 ? 1 : 0;
  }
  EXPECT_GT(certain, 1000u);
  EXPECT_GT(flat, 100u);
}

TEST(Projection, NearlyFlatAgainstTheDirectionIsNotCertain) {
  const double a[3] = {0, 0, 0}, b[3] = {1, 0, 1e-17}, c[3] = {0, 1, 0};
  EXPECT_TRUE(certainly_faces({0, 0, 1}, a, b, c));
  EXPECT_FALSE(certainly_faces({0, 0, -1}, a, b, c));
  EXPECT_FALSE(certainly_faces({1, 0, 0}, a, b, c));
}

// A fan round the origin through the given angles, with heights at random.
std::vector<Position> rim(const std::vector<double>& angles, std::mt19937_64& random) {
  std::uniform_real_distribution<double> radius(0.2, 2), height(-0.5, 0.5);
  std::vector<Position> points;
  for (const double t : angles) {
    const double r = radius(random);
    points.push_back({r * std::cos(t), r * std::sin(t), height(random)});
  }
  return points;
}

std::vector<double> evenly_spread(int n, int turns, double first) {
  std::vector<double> angles;
  for (int i = 0; i < n; ++i) angles.push_back(first + 2 * std::numbers::pi * turns * i / n);
  return angles;
}

bool winds_once(const std::vector<Position>& rim, const Position& centre) {
  Winds winds({0, 0, 1}, centre.data());
  for (std::size_t i = 0; i < rim.size(); ++i) winds.add(rim[i].data(), rim[(i + 1) % rim.size()].data());
  return winds.certainly_once();
}

TEST(Projection, FansThatWindTwiceAreNotTakenForSimpleOnes) {
  std::mt19937_64 random(2);
  const Position centre{0, 0, 0};
  for (int n = 5; n < 12; ++n)
    for (int trial = 0; trial < 50; ++trial) {
      const double first = std::uniform_real_distribution<double>(0, 7)(random);
      EXPECT_TRUE(winds_once(rim(evenly_spread(n, 1, first), random), centre));
      EXPECT_FALSE(winds_once(rim(evenly_spread(n, 2, first), random), centre));
    }
}

// Faces all facing the direction, wound once: then no two of them meet beyond what they share.
TEST(Projection, CertifiedFansDoNotMeetThemselves) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  int certified = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const int n = 3 + trial % 6;
    std::vector<double> angles = evenly_spread(n, 1 + (trial % 11 == 0 ? 1 : 0), 0.1);
    for (double& t : angles) t += 0.4 * normal(random);
    const std::vector<Position> points = rim(angles, random);
    const Position centre{0.2 * normal(random), 0.2 * normal(random), normal(random)};
    bool facing = winds_once(points, centre);
    for (int i = 0; i < n; ++i)
      facing = facing && certainly_faces({0, 0, 1}, centre.data(), points[static_cast<std::size_t>(i)].data(),
                                         points[static_cast<std::size_t>((i + 1) % n)].data());
    if (!facing) continue;
    ++certified;
    const auto face = [&](int i) {
      const auto j = static_cast<std::uint32_t>(i), k = static_cast<std::uint32_t>((i + 1) % n);
      return TriangleRef{{centre.data(), points[j].data(), points[k].data()}, {99, j, k}};
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < i; ++j) EXPECT_FALSE(improper_contact(face(i), face(j)));
  }
  EXPECT_GT(certified, 300);
}

}  // namespace
}  // namespace prcage
