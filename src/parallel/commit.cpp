#include "parallel/commit.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>

#include "core/round_outward.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

constexpr std::size_t commit_grain = 64;
// Costs of edges before and after a collapse beside them. Lower estimates select many edges that turn out to be too
// dear, higher ones leave the order to chance.
constexpr float dearer_by_collapse = 2;

// Several patches may have a vertex of their rims in common, but none that moves.
void mark_dirty(CageState& state, std::uint32_t v, Dirt dirt) {
  std::atomic_ref(state.dirty[v]).store(dirt, std::memory_order_relaxed);
}

void take_over_faces(CageState& state, const PatchBatch& batch, std::size_t i) {
  for (std::size_t t = batch.first_face[i]; t < batch.first_face[i + 1]; ++t) {
    const std::uint32_t f = batch.face[t];
    state.face_distance[f] = float_above(batch.near[t].distance);
    state.face_near[f] = batch.near[t].face;
    state.face_reach[f] = float_above(batch.reach[t]);
    state.face_box[f] = batch.box[t];
    state.face_normal[f] = batch.normal[t];
    for (const std::uint32_t u : batch.triangle[t]) mark_dirty(state, u, u == batch.moved[i] ? Dirt::moved : Dirt::rim);
  }
}

float cost_at(const CageState& state, std::uint32_t h) { return state.edge_cost[std::min(h, state.mesh.twin[h])]; }

// Each dying face makes one edge of two, which keeps the smaller cost.
void collapse_keeping_costs(CageState& state, std::uint32_t h, const Position& point) {
  std::array<std::uint32_t, 2> edge;
  std::array<float, 2> cost;
  for (std::size_t k = 0; k < 2; ++k) {
    const std::uint32_t dying = k == 0 ? h : state.mesh.twin[h];
    const std::uint32_t next = next_halfedge(dying), previous = previous_halfedge(dying);
    edge[k] = std::min(state.mesh.twin[next], state.mesh.twin[previous]);
    cost[k] = std::min(cost_at(state, next), cost_at(state, previous));
  }
  collapse_edge(state.mesh, h, point);
  for (std::size_t k = 0; k < 2; ++k) state.edge_cost[edge[k]] = cost[k];
}

// Edges of a moved vertex are expected to be dearer than before. Those that were impossible are left to evaluation.
void estimate_costs(CageState& state, std::uint32_t moved) {
  for_each_outgoing(state.mesh, moved, [&](std::uint32_t h) {
    const std::uint32_t edge = std::min(h, state.mesh.twin[h]);
    set_cost(state, edge, dearer_by_collapse * state.edge_cost[edge]);
  });
  mark_dirty(state, moved, Dirt::rim);
}

}  // namespace

void commit_collapses(CageState& state, const PatchBatch& batch, NewCosts costs) {
  parallel_each(batch.size(), commit_grain, [&](std::size_t i) {
    const std::uint32_t h = batch.candidate[i].halfedge;
    switch (batch.verdict[i]) {
      case Verdict::accepted:
        for (const std::uint32_t dying : batch.removed_faces(i).first(2)) state.face_box[dying] = Box{};
        if (costs == NewCosts::estimated)
          collapse_keeping_costs(state, h, batch.point[i]);
        else
          collapse_edge(state.mesh, h, batch.point[i]);
        take_over_faces(state, batch, i);
        if (costs == NewCosts::estimated) estimate_costs(state, batch.moved[i]);
        break;
      case Verdict::conflict:
        break;  // still a candidate
      default:
        set_cost(state, h, std::numeric_limits<float>::infinity());
    }
  });
  state.live_faces -= 2 * batch.count(Verdict::accepted);
}

void commit_moves(CageState& state, const PatchBatch& batch) {
  parallel_each(batch.size(), commit_grain, [&](std::size_t i) {
    if (!batch.alive(i)) return;
    state.mesh.position[batch.moved[i]] = batch.point[i];
    take_over_faces(state, batch, i);
  });
}

void commit_flips(CageState& state, const PatchBatch& batch) {
  parallel_each(batch.size(), commit_grain, [&](std::size_t i) {
    if (!batch.alive(i)) return;
    flip_edge(state.mesh, batch.candidate[i].halfedge);
    take_over_faces(state, batch, i);
  });
}

}  // namespace prcage
