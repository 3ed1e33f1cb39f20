#include "parallel/conflicts.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <utility>

#include "parallel/parallel_for.h"

namespace prcage {
namespace {

using PatchPair = std::pair<std::uint32_t, std::uint32_t>;

bool alive(PatchBatch& batch, std::uint32_t patch) {
  return std::atomic_ref(batch.verdict[patch]).load(std::memory_order_relaxed) == Verdict::accepted;
}

// Boxes of the triangles of the patches that are still in the race, empty ones for the rest.
std::vector<Box> patch_boxes(const CageState& state, const UnitFrame& frame, const PatchBatch& batch) {
  std::vector<Box> boxes(batch.triangle.size());
  parallel_each(batch.triangle.size(), default_grain, [&](std::size_t t) {
    if (!batch.alive(batch.patch_of[t])) return;
    const TriangleRef triangle = patch_triangle(state.mesh, batch, t);
    boxes[t] = bounding_box(frame, {triangle.p[0], triangle.p[1], triangle.p[2]});
  });
  return boxes;
}

void set_owners(CageState& state, const PatchBatch& batch, bool owned) {
  parallel_each(batch.size(), default_grain, [&](std::size_t i) {
    for (const std::uint32_t f : batch.removed_faces(i))
      state.face_owner[f] = owned ? static_cast<std::uint32_t>(i) : none;
  });
}

TriangleRef cage_triangle(const CornerTable& mesh, std::uint32_t f) {
  const std::uint32_t* v = &mesh.corner_vertex[3 * std::size_t{f}];
  return {{mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2])}, {v[0], v[1], v[2]}};
}

}  // namespace

void reject_hits_on_cage(CageState& state, const UnitFrame& frame, const TreeDevice& device, PatchBatch& batch) {
  set_owners(state, batch, true);
  const std::vector<Box> boxes = patch_boxes(state, frame, batch);
  BoxTree patches(device);
  patches.build(boxes, TreeQuality::fast_build);
  BoxTree cage(device);
  if (!patches.empty()) cage.build(state.face_box, TreeQuality::fast_build);
  join(patches, cage, [&](std::uint32_t t, std::uint32_t f) {
    const std::uint32_t patch = batch.patch_of[t];
    if (state.face_owner[f] == patch || !alive(batch, patch)) return;
    if (improper_contact(patch_triangle(state.mesh, batch, t), cage_triangle(state.mesh, f)))
      std::atomic_ref(batch.verdict[patch]).store(Verdict::hits_cage, std::memory_order_relaxed);
  });
  set_owners(state, batch, false);
}

void reject_conflicts(const CageState& state, const UnitFrame& frame, const TreeDevice& device, PatchBatch& batch) {
  const std::vector<Box> boxes = patch_boxes(state, frame, batch);
  BoxTree patches(device);
  patches.build(boxes, TreeQuality::fast_build);
  tbb::enumerable_thread_specific<std::vector<PatchPair>> found;
  self_join(patches, [&](std::uint32_t s, std::uint32_t t) {
    const auto [p, q] = std::minmax(batch.patch_of[s], batch.patch_of[t]);
    if (p == q) return;
    if (improper_contact(patch_triangle(state.mesh, batch, s), patch_triangle(state.mesh, batch, t)))
      found.local().emplace_back(q, p);
  });
  std::vector<PatchPair> pairs;
  for (const auto& list : found) pairs.insert(pairs.end(), list.begin(), list.end());
  // Higher patch first in each pair, so that ascending order decides lower patches before higher ones ask for them.
  std::sort(pairs.begin(), pairs.end());
  for (const auto& [higher, lower] : pairs)
    if (batch.alive(lower)) batch.verdict[higher] = Verdict::conflict;
}

}  // namespace prcage
