// Which edges are candidates, where they would go, and which of them are collapsed at once: against the definitions,
// spelled out by loops over all faces and all candidates.
#include "parallel/candidates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "core/placement.h"
#include "core/predicates.h"
#include "engine_stages.h"
#include "parallel/commit.h"

namespace prcage {
namespace {

using testing::in_arena;
using testing::Stage;
using testing::star_faces;

constexpr float no_cost = std::numeric_limits<float>::infinity();

const testing::ShapeCase cases[] = {{"bumpy", 600, 1}, {"bracket", 200, 1}, {"spikes", 300, 2},
                                    {"knot", 300, 1},  {"gyroid", 500, 3},  {"slabs", 100, 1}};

std::vector<std::uint32_t> edges_of(const CornerTable& mesh) {
  std::vector<std::uint32_t> edges;
  for (std::uint32_t h = 0; h < mesh.corner_vertex.size(); ++h)
    if (represents_edge(mesh, h)) edges.push_back(h);
  return edges;
}

// ------------------------------------------------------------------------------------------ placement

struct Placed {
  Vec3 point;
  double cost;
};

Placed place(const CageState& state, const PlacementSettings& settings, std::uint32_t h) {
  PlacementBatch batch;
  gather_placement(state.mesh, state.face_distance, h, settings, batch);
  solve_placements(settings, batch);
  return {vec(batch.solution[0]), batch.cost[0]};
}

// The slab of eq. 4 on every face of the star, and the orientation of every face that stays.
void expect_in_band(const CageState& state, double tau, std::uint32_t h, const Vec3& p) {
  const CornerTable& mesh = state.mesh;
  const double edge = (mesh.vec_at(mesh.origin(h)) - mesh.vec_at(mesh.target(h))).norm();
  for (const std::uint32_t f : star_faces(mesh, h)) {
    const Vec3 a = mesh.vec_at(mesh.origin(3 * f)), b = mesh.vec_at(mesh.target(3 * f)),
               c = mesh.vec_at(mesh.apex(3 * f));
    const Vec3 n = (b - a).cross(c - a).normalized();
    const double height = n.dot(p - (a + b + c) / 3);
    EXPECT_GT(height, 0);
    EXPECT_LT(height, std::max(0.0, tau - state.face_distance[f]) + 1e-9 * edge);
    EXPECT_GE(exact::orient3d(a.data(), b.data(), c.data(), p.data()), 0);
    for (std::uint32_t g = 3 * f; g < 3 * f + 3; ++g) {
      if (f == h / 3 || f == mesh.twin[h] / 3) continue;
      if (mesh.origin(g) != mesh.origin(h) && mesh.origin(g) != mesh.target(h)) continue;
      const Vec3 v1 = mesh.vec_at(mesh.target(g)), v2 = mesh.vec_at(mesh.apex(g));
      EXPECT_GT(n.dot((v1 - p).cross(v2 - p)), 0) << "face " << f << " would turn over";
    }
  }
}

// Sum over the star of area times squared distance to the plane of the face.
double quadric_error(const CornerTable& mesh, std::uint32_t h, const Vec3& p) {
  double sum = 0;
  for (const std::uint32_t f : star_faces(mesh, h)) {
    const Vec3 a = mesh.vec_at(mesh.origin(3 * f)), b = mesh.vec_at(mesh.target(3 * f)),
               c = mesh.vec_at(mesh.apex(3 * f));
    const Vec3 n = (b - a).cross(c - a);
    const double height = n.normalized().dot(p - a);
    sum += 0.5 * n.norm() * height * height;
  }
  return sum;
}

TEST(Placement, LiesInTheBandOfEveryFaceOfTheStar) {
  for (const auto& c : cases) {
    const Mesh input = testing::shape(c.name, c.faces, c.seed);
    in_arena(1, [&] {
      const Stage stage(input);
      const InitialCage first = stage.displaced(1e-5 * stage.diagonal);
      std::size_t feasible = 0;
      for (const double tau_rel : {1.0 / 400, 1.0 / 40, 1.0 / 10}) {
        const double tau = tau_rel * stage.diagonal;
        for (const std::uint32_t h : edges_of(first.state.mesh)) {
          if (!link_condition(first.state.mesh, h)) continue;
          const Placed placed = place(first.state, stage.placement(tau), h);
          if (std::isinf(placed.cost)) continue;
          ++feasible;
          expect_in_band(first.state, tau, h, placed.point);
        }
      }
      EXPECT_GT(feasible, 20u) << testing::label(c);
    });
  }
}

TEST(Placement, CostIsTheQuadricErrorAtTheSolution) {
  const Mesh input = testing::shape("bumpy", 400);
  in_arena(1, [&] {
    const Stage stage(input);
    const CageState state = stage.state_of(input);
    std::size_t compared = 0;
    for (const std::uint32_t h : edges_of(state.mesh)) {
      const Placed placed = place(state, stage.placement(0.3), h);
      if (std::isinf(placed.cost)) continue;
      ++compared;
      const double edge = (state.mesh.vec_at(state.mesh.origin(h)) - state.mesh.vec_at(state.mesh.target(h))).norm();
      const double scale = edge * edge * edge * edge;
      EXPECT_NEAR(placed.cost, quadric_error(state.mesh, h, placed.point), 1e-6 * (placed.cost + scale));
    }
    EXPECT_GT(compared, 100u);
  });
}

TEST(Placement, WithoutConstraintsIsTheMinimumOfTheQuadric) {
  const Mesh input = testing::shape("bumpy", 400);
  in_arena(1, [&] {
    const Stage stage(input);
    const CageState state = stage.state_of(input);
    PlacementSettings settings = stage.placement(1e-9);
    settings.regularization = 1e-9;
    settings.constrained = false;
    for (const std::uint32_t h : edges_of(state.mesh)) {
      const Placed placed = place(state, settings, h);
      const double edge = (state.mesh.vec_at(state.mesh.origin(h)) - state.mesh.vec_at(state.mesh.target(h))).norm();
      const double rounding = 1e-6 * edge * edge * edge * edge;
      EXPECT_LT(placed.cost, std::numeric_limits<double>::infinity());
      for (int k = 0; k < 6; ++k) {
        const Vec3 beside = placed.point + (k < 3 ? 0.1 : -0.1) * edge * Vec3::Unit(k % 3);
        EXPECT_LE(placed.cost, quadric_error(state.mesh, h, beside) + rounding);
      }
    }
  });
}

// Costs without a unit, so that the order of the candidates does not depend on how large the input is or where.
TEST(Placement, CostsAreFreeOfUnits) {
  const Mesh input = testing::shape("bracket", 150);
  const auto costs_of = [](const Mesh& mesh) {
    std::vector<float> costs;
    in_arena(1, [&] {
      const Stage stage(mesh);
      CageState state = stage.state_of(mesh);
      Counts counts;
      evaluate_dirty_edges(state, stage.placement(stage.diagonal / 10), counts);
      costs = state.edge_cost;
    });
    return costs;
  };
  const std::vector<float> expected = costs_of(input);
  EXPECT_GT(std::count_if(expected.begin(), expected.end(), [](float c) { return c < no_cost; }), 20);
  for (const double scale : {1e-9, 1e9}) {
    const std::vector<float> costs = costs_of(testing::scaled(input, scale));
    ASSERT_EQ(costs.size(), expected.size());
    for (std::size_t h = 0; h < costs.size(); ++h) {
      if (std::isinf(expected[h]) || std::isinf(costs[h])) {
        EXPECT_EQ(costs[h], expected[h]);
      } else {
        EXPECT_NEAR(costs[h], expected[h], 1e-3f * expected[h] + 1e-12f);
      }
    }
  }
}

// ------------------------------------------------------------------------------------------ evaluation

TEST(Evaluate, CountsAddUpAndOnlyFeasibleEdgesHaveACost) {
  for (const auto& c : cases) {
    const Mesh input = testing::shape(c.name, c.faces, c.seed);
    in_arena(2, [&] {
      const Stage stage(input);
      CageState state = stage.displaced(1e-5 * stage.diagonal).state;
      Counts counts;
      evaluate_dirty_edges(state, stage.placement(stage.diagonal / 20), counts);
      const std::vector<std::uint32_t> edges = edges_of(state.mesh);
      std::size_t link = 0, feasible = 0;
      for (const std::uint32_t h : edges) {
        link += link_condition(state.mesh, h) ? 0 : 1;
        feasible += state.edge_cost[h] < no_cost ? 1 : 0;
      }
      EXPECT_EQ(counts.evaluated, edges.size());
      EXPECT_EQ(counts.rejected_link, link);
      EXPECT_EQ(counts.rejected_infeasible, edges.size() - link - feasible);
      EXPECT_TRUE(std::all_of(state.dirty.begin(), state.dirty.end(), [](Dirt d) { return d == Dirt::clean; }));
    });
  }
}

TEST(Evaluate, OnlyEdgesAtDirtyVerticesAreTouched) {
  const Mesh input = testing::shape("bumpy", 400);
  in_arena(1, [&] {
    const Stage stage(input);
    CageState state = stage.state_of(input);
    Counts counts;
    const PlacementSettings settings = stage.placement(0.3);
    evaluate_dirty_edges(state, settings, counts);
    const std::vector<float> all = state.edge_cost;
    std::fill(state.edge_cost.begin(), state.edge_cost.end(), -1.0f);
    state.dirty[7] = Dirt::moved;
    Counts again;
    evaluate_dirty_edges(state, settings, again);
    EXPECT_EQ(again.evaluated, state.mesh.valence(7));
    for (const std::uint32_t h : edges_of(state.mesh)) {
      const bool touched = state.mesh.origin(h) == 7 || state.mesh.target(h) == 7;
      EXPECT_EQ(state.edge_cost[h], touched ? all[h] : -1.0f);
    }
  });
}

TEST(Evaluate, StarsAboveTheLimitAreLeftAlone) {
  in_arena(1, [&] {
    const Stage stage(testing::saddle_cone(40, 0.01));
    CageState state = stage.state_of(stage.input);
    PlacementSettings settings = stage.placement(1);
    settings.max_star = 30;
    Counts counts;
    evaluate_dirty_edges(state, settings, counts);
    const std::uint32_t spoke = testing::halfedge_between(state.mesh, 0, 2);
    EXPECT_TRUE(std::isinf(state.edge_cost[std::min(spoke, state.mesh.twin[spoke])]));
    EXPECT_EQ(counts.evaluated, 120u);
  });
}

// ------------------------------------------------------------------------------------------ independent sets

// Of the edges those that are the minimum on all faces of their stars.
std::set<std::uint32_t> local_minima(const CageState& state, const CollapseOrder& order,
                                     const std::vector<std::uint32_t>& edges) {
  std::map<std::uint32_t, std::uint64_t> best;  // per face
  for (const std::uint32_t h : edges) {
    const std::uint64_t key = order.key(state.edge_cost[h], h);
    for (const std::uint32_t f : star_faces(state.mesh, h)) {
      const auto it = best.emplace(f, key).first;
      it->second = std::min(it->second, key);
    }
  }
  std::set<std::uint32_t> selected;
  for (const std::uint32_t h : edges) {
    const std::uint64_t key = order.key(state.edge_cost[h], h);
    const auto star = star_faces(state.mesh, h);
    if (std::all_of(star.begin(), star.end(), [&](std::uint32_t f) { return best[f] == key; })) selected.insert(h);
  }
  return selected;
}

std::set<std::uint32_t> local_minima(const CageState& state, const CollapseOrder& order) {
  std::vector<std::uint32_t> edges = edges_of(state.mesh);
  std::erase_if(edges, [&](std::uint32_t h) { return !(state.edge_cost[h] < no_cost); });
  std::set<std::uint32_t> selected = local_minima(state, order, edges);
  if (!order.rough) return selected;
  std::set<std::uint32_t> faces;
  for (const std::uint32_t h : selected)
    for (const std::uint32_t f : star_faces(state.mesh, h)) faces.insert(f);
  std::erase_if(edges, [&](std::uint32_t h) {
    const auto star = star_faces(state.mesh, h);
    return std::any_of(star.begin(), star.end(), [&](std::uint32_t f) { return faces.count(f) > 0; });
  });
  selected.merge(local_minima(state, order, edges));
  return selected;
}

void expect_local_minima(CageState& state, const CollapseOrder& order) {
  std::fill(state.reselect.begin(), state.reselect.end(), std::uint8_t{1});
  const std::vector<Candidate> selected = select_independent_collapses(state, order);
  EXPECT_TRUE(std::is_sorted(selected.begin(), selected.end(), [&](const Candidate& a, const Candidate& b) {
    return state.mesh.origin(a.halfedge) < state.mesh.origin(b.halfedge);
  }));
  std::set<std::uint32_t> edges;
  std::set<std::uint32_t> faces;
  for (const Candidate& c : selected) {
    edges.insert(c.halfedge);
    EXPECT_EQ(c.key, order.key(state.edge_cost[c.halfedge], c.halfedge));
    for (const std::uint32_t f : star_faces(state.mesh, c.halfedge))
      EXPECT_TRUE(faces.insert(f).second) << "shared face";
  }
  EXPECT_EQ(edges, local_minima(state, order));
  const bool any = std::any_of(state.edge_cost.begin(), state.edge_cost.end(), [](float c) { return c < no_cost; });
  EXPECT_EQ(selected.empty(), !any);
}

TEST(Select, CollapsesAreTheLocalMinimaAndTheirStarsAreDisjoint) {
  for (const auto& c : cases) {
    const Mesh input = testing::shape(c.name, c.faces, c.seed);
    in_arena(2, [&] {
      const Stage stage(input);
      CageState state = stage.displaced(1e-5 * stage.diagonal).state;
      Counts counts;
      evaluate_dirty_edges(state, stage.placement(stage.diagonal / 15), counts);
      expect_local_minima(state, {});
      expect_local_minima(state, {.seed = 12345});
      expect_local_minima(state, {.seed = 12345, .rough = true});
      // Equal costs everywhere: only the hash of the edge decides.
      for (const std::uint32_t h : edges_of(state.mesh)) state.edge_cost[h] = 0;
      expect_local_minima(state, {.seed = 1});
      // Few candidates.
      std::mt19937_64 random(c.seed);
      for (const std::uint32_t h : edges_of(state.mesh))
        if (random() % 20 != 0) state.edge_cost[h] = no_cost;
      expect_local_minima(state, {.seed = 2});
      std::fill(state.edge_cost.begin(), state.edge_cost.end(), no_cost);
      expect_local_minima(state, {.seed = 3});
    });
  }
}

// Selections that only look where costs changed are those that look everywhere.
TEST(Select, FollowsTheCostsThatChange) {
  const Mesh input = testing::shape("bumpy", 1000);
  in_arena(2, [&] {
    const Stage stage(input);
    CageState state = stage.state_of(input);
    Counts counts;
    evaluate_dirty_edges(state, stage.placement(stage.diagonal / 15), counts);
    std::mt19937_64 random(4);
    const std::vector<std::uint32_t> edges = edges_of(state.mesh);
    const CollapseOrder order{.rough = true};
    for (int step = 0; step < 20; ++step) {
      for (int i = 0; i < 30; ++i)
        set_cost(state, edges[random() % edges.size()],
                 random() % 3 == 0 ? no_cost : static_cast<float>(random() % 99));
      std::set<std::uint32_t> selected;
      for (const Candidate& c : select_independent_collapses(state, order)) selected.insert(c.halfedge);
      ASSERT_EQ(selected, local_minima(state, order));
    }
  });
}

// Estimated costs are those of the edges before the collapse, twice as large; all that is not estimated is evaluated,
// and selections see every change.
TEST(Select, FollowsEstimatedCosts) {
  const Mesh input = testing::shape("bumpy", 1500);
  in_arena(2, [&] {
    const Stage stage(input);
    CageState state = stage.state_of(input);
    const PlacementSettings settings = stage.placement(stage.diagonal / 15);
    const CollapseOrder order{.rough = true};
    for (int round = 0; round < 12; ++round) {
      Counts counts;
      evaluate_dirty_edges(state, settings, counts);
      if (round > 0) {
        EXPECT_LT(counts.evaluated, state.live_faces / 4);
      }
      const std::vector<Candidate> selected = select_independent_collapses(state, order);
      std::set<std::uint32_t> edges;
      for (const Candidate& c : selected) edges.insert(c.halfedge);
      ASSERT_EQ(edges, local_minima(state, order));
      const PatchBatch batch = stage.patches(state, settings, selected);
      ASSERT_GT(batch.size(), 10u);
      const CageState before = state;
      commit_collapses(state, batch, NewCosts::estimated);
      for (std::size_t i = 0; i < batch.size(); ++i) {
        std::map<std::uint32_t, float> least;  // by the vertex at the other end
        for (const std::uint32_t end :
             {before.mesh.origin(batch.candidate[i].halfedge), before.mesh.target(batch.candidate[i].halfedge)})
          for_each_outgoing(before.mesh, end, [&](std::uint32_t h) {
            const float cost = before.edge_cost[std::min(h, before.mesh.twin[h])];
            const auto it = least.emplace(before.mesh.target(h), cost).first;
            it->second = std::min(it->second, cost);
          });
        for_each_outgoing(state.mesh, batch.moved[i], [&](std::uint32_t h) {
          EXPECT_EQ(state.edge_cost[std::min(h, state.mesh.twin[h])], 2 * least.at(state.mesh.target(h)));
        });
      }
    }
  });
}

TEST(Select, CollapsesDoNotDependOnThreads) {
  const Mesh input = testing::shape("bumpy", 20000);
  const auto selected_with = [&](int threads) {
    std::vector<std::uint32_t> edges;
    in_arena(threads, [&] {
      const Stage stage(input);
      CageState state = stage.state_of(input);
      Counts counts;
      evaluate_dirty_edges(state, stage.placement(stage.diagonal / 40), counts);
      for (const Candidate& c : select_independent_collapses(state, {})) edges.push_back(c.halfedge);
    });
    return edges;
  };
  const std::vector<std::uint32_t> expected = selected_with(1);
  EXPECT_GT(expected.size(), 500u);
  EXPECT_EQ(selected_with(2), expected);
  EXPECT_EQ(selected_with(4), expected);
}

// Their exact order would select only where they begin to rise.
TEST(Select, CostsThatRiseEvenlyHoldFewCollapsesUp) {
  const Mesh input = testing::shape("bumpy", 20000);
  in_arena(2, [&] {
    const Stage stage(input);
    CageState state = stage.state_of(input);
    std::fill(state.edge_cost.begin(), state.edge_cost.end(), no_cost);
    std::fill(state.reselect.begin(), state.reselect.end(), std::uint8_t{1});
    const std::vector<std::uint32_t> edges = edges_of(state.mesh);
    const auto selected_of = [&](const auto& cost) {
      for (const std::uint32_t h : edges) set_cost(state, h, static_cast<float>(cost(h)));
      return select_independent_collapses(state, {.rough = true}).size();
    };
    const std::size_t of_equal_costs = selected_of([](std::uint32_t) { return 1.0; });
    const std::size_t of_rising_costs =
        selected_of([&](std::uint32_t h) { return 2 + state.mesh.vec_at(state.mesh.origin(h)).x() / stage.diagonal; });
    EXPECT_GT(of_equal_costs, edges.size() / 100);
    EXPECT_GT(of_rising_costs, of_equal_costs / 2);
  });
}

TEST(Select, KeysOrderByCostAndAreUnique) {
  std::set<std::uint64_t> keys;
  for (std::uint32_t h = 0; h < 5000; ++h) keys.insert(candidate_key(0.5f, h, 99));
  EXPECT_EQ(keys.size(), 5000u);
  const float costs[] = {0.0f, 1e-38f, 1e-9f, 0.5f, 1.0f, 3e38f};
  for (std::size_t i = 0; i + 1 < std::size(costs); ++i)
    for (std::uint32_t h = 0; h < 100; ++h)
      EXPECT_LT(candidate_key(costs[i], h, h), candidate_key(costs[i + 1], h * 7 + 1, h));
  EXPECT_NE(candidate_key(1.0f, 5, 1), candidate_key(1.0f, 5, 2));
}

TEST(Select, StepsOrderByCostAndAreUnique) {
  const CollapseOrder order{.seed = 99, .rough = true};
  std::set<std::uint64_t> keys;
  std::size_t in_order = 0;
  for (std::uint32_t h = 0; h < 5000; ++h) {
    keys.insert(order.key(0.5f, h));
    in_order += order.key(0.5f, h + 1) < order.key(0.51f, h) ? 1 : 0;  // of one step
    for (float cost = 1e-30f; cost < 1e30f; cost *= 1e4f)
      ASSERT_LT(order.key(cost, h), order.key(1.126f * cost, h + 1));
  }
  EXPECT_EQ(keys.size(), 5000u);
  EXPECT_NEAR(static_cast<double>(in_order), 2500, 250);
}

TEST(Select, FlipsHaveNoVertexInCommonAndAreTheMinimaAtTheirFour) {
  for (const auto& c : cases) {
    const Mesh input = testing::shape(c.name, c.faces, c.seed);
    in_arena(2, [&] {
      const CornerTable mesh = CornerTable::from_mesh(input);
      const auto quad = [&](std::uint32_t h) {
        return std::array{mesh.origin(h), mesh.target(h), mesh.apex(h), mesh.apex(mesh.twin[h])};
      };
      std::mt19937_64 random(c.seed);
      std::vector<Candidate> candidates;
      std::map<std::uint32_t, std::uint64_t> best;  // per vertex
      for (const std::uint32_t h : edges_of(mesh)) {
        if (random() % 3 != 0) continue;
        candidates.push_back({candidate_key(static_cast<float>(random() % 16), h, 0), h});
        for (const std::uint32_t v : quad(h))
          best[v] = std::min(best.emplace(v, candidates.back().key).first->second, candidates.back().key);
      }
      std::set<std::uint32_t> expected;
      for (const Candidate& k : candidates) {
        const auto v = quad(k.halfedge);
        if (std::all_of(v.begin(), v.end(), [&](std::uint32_t u) { return best[u] == k.key; }))
          expected.insert(k.halfedge);
      }
      std::set<std::uint32_t> selected, vertices;
      for (const Candidate& k : select_independent_flips(mesh, candidates)) {
        selected.insert(k.halfedge);
        for (const std::uint32_t v : quad(k.halfedge)) EXPECT_TRUE(vertices.insert(v).second) << "shared vertex";
      }
      EXPECT_EQ(selected, expected);
      EXPECT_FALSE(selected.empty());
    });
  }
}

}  // namespace
}  // namespace prcage
