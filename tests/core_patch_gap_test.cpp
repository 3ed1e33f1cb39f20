// The gap between two discs over one polygon against dense samples: never smaller, and hardly larger.
#include "core/patch_gap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/distance.h"
#include "random.h"

namespace prcage {
namespace {

using Face = std::array<Vec3, 3>;

// A star of an edge (a, b) and the fan round p that would replace it, both over one convex polygon across z.
struct Discs {
  std::vector<Vec3> rim;
  Vec3 a, b, p;
  std::size_t half = 0;  // rim[0] and rim[half] are the apexes of the edge; a is on the side of the numbers between

  std::vector<Face> star() const {
    std::vector<Face> faces{{a, b, rim[0]}, {b, a, rim[half]}};
    for (std::size_t i = 0; i < rim.size(); ++i) faces.push_back({i < half ? a : b, rim[i], rim[(i + 1) % rim.size()]});
    return faces;
  }
  std::vector<Face> fan() const {
    std::vector<Face> faces;
    for (std::size_t i = 0; i < rim.size(); ++i) faces.push_back({p, rim[i], rim[(i + 1) % rim.size()]});
    return faces;
  }
};

Discs random_discs(testing::Random& random, double rise) {
  Discs discs;
  const std::size_t n = 5 + random.below(7);
  for (std::size_t i = 0; i < n; ++i) {
    const double t = 2 * std::numbers::pi * (static_cast<double>(i) + random.uniform(0, 0.4)) / static_cast<double>(n);
    discs.rim.emplace_back(std::cos(t), std::sin(t), random.uniform(-rise, rise));
  }
  discs.half = n / 2;
  // Points of the kernel on both sides of the line between the apexes: the rim is convex.
  const auto between = [&](std::size_t first, std::size_t last) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = first; i <= last; ++i) sum += random.uniform(0.5, 1) * discs.rim[i % n];
    Vec3 point = sum / static_cast<double>(last - first + 1);
    point.z() = random.uniform(-rise, rise);
    return point;
  };
  discs.a = between(0, discs.half);
  discs.b = between(discs.half, n);
  discs.p = Vec3(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(-rise, rise));
  return discs;
}

bool all_face_up(const std::vector<Face>& faces) {
  return std::all_of(faces.begin(), faces.end(), [](const Face& f) {
    const Vec3 normal = (f[1] - f[0]).cross(f[2] - f[0]);
    return normal.z() > 1e-3 * (f[1] - f[0]).norm() * (f[2] - f[0]).norm();
  });
}

GraphDisc seen(const ViewAlong& view, const std::vector<Face>& faces) {
  GraphDisc disc;
  for (const Face& f : faces) disc.add_face(view(f[0].data()), view(f[1].data()), view(f[2].data()));
  return disc;
}

double gap_of(const Discs& discs, const Vec3& n) {
  const ViewAlong view(n, discs.a.data());
  GraphDisc star = seen(view, discs.star()), fan = seen(view, discs.fan());
  const auto at = [&](const Vec3& x) { return view(x.data()); };
  star.add_inner_vertex(at(discs.a));
  star.add_inner_vertex(at(discs.b));
  fan.add_inner_vertex(at(discs.p));
  star.add_inner_edge(at(discs.a), at(discs.b));
  for (std::size_t i = 0; i < discs.rim.size(); ++i) {
    if (i <= discs.half) star.add_inner_edge(at(discs.a), at(discs.rim[i]));
    if (i >= discs.half || i == 0) star.add_inner_edge(at(discs.b), at(discs.rim[i]));
    fan.add_inner_edge(at(discs.p), at(discs.rim[i]));
  }
  EXPECT_EQ(largest_gap(star, fan), largest_gap(fan, star));
  return largest_gap(star, fan);
}

double height_at(const std::vector<Face>& faces, double x, double y) {
  for (const Face& f : faces) {
    const auto area = [](const Vec3& u, const Vec3& v) { return u.x() * v.y() - u.y() * v.x(); };
    const Vec3 q(x, y, 0);
    const double whole = area(f[1] - f[0], f[2] - f[0]);
    const double at0 = area(f[1] - q, f[2] - q) / whole, at1 = area(f[2] - q, f[0] - q) / whole;
    if (std::min({at0, at1, 1 - at0 - at1}) >= -1e-12)
      return at0 * f[0].z() + at1 * f[1].z() + (1 - at0 - at1) * f[2].z();
  }
  return std::numeric_limits<double>::quiet_NaN();  // outside the polygon
}

double distance_to(const std::vector<Face>& faces, const Vec3& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const Face& f : faces) least = std::min(least, TriangleDistance(f[0], f[1], f[2]).squared(x));
  return std::sqrt(least);
}

TEST(PatchGap, IsTheLargestDifferenceOfSamples) {
  testing::Random random(7);
  std::size_t tried = 0;
  double tightest = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Discs discs = random_discs(random, trial % 2 == 0 ? 0.05 : 0.6);
    const auto star = discs.star(), fan = discs.fan();
    if (!all_face_up(star) || !all_face_up(fan)) continue;
    const double gap = gap_of(discs, {0, 0, 1});
    double largest = 0;
    for (double x = -1; x <= 1; x += 0.02)
      for (double y = -1; y <= 1; y += 0.02) {
        const double difference = std::abs(height_at(star, x, y) - height_at(fan, x, y));
        if (difference > largest) largest = difference;  // not if it is NaN
      }
    EXPECT_GE(gap, largest * (1 - 1e-12));
    EXPECT_LE(gap, 1.3 * largest + 0.02);
    tightest = std::max(tightest, largest / gap);
    ++tried;
  }
  EXPECT_GT(tried, 150u);
  EXPECT_GT(tightest, 0.98);
}

TEST(PatchGap, BoundsTheDistanceBothWaysInAnyDirection) {
  testing::Random random(8);
  std::size_t tried = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const Discs discs = random_discs(random, 0.3);
    const auto star = discs.star(), fan = discs.fan();
    if (!all_face_up(star) || !all_face_up(fan)) continue;
    const double gap = gap_of(discs, {0, 0, 1});
    for (const auto& [from, to] : {std::pair(&star, &fan), std::pair(&fan, &star)})
      for (const Face& f : *from)
        for (int k = 0; k < 40; ++k) {
          const double u = random.uniform(0, 1), v = random.uniform(0, 1 - u);
          EXPECT_LE(distance_to(*to, (1 - u - v) * f[0] + u * f[1] + v * f[2]), gap * (1 + 1e-12));
        }
    ++tried;
  }
  EXPECT_GT(tried, 100u);
}

TEST(PatchGap, NothingMovesWhereNothingMoved) {
  testing::Random random(9);
  for (int trial = 0; trial < 50; ++trial) {
    Discs discs = random_discs(random, 0);  // flat: any two triangulations are one surface
    if (!all_face_up(discs.star()) || !all_face_up(discs.fan())) continue;
    EXPECT_LE(gap_of(discs, {0, 0, 1}), 1e-12);
  }
}

TEST(PatchGap, SaysNothingOfWhatIsTooSteepOrTooMuch) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  testing::Random random(10);
  Discs discs = random_discs(random, 0.05);
  const ViewAlong view({0, 0, 1}, discs.a.data());
  GraphDisc fan = seen(view, discs.fan()), steep;
  fan.add_inner_vertex(view(discs.p.data()));
  steep.add_face({-2, -1e-9, 0}, {2, -1e-9, 0}, {0, 1e-9, 1});
  EXPECT_EQ(largest_gap(fan, steep), infinity);
  GraphDisc many;
  for (int i = 0; i < 100; ++i) many.add_face({-2, -2, 0}, {2, -2, 0}, {0, 3, 0});
  EXPECT_EQ(largest_gap(fan, many), infinity);
}

}  // namespace
}  // namespace prcage
