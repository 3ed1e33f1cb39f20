#include "parallel/commit.h"

#include <atomic>
#include <limits>

#include "core/round_outward.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

constexpr std::size_t commit_grain = 64;

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

}  // namespace

void commit_collapses(CageState& state, const PatchBatch& batch) {
  parallel_each(batch.size(), commit_grain, [&](std::size_t i) {
    const std::uint32_t h = batch.candidate[i].halfedge;
    switch (batch.verdict[i]) {
      case Verdict::accepted:
        for (const std::uint32_t dying : batch.removed_faces(i).first(2)) state.face_box[dying] = Box{};
        collapse_edge(state.mesh, h, batch.point[i]);
        take_over_faces(state, batch, i);
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
