// star_certainly_embedded() against improper_contact() on every two faces: it must never contradict it, and it must say
// yes to the stars that surfaces are made of.
#include "core/star.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "core/triangle_pair.h"
#include "core/vec3.h"

namespace prcage {
namespace {

struct Star {
  Position centre{};
  std::vector<Position> link;

  bool certain() const {
    std::vector<const double*> points;
    for (const Position& p : link) points.push_back(p.data());
    return star_certainly_embedded(centre.data(), points.data(), points.size());
  }

  bool improper() const {
    const auto n = static_cast<std::uint32_t>(link.size());
    const auto face = [&](std::uint32_t i) {
      const std::uint32_t j = (i + 1) % n;
      return TriangleRef{{centre.data(), link[i].data(), link[j].data()}, {n, i, j}};
    };
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t j = i + 1; j < n; ++j)
        if (improper_contact(face(i), face(j))) return true;
    return false;
  }
};

// `size` points round the centre, `turns` times, at heights of the angle.
Star wheel(std::uint32_t size, int turns, const std::function<double(double)>& height) {
  Star star;
  for (std::uint32_t i = 0; i < size; ++i) {
    const double angle = 2 * std::numbers::pi * turns * i / size;
    star.link.push_back({std::cos(angle), std::sin(angle), height(angle)});
  }
  return star;
}

TEST(Stars, OfSurfacesAreCertified) {
  for (const std::uint32_t size : {3u, 4u, 5u, 6u, 7u, 12u, 60u}) {
    EXPECT_TRUE(wheel(size, 1, [](double) { return 0.0; }).certain());
    EXPECT_TRUE(wheel(size, 1, [](double) { return -3.0; }).certain());
    if (size >= 5) {
      EXPECT_TRUE(wheel(size, 1, [](double a) { return 0.5 * std::sin(2 * a); }).certain());
    }
  }
  Star grid;
  grid.link = {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {-1, 0, 0}, {-1, -1, 0}, {0, -1, 0}};
  EXPECT_TRUE(grid.certain());
  std::reverse(grid.link.begin(), grid.link.end());
  EXPECT_TRUE(grid.certain());
}

TEST(Stars, ThatWindTwiceAreNot) {
  for (const std::uint32_t size : {7u, 9u, 13u}) {
    const Star star = wheel(size, 2, [](double a) { return 0.1 * std::sin(a / 2); });
    EXPECT_TRUE(star.improper());
    EXPECT_FALSE(star.certain());
  }
}

TEST(Stars, FoldedOrWithoutAreaAreNot) {
  Star star;
  star.link = {{1, 0, 0}, {0, 1, 0}};
  EXPECT_FALSE(star.certain());
  star.link = {{1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  EXPECT_FALSE(star.certain());
  star.link = {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 2, 0}, {-1, -1, 0}};  // a flat fold
  EXPECT_TRUE(star.improper());
  EXPECT_FALSE(star.certain());
}

// Small integers make nearly every position of two faces a degenerate one.
TEST(Stars, NeverContradictThePairsOnIntegers) {
  std::mt19937_64 random(1);
  int certain = 0, improper = 0;
  for (const int range : {1, 2, 4, 50}) {
    std::uniform_int_distribution<int> coordinate(-range, range);
    for (int trial = 0; trial < 20000; ++trial) {
      Star star;
      star.link.resize(3 + random() % 5);
      for (Position& p : star.link)
        for (double& x : p) x = coordinate(random);
      if (!star.certain()) continue;
      ++certain;
      EXPECT_FALSE(star.improper());
    }
  }
  EXPECT_GT(certain, 500);
  for (int trial = 0; trial < 1000; ++trial) {
    Star star;
    star.link.resize(6);
    for (Position& p : star.link)
      for (double& x : p) x = static_cast<double>(random() % 5) - 2;
    improper += star.improper() ? 1 : 0;
  }
  EXPECT_GT(improper, 500);
}

// Wheels far from the origin whose heights and radii are a few units in the last place: the fold is decided by bits
// that floating point cannot see.
TEST(Stars, NeverContradictThePairsNearTheLimitsOfPrecision) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> noise(-1, 1);
  int certain = 0, improper = 0;
  for (const double size : {1.0, 1e-6, 1e-12, 1e-15, 3e-16})
    for (int trial = 0; trial < 3000; ++trial) {
      const double amount = std::ldexp(1.0, -static_cast<int>(random() % 5));
      Star star =
          wheel(3 + static_cast<std::uint32_t>(random() % 6), 1, [&](double) { return amount * noise(random); });
      for (Position& p : star.link)
        for (double& x : p) x = 1 + size * (x + amount * noise(random));
      star.centre = {1, 1, 1};
      const bool bad = star.improper();
      improper += bad ? 1 : 0;
      if (!star.certain()) continue;
      ++certain;
      EXPECT_FALSE(bad);
    }
  EXPECT_GT(certain, 1000);
  EXPECT_GT(improper, 300);
}

}  // namespace
}  // namespace prcage
