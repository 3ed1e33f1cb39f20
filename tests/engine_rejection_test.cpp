// Every reason for which a candidate can be rejected, provoked on purpose through the stages that give it; and the
// verdicts of whole batches against loops over all pairs of triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "core/predicates.h"
#include "engine_stages.h"
#include "parallel/commit.h"
#include "parallel/conflicts.h"
#include "parallel/flips.h"
#include "parallel/validate.h"

namespace prcage {
namespace {

using testing::halfedge_between;
using testing::in_arena;
using testing::Stage;
using testing::topology;

constexpr float no_cost = std::numeric_limits<float>::infinity();

Candidate candidate(const CageState& state, std::uint32_t h, float cost = 1) {
  h = std::min(h, state.mesh.twin[h]);
  return {candidate_key(cost, h, 0), h};
}

// The patch of one collapse, moved to `point`.
PatchBatch collapse_to(const Stage& stage, CageState& state, std::uint32_t h, const Vec3& point) {
  PatchBatch batch = stage.patches(state, stage.placement(stage.diagonal), {candidate(state, h)});
  batch.point[0] = position(point);
  set_bounds(state.mesh, stage.tree.frame(), batch);
  return batch;
}

void run_all_tests(Stage& stage, CageState& state, double tau, PatchBatch& batch) {
  test_patches_locally(state, batch);
  test_patches_against_band(state, *stage.band, {tau, tau}, batch);
  reject_hits_on_cage(state, stage.device, batch);
  reject_conflicts(state, stage.device, batch);
}

// A plate whose top is a flat grid of n by n cells, and vertices of that grid.
constexpr std::uint32_t cells = 6;
Mesh grid_plate() { return testing::flat_plate(cells, 1, 0, 0.2); }
std::uint32_t top_vertex(std::uint32_t i, std::uint32_t j) { return (cells + 1) * (cells + 1) + i * (cells + 1) + j; }

// ------------------------------------------------------------------------------------------ evaluation

TEST(Rejection, LinkCondition) {
  // The edges between two tetrahedra glued at a face.
  const Mesh bipyramid{{{1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                       {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}}};
  in_arena(1, [&] {
    const Stage stage(bipyramid);
    CageState state = stage.state_of(bipyramid);
    Counts counts;
    evaluate_dirty_edges(state, stage.placement(10), counts);
    EXPECT_EQ(counts.evaluated, 9u);
    EXPECT_EQ(counts.rejected_link, 3u);
    for (const auto& [a, b] : {std::pair{0u, 1u}, std::pair{1u, 2u}, std::pair{2u, 0u}}) {
      const std::uint32_t h = halfedge_between(state.mesh, a, b);
      EXPECT_EQ(state.edge_cost[std::min(h, state.mesh.twin[h])], no_cost);
    }
  });
}

TEST(Rejection, InfeasibleWhereTheBandIsTooThin) {
  const Mesh input = testing::sphere(2);
  in_arena(1, [&] {
    const Stage stage(input);
    CageState state = stage.state_of(input);
    Counts thin;
    evaluate_dirty_edges(state, stage.placement(1e-12), thin);
    EXPECT_EQ(thin.rejected_infeasible, thin.evaluated - thin.rejected_link);
    EXPECT_TRUE(select_independent_collapses(state, {}).empty());
    std::fill(state.dirty.begin(), state.dirty.end(), Dirt::moved);
    Counts wide;
    evaluate_dirty_edges(state, stage.placement(1), wide);
    EXPECT_LT(wide.rejected_infeasible, wide.evaluated / 2);
  });
}

// ------------------------------------------------------------------------------------------ local tests

TEST(Rejection, SweepsInward) {
  const Mesh input = testing::sphere(2);
  in_arena(1, [&] {
    const Stage stage(input);
    CageState state = stage.state_of(input);
    const std::uint32_t h = state.mesh.vertex_halfedge[9];
    const Vec3 middle = 0.5 * (state.mesh.vec_at(state.mesh.origin(h)) + state.mesh.vec_at(state.mesh.target(h)));
    PatchBatch outward = collapse_to(stage, state, h, 1.2 * middle);
    test_patches_locally(state, outward);
    EXPECT_EQ(outward.verdict[0], Verdict::accepted);
    // The midpoint of an edge of a convex solid is inside.
    PatchBatch inward = collapse_to(stage, state, h, middle);
    test_patches_locally(state, inward);
    EXPECT_EQ(inward.verdict[0], Verdict::sweeps_inward);
  });
}

// The last bit decides: on the plane of all faces of the star is allowed, one ulp below is not.
TEST(Rejection, SweepsInwardByOneUlp) {
  in_arena(1, [&] {
    const Stage stage(grid_plate());
    CageState state = stage.state_of(stage.input);
    const std::uint32_t h = halfedge_between(state.mesh, top_vertex(2, 2), top_vertex(3, 2));
    const Vec3 p = 0.5 * (state.mesh.vec_at(top_vertex(2, 2)) + state.mesh.vec_at(top_vertex(3, 2)));
    PatchBatch on = collapse_to(stage, state, h, p);
    test_patches_locally(state, on);
    EXPECT_EQ(on.verdict[0], Verdict::accepted);
    PatchBatch below = collapse_to(stage, state, h, {p.x(), p.y(), std::nextafter(p.z(), 0.0)});
    test_patches_locally(state, below);
    EXPECT_EQ(below.verdict[0], Verdict::sweeps_inward);
  });
}

TEST(Rejection, DegenerateFacesAndFolds) {
  in_arena(1, [&] {
    const Stage stage(grid_plate());
    CageState state = stage.state_of(stage.input);
    const std::uint32_t a = top_vertex(2, 2), b = top_vertex(3, 2);
    const std::uint32_t h = halfedge_between(state.mesh, a, b);
    const auto verdict_at = [&](const Vec3& p) {
      PatchBatch batch = collapse_to(stage, state, h, p);
      test_patches_locally(state, batch);
      return batch.verdict[0];
    };
    // The rim of the star is a polygon round the edge in the plane of the top.
    EXPECT_EQ(verdict_at(state.mesh.vec_at(a)), Verdict::accepted);
    EXPECT_EQ(verdict_at(state.mesh.vec_at(top_vertex(1, 1))), Verdict::degenerate) << "a corner of the rim";
    EXPECT_EQ(verdict_at({0.25, 1.0 / 6, 0.2}), Verdict::degenerate) << "on the rim";
    EXPECT_EQ(verdict_at({0.9, 0.9, 0.2}), Verdict::degenerate) << "beyond the rim: the patch folds over";
  });
}

// ------------------------------------------------------------------------------------------ band

TEST(Rejection, BeyondTau) {
  in_arena(1, [&] {
    Stage stage(grid_plate());
    CageState state = stage.state_of(stage.input);
    const std::uint32_t h = halfedge_between(state.mesh, top_vertex(2, 2), top_vertex(3, 2));
    const double rise = 0.01;
    for (const double tau : {0.5 * rise, rise * (1 - 1e-6), rise * (1 + 1e-6), 2 * rise}) {
      PatchBatch batch = collapse_to(stage, state, h, {0.4, 0.35, 0.2 + rise});
      test_patches_locally(state, batch);
      test_patches_against_band(state, *stage.band, {tau, tau}, batch);
      EXPECT_EQ(batch.verdict[0], tau < rise ? Verdict::beyond_tau : Verdict::accepted) << tau;
      batch = collapse_to(stage, state, h, {0.4, 0.35, 0.2 + rise});
      test_patches_against_band(state, *stage.band, {tau}, batch);
      EXPECT_EQ(batch.verdict[0], Verdict::accepted) << "the paper only bounds centroids, by the constraints";
    }
  });
}

// ------------------------------------------------------------------------------------------ collisions

TEST(Rejection, HitsTheRestOfTheCage) {
  const Mesh input = testing::merge(grid_plate(), testing::moved(grid_plate(), {0, 0, 0.3}));  // 0.1 apart
  in_arena(2, [&] {
    Stage stage(input);
    CageState state = stage.state_of(input);
    const std::uint32_t h = halfedge_between(state.mesh, top_vertex(2, 2), top_vertex(3, 2));
    for (const double rise : {0.0999, 0.1, 0.15}) {
      PatchBatch batch = collapse_to(stage, state, h, {0.4, 0.35, 0.2 + rise});
      run_all_tests(stage, state, 1, batch);
      EXPECT_EQ(batch.verdict[0], 0.2 + rise < 0.3 ? Verdict::accepted : Verdict::hits_cage) << rise;
    }
  });
}

// Two wedges, ridge against ridge: the collapse of either ridge rises into the gap, both together would meet.
struct Wedges {
  static constexpr double height = 0.5;
  Mesh lower, upper, both;

  explicit Wedges(double gap)
      : lower(testing::wedge(0.1, height, 0, 1)),
        upper(testing::wedge(0.12, height, 2 * height + gap, -1)),
        both(testing::merge(lower, upper)) {}

  // Selects the ridges only, the cheaper one first.
  static std::vector<Candidate> ridges(const Stage& stage, CageState& state) {
    Counts counts;
    evaluate_dirty_edges(state, stage.placement(1), counts);
    for (std::uint32_t h = 0; h < state.edge_cost.size(); ++h) {
      const std::uint32_t a = std::min(state.mesh.origin(h), state.mesh.target(h)) % 6;
      const std::uint32_t b = std::max(state.mesh.origin(h), state.mesh.target(h)) % 6;
      if (a != 4 || b != 5) state.edge_cost[h] = no_cost;
    }
    return select_independent_collapses(state, {});
  }
};

// How far the collapse of the lower ridge alone rises.
double rise_of_ridge(const Mesh& wedge) {
  double rise = 0;
  in_arena(1, [&] {
    const Stage stage(wedge);
    CageState state = stage.state_of(wedge);
    const auto selected = Wedges::ridges(stage, state);
    ASSERT_EQ(selected.size(), 1u);
    rise = stage.patches(state, stage.placement(1), selected).point[0][2] - Wedges::height;
  });
  return rise;
}

TEST(Rejection, TwoSheetsThatWouldBothMoveIntoTheSameGap) {
  const double rise = rise_of_ridge(Wedges(1).lower);
  ASSERT_GT(rise, 1e-3);
  const Wedges wedges(1.5 * rise);
  in_arena(2, [&] {
    Stage stage(wedges.both);
    CageState state = stage.state_of(wedges.both);
    const std::vector<Candidate> selected = Wedges::ridges(stage, state);
    ASSERT_EQ(selected.size(), 2u);
    const std::size_t cheap = selected[0] < selected[1] ? 0 : 1, dear = 1 - cheap;
    for (const Candidate& alone : selected) {
      PatchBatch batch = stage.patches(state, stage.placement(1), {alone});
      run_all_tests(stage, state, 1, batch);
      EXPECT_EQ(batch.verdict[0], Verdict::accepted) << "valid alone";
    }
    PatchBatch batch = stage.patches(state, stage.placement(1), selected);
    run_all_tests(stage, state, 1, batch);
    EXPECT_EQ(batch.verdict[cheap], Verdict::accepted) << "the cheaper one wins";
    EXPECT_EQ(batch.verdict[dear], Verdict::conflict);

    commit_collapses(state, batch);
    EXPECT_EQ(state.live_faces, wedges.both.triangles.size() - 2);
    EXPECT_LT(state.edge_cost[selected[dear].halfedge], no_cost) << "the loser stays a candidate";
    const Mesh cage = state.mesh.to_mesh();
    EXPECT_TRUE(validate(cage).valid());

    // In the next round it meets what has been committed.
    PatchBatch again = stage.patches(state, stage.placement(1), {selected[dear]});
    run_all_tests(stage, state, 1, again);
    EXPECT_EQ(again.verdict[0], Verdict::hits_cage);
    commit_collapses(state, again);
    EXPECT_EQ(state.edge_cost[selected[dear].halfedge], no_cost) << "out until its surroundings change";
    EXPECT_TRUE(testing::same(state.mesh.to_mesh(), cage));
  });
}

// ------------------------------------------------------------------------------------------ whole batches

// Patches of a shape's independent collapses, blown outward so far that many of them collide.
PatchBatch wild_batch(const Stage& stage, CageState& state, std::uint64_t seed, double farthest = 0.4) {
  Counts counts;
  evaluate_dirty_edges(state, stage.placement(stage.diagonal / 5), counts);
  for (std::uint32_t h = 0; h < state.edge_cost.size(); ++h)
    if (represents_edge(state.mesh, h) && link_condition(state.mesh, h))
      state.edge_cost[h] = std::min(state.edge_cost[h], 1.0f);
  PatchBatch batch =
      stage.patches(state, stage.placement(stage.diagonal / 5), select_independent_collapses(state, {.seed = seed}));
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> reach(0.0, farthest * stage.diagonal);
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const std::uint32_t h = batch.candidate[i].halfedge;
    const Vec3 middle = 0.5 * (state.mesh.vec_at(state.mesh.origin(h)) + state.mesh.vec_at(state.mesh.target(h)));
    batch.point[i] = position(middle + reach(random) * testing::random_unit(random));
  }
  set_bounds(state.mesh, stage.tree.frame(), batch);
  return batch;
}

bool triangles_meet(const CageState& state, const PatchBatch& batch, std::size_t s, std::size_t t) {
  return improper_contact(patch_triangle(state.mesh, batch, s), patch_triangle(state.mesh, batch, t));
}

bool patches_meet(const CageState& state, const PatchBatch& batch, std::size_t i, std::size_t j) {
  for (std::size_t s = batch.first_face[i]; s < batch.first_face[i + 1]; ++s)
    for (std::size_t t = batch.first_face[j]; t < batch.first_face[j + 1]; ++t)
      if (triangles_meet(state, batch, s, t)) return true;
  return false;
}

bool hits_cage(const CageState& state, const PatchBatch& batch, std::size_t i) {
  const auto removed = batch.removed_faces(i);
  for (std::uint32_t f = 0; f < state.mesh.face_slots(); ++f) {
    if (std::find(removed.begin(), removed.end(), f) != removed.end()) continue;
    const std::uint32_t* v = &state.mesh.corner_vertex[3 * std::size_t{f}];
    const TriangleRef face{{state.mesh.point(v[0]), state.mesh.point(v[1]), state.mesh.point(v[2])},
                           {v[0], v[1], v[2]}};
    for (std::size_t t = batch.first_face[i]; t < batch.first_face[i + 1]; ++t)
      if (improper_contact(patch_triangle(state.mesh, batch, t), face)) return true;
  }
  return false;
}

// Of the patches accepted so far: each, by cost, unless it meets one that stays.
void reject_greedily(const CageState& state, const PatchBatch& batch, std::vector<Verdict>& verdict) {
  std::vector<std::size_t> order(batch.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t j) { return batch.candidate[i] < batch.candidate[j]; });
  for (auto i = order.begin(); i != order.end(); ++i)
    for (auto j = order.begin(); j != i && verdict[*i] == Verdict::accepted; ++j)
      if (verdict[*j] == Verdict::accepted && patches_meet(state, batch, *i, *j)) verdict[*i] = Verdict::conflict;
}

TEST(Verdicts, CollisionsAreThoseOfAllPairsAndTheGreedyChoice) {
  std::size_t hits = 0, conflicts = 0, accepted = 0;
  for (const char* name : {"bumpy", "slabs", "knot", "spikes"})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const Mesh input = testing::shape(name, 500);
      in_arena(2, [&] {
        const Stage stage(input);
        CageState state = stage.state_of(input);
        PatchBatch batch = wild_batch(stage, state, seed);
        std::vector<Verdict> expected(batch.size(), Verdict::accepted);
        for (std::size_t i = 0; i < batch.size(); ++i)
          if (hits_cage(state, batch, i)) expected[i] = Verdict::hits_cage;
        reject_hits_on_cage(state, stage.device, batch);
        EXPECT_EQ(batch.verdict, expected);
        hits += batch.count(Verdict::hits_cage);
        // As if nothing had been hit, so that the patches meet each other.
        batch.verdict.assign(batch.size(), Verdict::accepted);
        expected.assign(batch.size(), Verdict::accepted);
        reject_greedily(state, batch, expected);
        reject_conflicts(state, stage.device, batch);
        EXPECT_EQ(batch.verdict, expected);
        conflicts += batch.count(Verdict::conflict);
        accepted += batch.count(Verdict::accepted);
      });
    }
  EXPECT_GT(hits, 50u);
  EXPECT_GT(conflicts, 20u);
  EXPECT_GT(accepted, 50u);
}

// With the directions that the local tests find, most patches are accepted without looking at pairs of triangles: the
// verdicts must be those of all pairs all the same.
TEST(Verdicts, ProjectionsProveNothingThatPairsRefute) {
  std::size_t proved = 0, hits = 0, conflicts = 0;
  for (const char* name : {"bumpy", "slabs", "knot", "spikes", "gyroid"})
    for (const double farthest : {0.0, 0.02, 0.1})
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const Mesh input = testing::shape(name, 800);
        in_arena(2, [&] {
          const Stage stage(input);
          CageState state = stage.state_of(input);
          PatchBatch batch = wild_batch(stage, state, seed, farthest);
          test_patches_locally(state, batch);
          batch.verdict.assign(batch.size(), Verdict::accepted);
          reject_hits_on_cage(state, stage.device, batch);
          for (std::size_t i = 0; i < batch.size(); ++i) {
            EXPECT_EQ(batch.verdict[i] == Verdict::hits_cage, hits_cage(state, batch, i));
            proved += batch.unproved[i] == 0 ? 1 : 0;
          }
          hits += batch.count(Verdict::hits_cage);
          std::vector<Verdict> expected = batch.verdict;
          reject_greedily(state, batch, expected);
          reject_conflicts(state, stage.device, batch);
          EXPECT_EQ(batch.verdict, expected);
          conflicts += batch.count(Verdict::conflict);
        });
      }
  EXPECT_GT(proved, 300u);
  EXPECT_GT(hits, 50u);
  EXPECT_GT(conflicts, 0u);
}

TEST(Verdicts, LocalTestsAreThoseOfTheirDefinition) {
  std::size_t seen[3] = {0, 0, 0};
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Mesh input = testing::shape("bumpy", 500);
    in_arena(2, [&] {
      const Stage stage(input);
      CageState state = stage.state_of(input);
      PatchBatch batch = wild_batch(stage, state, seed);
      // Some of them where the constraints want them.
      const PatchBatch placed = stage.patches(state, stage.placement(stage.diagonal / 5), batch.candidate);
      for (std::size_t i = 0; i < batch.size(); i += 2) batch.point[i] = placed.point[i];
      test_patches_locally(state, batch);
      for (std::size_t i = 0; i < batch.size(); ++i) {
        bool outward = true, proper = true;
        for (const std::uint32_t f : batch.removed_faces(i)) {
          const std::uint32_t* v = &state.mesh.corner_vertex[3 * std::size_t{f}];
          outward = outward && exact::orient3d(state.mesh.point(v[0]), state.mesh.point(v[1]), state.mesh.point(v[2]),
                                               batch.point[i].data()) >= 0;
        }
        for (std::size_t s = batch.first_face[i]; s < batch.first_face[i + 1]; ++s) {
          const TriangleRef t = patch_triangle(state.mesh, batch, s);
          proper = proper && !exact::collinear(t.p[0], t.p[1], t.p[2]);
          for (std::size_t r = batch.first_face[i]; r < s; ++r) proper = proper && !triangles_meet(state, batch, s, r);
        }
        const Verdict expected = !outward ? Verdict::sweeps_inward : !proper ? Verdict::degenerate : Verdict::accepted;
        EXPECT_EQ(batch.verdict[i], expected);
        ++seen[static_cast<int>(expected)];
      }
    });
  }
  EXPECT_GT(seen[static_cast<int>(Verdict::accepted)], 10u);
  EXPECT_GT(seen[static_cast<int>(Verdict::sweeps_inward)], 10u);
}

TEST(Verdicts, PatchesListTheStarAndItsReplacement) {
  const Mesh input = testing::shape("knot", 400);
  in_arena(2, [&] {
    const Stage stage(input);
    CageState state = stage.state_of(input);
    const PatchBatch batch = wild_batch(stage, state, 1);
    ASSERT_GT(batch.size(), 10u);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const std::uint32_t h = batch.candidate[i].halfedge;
      std::vector<std::uint32_t> removed(batch.removed_faces(i).begin(), batch.removed_faces(i).end());
      EXPECT_EQ(removed[0], h / 3);
      EXPECT_EQ(removed[1], state.mesh.twin[h] / 3);
      std::sort(removed.begin(), removed.end());
      EXPECT_EQ(removed, testing::star_faces(state.mesh, h));
      EXPECT_EQ(batch.first_face[i + 1] - batch.first_face[i] + 2, removed.size());
    }
    // Committed, the faces are the triangles that were listed.
    CageState after = state;
    commit_collapses(after, batch);
    for (std::size_t t = 0; t < batch.triangle.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(after.mesh.corner_vertex[3 * std::size_t{batch.face[t]} + k], batch.triangle[t][k]);
    EXPECT_EQ(topology(after.mesh.to_mesh()), topology(input));
    EXPECT_EQ(after.live_faces, after.mesh.to_mesh().triangles.size());
  });
}

// ------------------------------------------------------------------------------------------ flips

double smallest_angle(const Mesh& mesh) {
  double smallest = 4;
  for (const Triangle& t : mesh.triangles) {
    const auto c = testing::corners(mesh, t);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 u = c[(i + 1) % 3] - c[i], v = c[(i + 2) % 3] - c[i];
      smallest = std::min(smallest, std::atan2(u.cross(v).norm(), u.dot(v)));
    }
  }
  return smallest;
}

TEST(Flips, KeepTheCageValidAndNestedAndRaiseTheSmallestAngle) {
  std::uint64_t flips = 0;
  for (const char* name : {"bumpy", "knot", "bracket"}) {
    const Mesh input = testing::shape(name, 500);
    in_arena(2, [&] {
      const Stage stage(input);
      for (const TauMode mode : {TauMode::strict, TauMode::paper}) {
        CageState state = stage.displaced(1e-5 * stage.diagonal).state;
        const Mesh before = state.mesh.to_mesh();
        Counts counts;
        const double tau = stage.diagonal / 40;
        const BandLimits limits = mode == TauMode::strict ? BandLimits{tau, tau} : BandLimits{tau};
        flip_edges(state, {limits, 0}, stage.tree.frame(), stage.device, *stage.band, nullptr, counts);
        const Mesh after = state.mesh.to_mesh();
        EXPECT_TRUE(certify(input, after).valid());
        EXPECT_TRUE(testing::weakly_encloses(after, before, 1e-9 * stage.diagonal));
        EXPECT_EQ(after.positions, before.positions);
        EXPECT_GE(smallest_angle(after), smallest_angle(before) * (1 - 1e-9));
        if (mode == TauMode::strict) {
          EXPECT_LE(testing::sampled_distance(after, input, 4), tau);
        }
        EXPECT_LE(counts.flips, counts.flips_tried);
        flips += counts.flips;
      }
    });
  }
  EXPECT_GT(flips, 20u);
}

// Far from the input there is slack to take away; close to it, flips must stop.
TEST(Flips, TakeVolumeAwayAndLeaveTheInputEnclosed) {
  std::uint64_t flips = 0, refused = 0;
  for (const char* name : {"bumpy", "knot", "spikes"}) {
    const Mesh input = testing::shape(name, 500);
    in_arena(2, [&] {
      const Stage stage(input);
      const CheckedMesh checked = validate_mesh(input, stage.device);
      const Obstacle obstacle(checked.valid.tree, checked.valid.components, stage.device);
      for (const double step : {1e-2, 1e-5}) {
        CageState state = stage.displaced(step * stage.diagonal).state;
        const Mesh before = state.mesh.to_mesh();
        const double tau = stage.diagonal / 20;
        FlipSettings settings{{tau, tau}, 0};
        settings.obstacle = &obstacle;
        settings.goal = FlipGoal::volume;
        settings.wide_enough = 15;
        Counts counts;
        flip_edges(state, settings, stage.tree.frame(), stage.device, *stage.band, nullptr, counts);
        const Mesh after = state.mesh.to_mesh();
        EXPECT_TRUE(certify(input, after).valid());
        EXPECT_EQ(after.positions, before.positions);
        EXPECT_TRUE(testing::weakly_encloses(before, after, 1e-9 * stage.diagonal));
        if (counts.flips > 0) {
          EXPECT_LT(validate(after).volume, validate(before).volume);
        }
        EXPECT_GE(smallest_angle(after), std::min(smallest_angle(before), 14.9 * std::numbers::pi / 180));
        flips += counts.flips;
        refused += counts.flips_tried - counts.flips;
      }
    });
  }
  EXPECT_GT(flips, 20u);
  EXPECT_GT(refused, 20u);
}

// The planes and boxes that spare exact tests must not spare one too many.
TEST(Obstacle, RejectsMovesThatTouchTheInputAndNoOthers) {
  std::size_t hits = 0, misses = 0;
  for (const char* name : {"bumpy", "knot", "spikes", "bracket"}) {
    const Mesh input = testing::shape(name, 500);
    in_arena(2, [&] {
      const Stage stage(input);
      const CheckedMesh checked = validate_mesh(input, stage.device);
      const Obstacle obstacle(checked.valid.tree, checked.valid.components, stage.device);
      const double step = 1e-3 * stage.diagonal;
      const CageState state = stage.displaced(step).state;
      const CornerTable& mesh = state.mesh;
      std::mt19937_64 random(5);
      const auto selected = select_independent_vertices(mesh, 0, [](std::uint32_t) { return true; });
      for (const double length : {0.5, 2.0, 30.0}) {
        std::vector<Position> points;
        for (const Candidate& c : selected)
          points.push_back(
              position(mesh.vec_at(mesh.origin(c.halfedge)) + length * step * testing::random_unit(random)));
        PatchBatch batch = build_moves(state, stage.tree.frame(), selected, points);
        std::vector<std::uint8_t> touches(batch.size(), 0);
        for (std::size_t t = 0; t < batch.triangle.size(); ++t)
          for (std::uint32_t f = 0; f < input.triangles.size(); ++f)
            if (touch(patch_triangle(mesh, batch, t).p, checked.valid.tree.triangle(f).p))
              touches[batch.patch_of[t]] = 1;
        obstacle.reject_hits(state, batch);
        for (std::size_t i = 0; i < batch.size(); ++i) {
          EXPECT_EQ(batch.verdict[i] == Verdict::hits_input, touches[i] != 0) << name << " " << i;
          ++(touches[i] != 0 ? hits : misses);
        }
      }
    });
  }
  EXPECT_GT(hits, 100u);
  EXPECT_GT(misses, 100u);
}

// A quadrilateral bent outward along its diagonal: the other diagonal would cut into the solid.
TEST(Flips, NeverCutIntoTheSolid) {
  const Mesh input = testing::sphere(3);
  in_arena(1, [&] {
    const Stage stage(input);
    CageState state = stage.state_of(input);
    std::vector<Candidate> edges;
    for (std::uint32_t h = 0; h < state.edge_cost.size(); ++h)
      if (represents_edge(state.mesh, h)) edges.push_back(candidate(state, h));
    PatchBatch batch = build_flips(state, stage.tree.frame(), select_independent_flips(state.mesh, edges));
    ASSERT_GT(batch.size(), 10u);
    test_patches_locally(state, batch);
    EXPECT_EQ(batch.count(Verdict::sweeps_inward), batch.size());
    Counts counts;
    flip_edges(state, {{1, 1}, 0}, stage.tree.frame(), stage.device, *stage.band, nullptr, counts);
    EXPECT_EQ(counts.flips, 0u);
  });
}

TEST(Flips, ACancelledRunStopsAtOnce) {
  const Mesh input = testing::shape("bumpy", 500);
  in_arena(1, [&] {
    const Stage stage(input);
    CageState state = stage.displaced(1e-5 * stage.diagonal).state;
    const Mesh before = state.mesh.to_mesh();
    Control control;
    control.cancel();
    Counts counts;
    flip_edges(state, {{stage.diagonal, stage.diagonal}, 0}, stage.tree.frame(), stage.device, *stage.band, &control,
               counts);
    EXPECT_EQ(counts.flips_tried, 0u);
    EXPECT_TRUE(testing::same(state.mesh.to_mesh(), before));
  });
}

}  // namespace
}  // namespace prcage
