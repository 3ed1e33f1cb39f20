// The first cage: every vertex clears the planes of its faces or is cut off, and what comes out is certified, on meshes
// whose vertices leave no direction to move in and whose sheets nearly touch.
#include "core/displacement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/vertex_cap.h"
#include "engine_stages.h"

namespace prcage {
namespace {

using testing::in_arena;
using testing::sampled_distance;
using testing::Stage;
using testing::topology;

// ------------------------------------------------------------------------------------------ directions

TEST(DisplacementDirection, ClearsEveryIncidentPlaneByTheStep) {
  for (const char* name : {"bumpy", "spikes", "knot", "bracket", "gyroid"}) {
    const CornerTable mesh = CornerTable::from_mesh(testing::shape(name, 1500));
    std::size_t regular = 0;
    for (std::uint32_t v = 0; v < mesh.vertex_slots(); ++v) {
      Vec3 x;
      if (!displacement_direction(mesh, v, 0, x)) continue;
      ++regular;
      EXPECT_GE(x.norm(), 1 - 1e-9);
      for_each_outgoing(mesh, v, [&](std::uint32_t h) {
        const Vec3 n = unit_normal(mesh, h);
        if (n.isZero(0)) return;
        EXPECT_GE(n.dot(x), 1 - 1e-9) << name << " vertex " << v;
      });
    }
    EXPECT_GT(regular, mesh.vertex_slots() * 9 / 10) << name;
  }
}

// At a corner of a cube three planes are cleared by exactly one unit each, on a flat face one is.
TEST(DisplacementDirection, IsTheShortest) {
  const CornerTable cube = CornerTable::from_mesh(testing::cube());
  for (std::uint32_t v = 0; v < 8; ++v) {
    Vec3 x;
    ASSERT_TRUE(displacement_direction(cube, v, 0, x));
    EXPECT_LT((x - cube.vec_at(v) * 2).norm(), 1e-9);
  }
  const CornerTable plate = CornerTable::from_mesh(testing::flat_plate(4, 1, 0, 0.1));
  Vec3 x;
  ASSERT_TRUE(displacement_direction(plate, 25 + 12, 0, x));
  EXPECT_LT((x - Vec3::UnitZ()).norm(), 1e-9);
}

TEST(DisplacementDirection, FailsWhereNoDirectionClears) {
  Vec3 x;
  EXPECT_TRUE(displacement_direction(CornerTable::from_mesh(testing::thin_sector(6, 3.0, 0.05)), 0, 0, x));
  EXPECT_FALSE(displacement_direction(CornerTable::from_mesh(testing::thin_sector(9, 4.7, 0.05)), 0, 0, x));
  const std::vector<Vec3> opposite{Vec3::UnitX(), -Vec3::UnitX()};
  EXPECT_FALSE(clearing_direction(opposite, x));
  EXPECT_FALSE(clearing_direction({}, x));
}

// ------------------------------------------------------------------------------------------ caps

TEST(VertexCap, CutsASingularVertexOffAndKeepsTheTopology) {
  for (const std::uint32_t steps : {6u, 9u, 16u, 40u})
    for (const double turn : {3.5, 4.7, 5.9}) {
      const Mesh input = testing::thin_sector(steps, turn, 0.05);
      ASSERT_TRUE(validate(input).valid());
      CornerTable mesh = CornerTable::from_mesh(input);
      const VertexCap cap = plan_cap(mesh, 0);
      ASSERT_FALSE(cap.empty());
      const std::vector<std::uint32_t> ring = cap_vertex(mesh, cap, 0.01);
      EXPECT_EQ(ring.size(), cap.fan.size());
      EXPECT_EQ(topology(mesh.to_mesh()), topology(input));
      for (const std::uint32_t v : ring) EXPECT_NEAR(mesh.vec_at(v).norm(), 0.01, 1e-15);
    }
}

TEST(VertexCap, TheCutSurfaceEnclosesTheInput) {
  const Mesh input = testing::thin_sector(12, 4.7, 0.05);
  CornerTable mesh = CornerTable::from_mesh(input);
  cap_vertex(mesh, plan_cap(mesh, 0), 0.1);
  const Mesh cut = mesh.to_mesh();
  EXPECT_TRUE(testing::weakly_encloses(cut, input, 1e-6));
  EXPECT_TRUE(validate(cut).valid());
}

// ------------------------------------------------------------------------------------------ first cages

struct Displaced {
  Mesh cage;
  InitialCage first;
};

// Displaces and certifies.
Displaced expect_certified(const Mesh& input, double sigma) {
  Displaced result;
  EXPECT_TRUE(validate(input).valid());
  in_arena(2, [&] {
    const Stage stage(input);
    result.first = stage.displaced(sigma * stage.diagonal);
    result.cage = result.first.state.mesh.to_mesh();
  });
  EXPECT_TRUE(result.first.valid);
  EXPECT_TRUE(certify(input, result.cage).valid());
  EXPECT_EQ(topology(result.cage), topology(input));
  EXPECT_EQ(result.first.state.live_faces, result.cage.triangles.size());
  return result;
}

TEST(InitialCageSlow, IsCertifiedOnEveryShape) {
  for (const ShapeInfo& info : shape_table())
    for (const std::size_t faces : {100u, 2000u})
      for (const double sigma : {1e-7, 1e-5, 1e-3}) {
        SCOPED_TRACE(std::string(info.name) + " " + std::to_string(faces) + " " + std::to_string(sigma));
        expect_certified(testing::shape(info.name, faces), sigma);
      }
}

TEST(InitialCage, IsCertifiedAtSingularVertices) {
  for (const std::uint32_t steps : {6u, 9u, 24u})
    for (const double turn : {3.3, 4.0, 4.7, 5.9})
      for (const double half_thickness : {0.2, 0.02, 1e-3, 1e-5}) {
        SCOPED_TRACE(std::to_string(steps) + " " + std::to_string(turn) + " " + std::to_string(half_thickness));
        const Displaced d = expect_certified(testing::thin_sector(steps, turn, half_thickness), 1e-5);
        if (turn > 3.6) {
          EXPECT_EQ(d.first.singular_vertices, 1u);
          EXPECT_EQ(d.first.capped_vertices, 1u);
        }
      }
}

// The other side of the sector: the notch is what is thin.
TEST(InitialCage, IsCertifiedAtNeedlesAndSaddles) {
  for (const std::uint32_t ring : {4u, 6u, 8u, 12u, 50u})
    for (const double rise : {0.1, 1.0, 5.0, 30.0}) {
      SCOPED_TRACE(std::to_string(ring) + " " + std::to_string(rise));
      expect_certified(testing::saddle_cone(ring, rise), 1e-5);
    }
  // A needle: base triangle of unit size, apex very high.
  for (const double height : {10.0, 1e3, 1e5})
    expect_certified(
        testing::mapped(testing::tetrahedron(), [&](const Vec3& p) { return Vec3(p.x(), p.y(), p.z() * height); }),
        1e-5);
}

TEST(InitialCage, IsCertifiedOnFoldedSheets) {
  for (const double thickness : {0.1, 1e-3, 1e-6})
    for (const double gap : {0.1, 1e-3, 1e-6}) {
      SCOPED_TRACE(std::to_string(thickness) + " " + std::to_string(gap));
      expect_certified(testing::z_fold(thickness, gap), 1e-5);
    }
}

// Two fans in one vertex's neighbourhood back to back: a disc whose both sides meet the vertex, pierced by spikes.
TEST(InitialCageSlow, IsCertifiedAtSpikyStars) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> factor(0.02, 3);
  for (int trial = 0; trial < 40; ++trial) {
    // Radial displacement keeps a star-shaped solid, however wild the radii.
    const Mesh input =
        testing::mapped(testing::sphere(1 + trial % 3), [&](const Vec3& p) -> Vec3 { return factor(random) * p; });
    SCOPED_TRACE(trial);
    expect_certified(input, 1e-5);
  }
}

TEST(InitialCage, StepsAreHalvedOnlyInTheNarrowGap) {
  // Two plates; a bump of the lower one comes within 1e-7 l of the upper one in the middle.
  const double gap = 1e-7 * std::sqrt(3);
  const auto bump = [gap](double x, double y) { return x == 0.5 && y == 0.5 ? 0.5 - gap : 0.1; };
  const Mesh input = testing::merge(testing::plate(
                                        8, 1, [](double, double) { return 0.0; }, bump),
                                    testing::flat_plate(8, 1, 0.5, 1.0));
  const Displaced d = expect_certified(input, 1e-5);
  const double full = *std::max_element(d.first.step.begin(), d.first.step.end());
  const double smallest = *std::min_element(d.first.step.begin(), d.first.step.end());
  EXPECT_LT(smallest, gap);
  EXPECT_GT(smallest, gap / 32);
  EXPECT_GT(d.first.halved_vertices, 0u);
  EXPECT_LT(d.first.halved_vertices, 40u);
  for (std::size_t v = 0; v < input.positions.size(); ++v) {
    const Vec3 p = vec(input.positions[v]);
    if (std::hypot(p.x() - 0.5, p.y() - 0.5) < 0.2) continue;  // the faces at the bump and opposite
    EXPECT_EQ(d.first.step[v], full) << p.transpose();
  }
}

// Sheets much closer to each other than the step, over many rings of faces: where they pass through each other as a
// whole they meet nowhere but at their rims.
TEST(InitialCageSlow, IsCertifiedBetweenLargeParallelPlates) {
  for (const double gap : {1e-3, 1e-5, 1e-7, 1e-9})
    for (const double sigma : {1e-5, 1e-3}) {
      SCOPED_TRACE(std::to_string(gap) + " " + std::to_string(sigma));
      const Mesh input = testing::merge(testing::flat_plate(20, 1, 0, 0.2), testing::flat_plate(20, 1, 0.2 + gap, 0.4));
      const Displaced d = expect_certified(input, sigma);
      EXPECT_GT(*std::min_element(d.first.step.begin(), d.first.step.end()), std::min(sigma, gap) / 16);
    }
}

// Otherwise strict tau would be lost before the first round.
TEST(InitialCageSlow, StaysWithinTheLongestMoveAndRadius) {
  const std::vector<Mesh> inputs{testing::thin_sector(9, 4.7, 0.05), testing::thin_sector(24, 5.9, 0.01),
                                 testing::saddle_cone(8, 5.0), testing::shape("spikes", 500)};
  for (const Mesh& input : inputs)
    for (const double sigma : {1e-5, 1e-3, 1e-2})
      for (const double share : {1.0, 5.0, 50.0}) {
        in_arena(1, [&] {
          const Stage stage(input);
          const double step = sigma * stage.diagonal;
          const DisplacementSettings settings{step, share * step, share * step, false};
          const InitialCage first = displace(stage.input, stage.tree, settings, stage.device);
          EXPECT_TRUE(first.valid);
          EXPECT_LE(sampled_distance(first.state.mesh.to_mesh(), input, 6), 2 * share * step * (1 + 1e-9))
              << "sigma " << sigma << ", longest move " << share << " steps";
        });
      }
}

// A solid like a needle with its tip at `tip`, pointing towards the origin.
Mesh needle_towards_origin(const Vec3& tip) {
  const Vec3 out = tip.normalized(), u = out.unitOrthogonal(), v = out.cross(u);
  return testing::mapped(testing::tetrahedron(), [&](const Vec3& p) -> Vec3 {
    return tip + 0.5 * p.sum() * out + 0.02 * (p.x() - p.z()) * u + 0.02 * (p.y() - p.z()) * v;
  });
}

// The tip of a second solid next to a singular vertex, nearer than the radius at which it would be cut off.
TEST(InitialCageSlow, IsCertifiedWhereASolidReachesIntoTheCap) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 40; ++trial)
    for (const double gap : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
      const Vec3 out = testing::random_unit(random);
      const double turn = trial % 2 == 0 ? 4.7 : 5.9;
      const Mesh input = testing::merge(testing::thin_sector(12, turn, 0.05), needle_towards_origin(gap * out));
      if (!validate(input).valid()) continue;  // the needle pierces the sector
      SCOPED_TRACE(std::to_string(trial) + " " + std::to_string(gap));
      expect_certified(input, 1e-5);
    }
}

bool is_float(double x) {
  const volatile float nearest = static_cast<float>(x);  // not to be optimised away, see round_to_float()
  return static_cast<double>(nearest) == x;
}

TEST(InitialCage, FloatPositionsAreFloats) {
  for (const char* name : {"bumpy", "bracket"}) {
    const Mesh input = testing::shape(name, 500);
    in_arena(1, [&] {
      const Stage stage(input);
      const InitialCage first = stage.displaced(1e-5 * stage.diagonal, true);
      ASSERT_TRUE(first.valid);
      const Mesh cage = first.state.mesh.to_mesh();
      for (const Position& p : cage.positions)
        for (const double x : p) EXPECT_TRUE(is_float(x));
      EXPECT_TRUE(certify(input, cage).valid());
    });
  }
}

TEST(InitialCage, KnowsAnUpperBoundOfTheDistanceOfEachFace) {
  const Mesh input =
      testing::merge(testing::shape("spikes", 800), testing::moved(testing::thin_sector(9, 4.7, 0.05), {9, 0, 0}));
  in_arena(2, [&] {
    const Stage stage(input);
    const InitialCage first = stage.displaced(1e-4 * stage.diagonal);
    ASSERT_TRUE(first.valid);
    const Mesh cage = first.state.mesh.to_mesh();
    const testing::BruteDistance distance(input);
    for (std::size_t f = 0; f < cage.triangles.size(); ++f) {
      const auto [a, b, c] = testing::corners(cage, cage.triangles[f]);
      ASSERT_LT(first.state.face_near[f], input.triangles.size());
      EXPECT_GE(first.state.face_distance[f], distance((a + b + c) / 3) * (1 - 1e-9));
    }
  });
}

}  // namespace
}  // namespace prcage
