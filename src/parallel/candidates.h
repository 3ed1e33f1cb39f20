// Stages 1 and 2 of a round: costs of the edges whose surroundings changed, and an independent set of the cheapest.
#pragma once

#include <cstdint>
#include <vector>

#include "parallel/cage_state.h"
#include "parallel/parallel_for.h"

namespace prcage {

// Evaluates every edge with a moved endpoint, and impossible ones with new faces round an endpoint: link condition,
// constraints, QP, cost. Writes edge_cost, clears dirty, adds to the counts.
void evaluate_dirty_edges(CageState& state, const PlacementSettings& settings, Counts& counts);

// Order-preserving key of a non-negative cost, made unique by the halfedge.
std::uint64_t candidate_key(float cost, std::uint32_t halfedge, std::uint64_t seed);

// Which of two collapses goes first.
struct CollapseOrder {
  std::uint64_t seed = 0;
  // Fewer rounds, for surfaces of many faces. Chance decides between costs that differ by less than an eighth: where
  // costs rise evenly from place to place, their exact order lets each edge wait for the next cheaper one beside it, in
  // chains as long as the mesh is wide. And once the minima are selected, those of the edges that are left are as well.
  bool rough = false;

  float rank(float cost) const;
  std::uint64_t key(float cost, std::uint32_t halfedge) const { return candidate_key(rank(cost), halfedge, seed); }
};

// Edges of finite cost that are the minimum on every face of their star (in a rough order: or of those whose stars are
// disjoint from these), in the order of their origins: what is near in space stays near in the stages to come. Stars of
// the result are disjoint, so the collapses cannot disturb each other's topology. Looks again at the vertices marked in
// `reselect` only: all of them must be when the order is another one than before.
std::vector<Candidate> select_independent_collapses(CageState& state, const CollapseOrder& order);

// Collapses with the positions that their problems have now.
struct PlacedCollapses {
  std::vector<Candidate> candidate;
  std::vector<Position> point;
};

// Costs may be out of date, since only the edges at moved vertices are evaluated again: solves the problems of the
// selected edges on the present cage, writes their costs, and leaves out those that have become impossible or much
// dearer.
PlacedCollapses place_collapses(CageState& state, const PlacementSettings& settings,
                                const std::vector<Candidate>& selected);

// Leaves so many of the cheapest collapses, in the order in which they are.
void keep_cheapest(PlacedCollapses& placed, std::size_t count);

// For operations that change the edges of all vertices in a quadrilateral: of the given candidates those that are the
// minimum at the four vertices of their two faces, in the given order.
std::vector<Candidate> select_independent_flips(const CornerTable& mesh, const std::vector<Candidate>& candidates);

// For operations that move single vertices: of those that are wanted some of which no two are neighbours, chosen at
// random, as halfedges that begin there.
template <class Wanted>
std::vector<Candidate> select_independent_vertices(const CornerTable& mesh, std::uint64_t seed, const Wanted& wanted) {
  const auto key = [&](std::uint32_t v) { return candidate_key(0, v, seed); };
  return parallel_gather<Candidate>(mesh.vertex_slots(), 1u << 12, [&](std::size_t begin, std::size_t end, auto& list) {
    for (auto v = static_cast<std::uint32_t>(begin); v < end; ++v) {
      if (!wanted(v)) continue;
      bool least = true;
      for_each_outgoing(mesh, v, [&](std::uint32_t h) {
        const std::uint32_t w = mesh.target(h);
        least = least && (!wanted(w) || key(v) < key(w));
      });
      if (least) list.push_back({key(v), mesh.vertex_halfedge[v]});
    }
  });
}

}  // namespace prcage
