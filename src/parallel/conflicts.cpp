#include "parallel/conflicts.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <span>
#include <utility>

#include "parallel/parallel_for.h"

namespace prcage {
namespace {

using PatchPair = std::pair<std::uint32_t, std::uint32_t>;

bool alive(PatchBatch& batch, std::uint32_t patch) {
  return std::atomic_ref(batch.verdict[patch]).load(std::memory_order_relaxed) == Verdict::accepted;
}

constexpr std::uint32_t run_length = 32;

Box united(std::span<const Box> boxes) {
  Box box;
  for (const Box& b : boxes) {
    for (int k = 0; k < 3; ++k) {
      box.lower[k] = std::min(box.lower[k], b.lower[k]);
      box.upper[k] = std::max(box.upper[k], b.upper[k]);
    }
  }
  return box;
}

// Boxes of the patches that are still in the race, empty ones for the rest.
std::vector<Box> patch_boxes(const PatchBatch& batch) {
  std::vector<Box> boxes(batch.size());
  parallel_each(batch.size(), default_grain, [&](std::size_t i) {
    if (batch.alive(i)) boxes[i] = united(batch.boxes(i));
  });
  return boxes;
}

// Boxes of runs of consecutive faces: those are near each other, since faces are sorted along a curve. One tree over
// them stands for one over all faces at a fraction of its cost.
std::vector<Box> run_boxes(const std::vector<Box>& face_box) {
  std::vector<Box> boxes((face_box.size() + run_length - 1) / run_length);
  parallel_each(boxes.size(), run_length, [&](std::size_t r) {
    const std::size_t first = r * run_length;
    boxes[r] = united(std::span(face_box).subspan(first, std::min<std::size_t>(run_length, face_box.size() - first)));
  });
  return boxes;
}

TriangleRef cage_triangle(const CornerTable& mesh, std::uint32_t f) {
  const std::uint32_t* v = &mesh.corner_vertex[3 * std::size_t{f}];
  return {{mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2])}, {v[0], v[1], v[2]}};
}

// Does the patch meet face f, which it would not remove?
bool meets_face(const CageState& state, const PatchBatch& batch, std::size_t patch, std::uint32_t f) {
  const auto removed = batch.removed_faces(patch);
  if (std::find(removed.begin(), removed.end(), f) != removed.end()) return false;
  const TriangleRef face = cage_triangle(state.mesh, f);
  for (std::size_t t = batch.first_face[patch]; t < batch.first_face[patch + 1]; ++t)
    if (batch.box[t].overlaps(state.face_box[f]) && improper_contact(patch_triangle(state.mesh, batch, t), face))
      return true;
  return false;
}

bool patches_meet(const CageState& state, const PatchBatch& batch, std::size_t p, std::size_t q) {
  for (std::size_t s = batch.first_face[p]; s < batch.first_face[p + 1]; ++s)
    for (std::size_t t = batch.first_face[q]; t < batch.first_face[q + 1]; ++t)
      if (batch.box[s].overlaps(batch.box[t]) &&
          improper_contact(patch_triangle(state.mesh, batch, s), patch_triangle(state.mesh, batch, t)))
        return true;
  return false;
}

}  // namespace

void reject_hits_on_cage(const CageState& state, const TreeDevice& device, PatchBatch& batch) {
  const std::vector<Box> boxes = patch_boxes(batch);
  BoxTree patches(device);
  patches.build(boxes, TreeQuality::fast_build);
  if (patches.empty()) return;
  const std::vector<Box> run_box = run_boxes(state.face_box);
  BoxTree runs(device);
  runs.build(run_box, TreeQuality::fast_build);
  join(patches, runs, [&](std::uint32_t patch, std::uint32_t run) {
    const std::uint32_t first = run * run_length;
    const std::uint32_t last = std::min(first + run_length, static_cast<std::uint32_t>(state.face_box.size()));
    for (std::uint32_t f = first; f < last && alive(batch, patch); ++f) {
      if (boxes[patch].overlaps(state.face_box[f]) && meets_face(state, batch, patch, f))
        std::atomic_ref(batch.verdict[patch]).store(Verdict::hits_cage, std::memory_order_relaxed);
    }
  });
}

void reject_conflicts(const CageState& state, const TreeDevice& device, PatchBatch& batch) {
  const std::vector<Box> boxes = patch_boxes(batch);
  BoxTree patches(device);
  patches.build(boxes, TreeQuality::fast_build);
  tbb::enumerable_thread_specific<std::vector<PatchPair>> found;
  self_join(patches, [&](std::uint32_t p, std::uint32_t q) {
    if (patches_meet(state, batch, p, q)) found.local().emplace_back(q, p);
  });
  std::vector<PatchPair> pairs;
  for (const auto& list : found) pairs.insert(pairs.end(), list.begin(), list.end());
  // Higher patch first in each pair, so that ascending order decides lower patches before higher ones ask for them.
  std::sort(pairs.begin(), pairs.end());
  for (const auto& [higher, lower] : pairs)
    if (batch.alive(lower)) batch.verdict[higher] = Verdict::conflict;
}

}  // namespace prcage
