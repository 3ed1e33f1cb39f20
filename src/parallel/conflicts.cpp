#include "parallel/conflicts.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>

#include "parallel/obstacle.h"
#include "parallel/pair_collector.h"
#include "parallel/parallel_for.h"
#include "parallel/turned_components.h"

namespace prcage {
namespace {

constexpr std::uint32_t run_length = 32;

// Least cosine between a direction and a normal that counts as facing it: well above the error of stored normals.
constexpr double least_cosine = 1e-4;

bool surely_faces(const Vec3& n, const Normal& normal) {
  return n.x() * double{normal[0]} + n.y() * double{normal[1]} + n.z() * double{normal[2]} > least_cosine;
}

// Holds the normals of several faces: no angle to `axis` is larger than that of the given cosine and sine.
struct Cone {
  Vec3 axis = Vec3::Zero();
  double cosine = 1;  // not positive: no use
  double sine = 0;

  // Do all normals face n? Their angles to it are at most the sum of the cone's and that between n and the axis.
  bool all_face(const Vec3& n) const {
    const double c = n.dot(axis);
    if (!(c > 0) || !(cosine > 0)) return false;
    return c * cosine - std::sqrt(std::max(0.0, 1 - c * c)) * sine > 2 * least_cosine;
  }
};

Cone cone_of(std::span<const Box> boxes, std::span<const Normal> normals) {
  Cone cone;
  const auto vec_of = [](const Normal& n) { return Vec3(n[0], n[1], n[2]); };
  for (const Normal& n : normals) cone.axis += vec_of(n);
  const double length = cone.axis.norm();
  if (!(length > 0)) return {Vec3::Zero(), 0, 1};
  cone.axis /= length;
  for (std::size_t i = 0; i < normals.size(); ++i)
    if (!boxes[i].empty()) cone.cosine = std::min(cone.cosine, cone.axis.dot(vec_of(normals[i])));
  cone.sine = std::sqrt(std::max(0.0, 1 - cone.cosine * cone.cosine));
  return cone;
}

Box united(std::span<const Box> boxes) {
  Box box;
  for (const Box& b : boxes) box.unite(b);
  return box;
}

// Consecutive faces: they are near each other, since faces are sorted along a curve. One tree over the boxes of runs
// stands for one over all faces at a fraction of its cost.
struct Runs {
  std::vector<Box> box;
  std::vector<Cone> normals;

  static std::uint32_t first(std::uint32_t run) { return run * run_length; }
  static std::uint32_t last(std::uint32_t run, const CageState& state) {
    return std::min(first(run) + run_length, static_cast<std::uint32_t>(state.face_box.size()));
  }
};

Runs runs_of(const CageState& state) {
  Runs runs;
  const std::size_t n = (state.face_box.size() + run_length - 1) / run_length;
  runs.box.resize(n);
  runs.normals.resize(n);
  parallel_each(n, run_length, [&](std::size_t r) {
    const std::uint32_t first = Runs::first(static_cast<std::uint32_t>(r));
    const std::size_t length = Runs::last(static_cast<std::uint32_t>(r), state) - first;
    runs.box[r] = united(std::span(state.face_box).subspan(first, length));
    runs.normals[r] =
        cone_of(std::span(state.face_box).subspan(first, length), std::span(state.face_normal).subspan(first, length));
  });
  return runs;
}

TriangleRef cage_triangle(const CornerTable& mesh, std::uint32_t f) {
  const auto [a, b, c] = mesh.face(f);
  return {{mesh.point(a), mesh.point(b), mesh.point(c)}, {a, b, c}};
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

// Once patch p is part of the cage, its faces must face the direction of patch q as well: then q is proved as against
// the cage before.
bool proved_apart(const PatchBatch& batch, std::size_t p, std::size_t q) {
  if (batch.unproved[q] != 0) return false;
  const auto normals = batch.normals(p);
  return std::all_of(normals.begin(), normals.end(),
                     [&](const Normal& normal) { return surely_faces(batch.direction[q], normal); });
}

bool patches_meet(const CageState& state, const PatchBatch& batch, std::size_t p, std::size_t q) {
  for (std::size_t s = batch.first_face[p]; s < batch.first_face[p + 1]; ++s)
    for (std::size_t t = batch.first_face[q]; t < batch.first_face[q + 1]; ++t)
      if (batch.box[s].overlaps(batch.box[t]) &&
          improper_contact(patch_triangle(state.mesh, batch, s), patch_triangle(state.mesh, batch, t)))
        return true;
  return false;
}

// Of the patches still in the race those that condition 2 of core/projection.h does not prove free of contact with the
// rest of the cage.
std::vector<std::uint8_t> unproved_patches(const CageState& state, const TreeDevice& device, const Runs& runs,
                                           const BoxTree& run_tree, const PatchBatch& batch) {
  std::vector<std::uint8_t> unproved(batch.size(), 0);
  parallel_each(batch.size(), default_grain,
                [&](std::size_t i) { unproved[i] = batch.alive(i) && batch.direction[i].isZero(0) ? 1 : 0; });
  const auto boxes = patch_boxes(state, batch, [&](std::size_t i) { return batch.alive(i) && unproved[i] == 0; });
  BoxTree patches(device);
  patches.build(boxes, TreeQuality::fast_build);
  join(patches, run_tree, [&](std::uint32_t patch, std::uint32_t run) {
    const Vec3& n = batch.direction[patch];
    if (runs.normals[run].all_face(n)) return;
    for (std::uint32_t f = Runs::first(run); f < Runs::last(run, state); ++f)
      if (boxes[patch].overlaps(state.face_box[f]) && !surely_faces(n, state.face_normal[f]))
        std::atomic_ref(unproved[patch]).store(1, std::memory_order_relaxed);
  });
  return unproved;
}

}  // namespace

void reject_hits_on_cage(const CageState& state, const TreeDevice& device, PatchBatch& batch) {
  const Runs runs = runs_of(state);
  BoxTree run_tree(device);
  run_tree.build(runs.box, TreeQuality::fast_build);
  batch.unproved = unproved_patches(state, device, runs, run_tree, batch);
  const auto boxes = patch_boxes(state, batch, [&](std::size_t i) { return batch.unproved[i] != 0; });
  BoxTree patches(device);
  patches.build(boxes, TreeQuality::fast_build);
  join(patches, run_tree, [&](std::uint32_t patch, std::uint32_t run) {
    for (std::uint32_t f = Runs::first(run); f < Runs::last(run, state) && alive(batch, patch); ++f) {
      if (boxes[patch].overlaps(state.face_box[f]) && meets_face(state, batch, patch, f))
        std::atomic_ref(batch.verdict[patch]).store(Verdict::hits_cage, std::memory_order_relaxed);
    }
  });
}

void reject_conflicts(const CageState& state, const TreeDevice& device, PatchBatch& batch) {
  const auto boxes = patch_boxes(state, batch, [&](std::size_t i) { return batch.alive(i); });
  BoxTree patches(device);
  patches.build(boxes, TreeQuality::fast_build);
  PairCollector found;
  self_join(patches, [&](std::uint32_t p, std::uint32_t q) {
    if (proved_apart(batch, p, q) || !patches_meet(state, batch, p, q)) return;
    const bool in_order = batch.candidate[p] < batch.candidate[q];
    found.add(in_order ? q : p, in_order ? p : q);
  });
  auto pairs = found.result().pairs;
  // By the higher one of each pair, so that lower patches are decided before higher ones ask for them.
  std::sort(pairs.begin(), pairs.end(),
            [&](const auto& a, const auto& b) { return batch.candidate[a[0]] < batch.candidate[b[0]]; });
  for (const auto& [higher, lower] : pairs)
    if (batch.alive(lower)) batch.verdict[higher] = Verdict::conflict;
}

void reject_collisions(const CageState& state, const TreeDevice& device, Sides sides, PatchBatch& batch) {
  if (state.components > 1) reject_sweeps_of_components(state, device, batch);
  reject_hits_on_cage(state, device, batch);
  reject_conflicts(state, device, batch);
  if (sides == Sides::both) reject_turned_components(state, batch);
}

}  // namespace prcage
