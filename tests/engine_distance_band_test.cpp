// The distance band against loops over all faces: an upper bound by near(), the exact nearest face by nearest(), and
// proofs by reach() that dense samples never refute.
#include "parallel/distance_band.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "engine_stages.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

using testing::BruteDistance;
using testing::in_arena;
using testing::Stage;

constexpr double exceeding = 1 + 1e-12;  // rounding of the distances that are compared

// Points of the faces of the mesh, moved by up to `reach` in any direction.
std::vector<Vec3> points_about(const Mesh& mesh, std::size_t count, double reach, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const auto c = testing::corners(mesh, mesh.triangles[random() % mesh.triangles.size()]);
    const double s = unit(random), t = unit(random) * (1 - s);
    points.push_back(c[0] + s * (c[1] - c[0]) + t * (c[2] - c[0]) +
                     reach * unit(random) * testing::random_unit(random));
  }
  return points;
}

std::vector<Mesh> inputs() {
  return {testing::cube(),
          testing::shape("bumpy", 1000),
          testing::shape("bracket", 300),
          testing::shape("spikes", 500),
          testing::shape("slabs", 200),
          testing::moved(testing::shape("knot", 400), {1e6, -1e6, 3e5}),
          testing::scaled(testing::shape("nested", 400), 1e-6),
          testing::scaled(testing::shape("gyroid", 600), 1e6)};
}

TEST(DistanceBand, DistanceToAFaceIsThatOfTheTriangle) {
  for (const Mesh& input : inputs())
    in_arena(1, [&] {
      const Stage stage(input);
      const double ulp = 1e-15 * Vec3(vec(input.positions[0])).norm() + 1e-14 * stage.diagonal;
      std::mt19937_64 random(1);
      for (const Vec3& x : points_about(input, 300, stage.diagonal, 1)) {
        const auto f = static_cast<std::uint32_t>(random() % input.triangles.size());
        EXPECT_NEAR(stage.band->distance_to_face(x, f),
                    testing::triangle_distance(x, testing::corners(input, input.triangles[f])), 4 * ulp);
      }
    });
}

TEST(DistanceBand, NearestPointOfAFaceIsOnItAndAsFarAsTheFace) {
  for (const Mesh& input : inputs())
    in_arena(1, [&] {
      const Stage stage(input);
      const double ulp = 1e-15 * Vec3(vec(input.positions[0])).norm() + 1e-14 * stage.diagonal;
      std::mt19937_64 random(2);
      for (const Vec3& x : points_about(input, 300, stage.diagonal, 4)) {
        const auto f = static_cast<std::uint32_t>(random() % input.triangles.size());
        const Vec3 point = stage.band->nearest_point(x, f);
        EXPECT_NEAR((x - point).norm(), stage.band->distance_to_face(x, f), 4 * ulp);
        EXPECT_LE(testing::triangle_distance(point, testing::corners(input, input.triangles[f])), 4 * ulp);
      }
    });
}

TEST(DistanceBand, NearestIsExactAndTheLowestAmongEquals) {
  for (const Mesh& input : inputs())
    in_arena(1, [&] {
      const Stage stage(input);
      for (const double reach : {0.0, 0.01, 1.0, 100.0}) {
        std::vector<Vec3> points = points_about(input, 60, reach * stage.diagonal, 2);
        for (std::size_t v = 0; v < 20 && v < input.positions.size(); ++v) points.push_back(vec(input.positions[v]));
        for (const Vec3& x : points) {
          std::uint32_t face = none;
          double squared = std::numeric_limits<double>::infinity();
          for (std::uint32_t f = 0; f < input.triangles.size(); ++f)
            if (const double d = stage.band->distance_from(f).squared(x); d < squared) face = f, squared = d;
          const DistanceBand::Near found = stage.band->nearest(x);
          EXPECT_EQ(found.face, face);
          EXPECT_EQ(found.distance, std::sqrt(squared));
        }
      }
    });
}

TEST(DistanceBand, NearIsAnUpperBoundAtMostAVoxelDiagonalTooLarge) {
  for (const Mesh& input : inputs())
    in_arena(1, [&] {
      const Stage stage(input);
      const BruteDistance distance(input);
      const double ulp = 1e-15 * Vec3(vec(input.positions[0])).norm();
      for (const double voxel : {1.0 / 20, 1.0 / 160, 1.0 / 3000}) {
        stage.band->set_voxel_size(voxel * stage.diagonal);
        for (const Vec3& x : points_about(input, 300, 0.1 * stage.diagonal, 3)) {
          const double d = distance(x);
          const DistanceBand::Near found = stage.band->near(x);
          EXPECT_GE(found.distance * exceeding + 4 * ulp, d);
          EXPECT_LE(found.distance, d + std::sqrt(3.0) * voxel * stage.diagonal * exceeding + 4 * ulp);
          EXPECT_EQ(found.distance, stage.band->distance_to_face(x, found.face));
        }
      }
    });
}

// A triangle next to a random place of the mesh, of random size and direction.
std::array<Vec3, 3> random_triangle(const Mesh& input, double reach, double size, std::mt19937_64& random) {
  const Vec3 x = points_about(input, 1, reach, random())[0];
  return {x + size * testing::random_unit(random), x + size * testing::random_unit(random),
          x + size * testing::random_unit(random)};
}

double farthest_sample(const std::array<Vec3, 3>& t, const BruteDistance& distance) {
  double worst = 0;
  testing::for_each_sample(t, 12, [&](const Vec3& x) { worst = std::max(worst, distance(x)); });
  return worst;
}

TEST(DistanceBandSlow, WithinIsNeverClaimedWronglyAndFoundWhereItIsClear) {
  for (const Mesh& input : inputs())
    in_arena(1, [&] {
      const Stage stage(input);
      const BruteDistance distance(input);
      std::mt19937_64 random(4);
      int yes = 0, no = 0;
      for (const double tau_rel : {1.0 / 20, 1.0 / 80}) {
        const double tau = tau_rel * stage.diagonal;
        stage.band->set_voxel_size(tau / 4);
        for (int trial = 0; trial < 60; ++trial) {
          const double size = std::pow(10, std::uniform_real_distribution<double>(-1.5, 0.7)(random)) * tau;
          const auto t = random_triangle(input, 0.6 * tau, size, random);
          const bool proved = stage.band->reach(t[0], t[1], t[2], tau) <= tau;
          const double farthest = farthest_sample(t, distance);
          if (proved) {
            EXPECT_LE(farthest, tau * (1 + 1e-9));
          }
          if (farthest + size / 12 < 0.5 * tau) {
            EXPECT_TRUE(proved);
          }
          ++(proved ? yes : no);
        }
      }
      EXPECT_GT(yes, 10);
      EXPECT_GT(no, 10);
    });
}

// Triangles much larger than tau that lie on the input, across all its faces, are proved piece by piece.
TEST(DistanceBand, LargeTrianglesAlongTheInputAreProved) {
  const Mesh input = testing::flat_plate(40, 1, 0, 0.3);
  in_arena(1, [&] {
    const Stage stage(input);
    const double tau = 0.004;
    stage.band->set_voxel_size(tau / 4);
    const auto at = [](double x, double y, double z) { return Vec3(x, y, z); };
    EXPECT_LE(stage.band->reach(at(0.01, 0.01, 0.302), at(0.98, 0.03, 0.302), at(0.4, 0.97, 0.3019), tau), tau);
    EXPECT_GT(stage.band->reach(at(0.01, 0.01, 0.302), at(0.98, 0.03, 0.302), at(0.4, 0.97, 0.3041), tau), tau);
    EXPECT_GT(stage.band->reach(at(0.01, 0.01, 0.302), at(1.01, 0.03, 0.302), at(0.4, 0.97, 0.302), tau), tau);
  });
}

TEST(DistanceBand, AnswersDoNotDependOnTheMemoNorOnThreads) {
  const Mesh input = testing::shape("bumpy", 2000);
  const std::vector<Vec3> points = points_about(input, 4000, 0.05, 5);
  const auto ask = [&](DistanceBand& band) {
    std::vector<DistanceBand::Near> answers(points.size());
    parallel_each(points.size(), 16, [&](std::size_t i) { answers[i] = band.near(points[i]); });
    return answers;
  };
  const auto equal = [](const std::vector<DistanceBand::Near>& a, const std::vector<DistanceBand::Near>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const auto& p, const auto& q) { return p.face == q.face && p.distance == q.distance; });
  };
  std::vector<DistanceBand::Near> expected;
  std::uint64_t voxels = 0;
  in_arena(1, [&] {
    const Stage stage(input);
    expected = ask(*stage.band);
    stage.band->absorb();
    voxels = stage.band->voxels_filled();
    EXPECT_GT(voxels, 100u);
    EXPECT_TRUE(equal(ask(*stage.band), expected));
    stage.band->absorb();
    EXPECT_EQ(stage.band->voxels_filled(), voxels) << "known voxels are not asked for again";
  });
  in_arena(4, [&] {
    const Stage stage(input);
    const double voxel = stage.diagonal / 160;
    EXPECT_TRUE(equal(ask(*stage.band), expected));
    stage.band->set_voxel_size(voxel / 3);
    EXPECT_FALSE(equal(ask(*stage.band), expected)) << "another grid, other near faces";
    stage.band->set_voxel_size(voxel);
    for (std::size_t i = points.size(); i-- > 0;) stage.band->near(points[i]);
    EXPECT_TRUE(equal(ask(*stage.band), expected));
    stage.band->absorb();
    EXPECT_TRUE(equal(ask(*stage.band), expected));
  });
}

}  // namespace
}  // namespace prcage
