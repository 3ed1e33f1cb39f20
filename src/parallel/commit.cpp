#include "parallel/commit.h"

#include <atomic>
#include <limits>

#include "parallel/parallel_for.h"

namespace prcage {
namespace {

constexpr std::size_t commit_grain = 64;

// Several patches may have a vertex of their rims in common.
void mark_dirty(CageState& state, std::uint32_t v) {
  std::atomic_ref(state.dirty[v]).store(1, std::memory_order_relaxed);
}

void take_over_faces(CageState& state, const UnitFrame& frame, const PatchBatch& batch, std::size_t i) {
  for (std::size_t t = batch.first_face[i]; t < batch.first_face[i + 1]; ++t) {
    const std::uint32_t f = batch.face[t];
    const Triangle& v = batch.triangle[t];
    state.face_distance[f] = round_distance_up(batch.near[t].distance);
    state.face_near[f] = batch.near[t].face;
    state.face_box[f] = bounding_box(frame, {state.mesh.point(v[0]), state.mesh.point(v[1]), state.mesh.point(v[2])});
    for (const std::uint32_t u : v) mark_dirty(state, u);
  }
}

}  // namespace

void commit_collapses(CageState& state, const UnitFrame& frame, const PatchBatch& batch) {
  parallel_each(batch.size(), commit_grain, [&](std::size_t i) {
    const std::uint32_t h = batch.candidate[i].halfedge;
    switch (batch.verdict[i]) {
      case Verdict::accepted:
        for (const std::uint32_t dying : batch.removed_faces(i).first(2)) state.face_box[dying] = Box{};
        collapse_edge(state.mesh, h, batch.point[i]);
        take_over_faces(state, frame, batch, i);
        break;
      case Verdict::conflict:
        break;  // still a candidate
      default:
        state.edge_cost[h] = std::numeric_limits<float>::infinity();
    }
  });
  state.live_faces -= 2 * batch.count(Verdict::accepted);
}

void commit_flips(CageState& state, const UnitFrame& frame, const PatchBatch& batch) {
  parallel_each(batch.size(), commit_grain, [&](std::size_t i) {
    if (!batch.alive(i)) return;
    flip_edge(state.mesh, batch.candidate[i].halfedge);
    take_over_faces(state, frame, batch, i);
  });
}

}  // namespace prcage
