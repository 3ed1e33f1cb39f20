#include "parallel/obstacle.h"

#include <atomic>
#include <cmath>
#include <numbers>

#include "core/filtered_cross.h"
#include "parallel/parallel_for.h"
#include "parallel/winding.h"

namespace prcage {
namespace {

void reject(PatchBatch& batch, std::uint32_t patch) {
  std::atomic_ref(batch.verdict[patch]).store(Verdict::hits_input, std::memory_order_relaxed);
}

// The slab between the two planes that hold a triangle, in the frame of the boxes: that of a large triangle cuts few of
// the boxes that overlap the triangle's own.
class Slab {
 public:
  Slab() = default;
  Slab(const UnitFrame& frame, const double* const p[3]) {
    const Vec3 cross = difference(p[0], p[1]).cross(difference(p[0], p[2]));
    const double length = cross.norm();
    const Vec3 n = length > 0 ? Vec3(cross / length) : Vec3::Zero();
    double heights[3];
    for (int i = 0; i < 3; ++i) heights[i] = n.dot((Vec3(p[i][0], p[i][1], p[i][2]) - frame.centre) * frame.scale);
    const auto [low, high] = std::minmax({heights[0], heights[1], heights[2]});
    normal_ = n.cast<float>();
    low_ = static_cast<float>(low) - rounding;
    high_ = static_cast<float>(high) + rounding;
  }

  bool misses(const Box& box) const {
    float height = 0, half = 0;
    for (int k = 0; k < 3; ++k) {
      height += 0.5f * normal_[k] * (box.upper[k] + box.lower[k]);
      half += 0.5f * std::abs(normal_[k]) * (box.upper[k] - box.lower[k]);
    }
    return (height - half > high_) | (height + half < low_);
  }

 private:
  static constexpr float rounding = 1e-5f;  // of heights in about the unit cube, with much to spare
  Eigen::Vector3f normal_ = Eigen::Vector3f::Zero();
  float low_ = 0, high_ = 0;
};

// Solid angle of a triangle seen from x (van Oosterom and Strackee 1983).
double solid_angle(const double* const p[3], const Vec3& x) {
  const Vec3 a = difference(x.data(), p[0]), b = difference(x.data(), p[1]), c = difference(x.data(), p[2]);
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

// Is x between the old faces and the new ones? Together they are a closed surface, which x is not on.
bool sweeps_over(const CageState& state, const PatchBatch& batch, std::uint32_t patch, const Vec3& x) {
  double sum = 0;
  for (std::size_t t = batch.first_face[patch]; t < batch.first_face[patch + 1]; ++t)
    sum += solid_angle(patch_triangle(state.mesh, batch, t).p, x);
  for (const std::uint32_t f : batch.removed_faces(patch)) {
    const auto [a, b, c] = state.mesh.face(f);
    const double* const p[3] = {state.mesh.point(a), state.mesh.point(b), state.mesh.point(c)};
    sum -= solid_angle(p, x);
  }
  return std::abs(sum) > 2 * std::numbers::pi;  // 4 pi inside, 0 outside
}

}  // namespace

Obstacle::Obstacle(const SurfaceTree& surface, const Components& components, const TreeDevice& device)
    : surface_(surface),
      device_(device),
      component_point_(component_points(surface.positions(), surface.triangles(), components)),
      component_box_(components.count()),
      component_tree_(device) {
  parallel_each(components.count(), 1, [&](std::size_t c) {
    for (const std::uint32_t f : components[c])
      component_box_[c].unite(
          bounding_box(surface.frame(), {surface.corner(f, 0), surface.corner(f, 1), surface.corner(f, 2)}));
  });
  component_tree_.build(component_box_, TreeQuality::fast_build);
}

void Obstacle::reject_sweeps(const CageState& state, PatchBatch& batch) const {
  const auto swept = patch_boxes(state, batch, [&](std::size_t i) { return batch.alive(i); });
  BoxTree patches(device_);
  patches.build(swept, TreeQuality::fast_build);
  join(patches, component_tree_, [&](std::uint32_t patch, std::uint32_t c) {
    if (swept[patch].contains(component_box_[c]) && alive(batch, patch) &&
        sweeps_over(state, batch, patch, vec(component_point_[c])))
      reject(batch, patch);
  });
}

void Obstacle::reject_hits(const CageState& state, PatchBatch& batch) const {
  std::vector<Box> boxes(batch.box.size());
  std::vector<Slab> slabs(boxes.size());
  for (std::size_t t = 0; t < boxes.size(); ++t) {
    if (!batch.alive(batch.patch_of[t])) continue;
    boxes[t] = batch.box[t];
    slabs[t] = Slab(surface_.frame(), patch_triangle(state.mesh, batch, t).p);
  }
  BoxTree triangles(device_);
  triangles.build(boxes, TreeQuality::fast_build);
  const BoxRuns& runs = surface_.runs();
  join(triangles, runs.tree(), [&](std::uint32_t t, std::uint32_t run) {
    const std::uint32_t patch = batch.patch_of[t];
    if (!alive(batch, patch) || slabs[t].misses(runs.run_box(run))) return;
    const TriangleRef triangle = patch_triangle(state.mesh, batch, t);
    runs.for_each_overlap(run, boxes[t], [&](std::uint32_t f) {
      if (alive(batch, patch) && touch(triangle.p, surface_.triangle(f).p)) reject(batch, patch);
    });
  });
}

namespace {

struct MovingComponents {
  std::vector<Box> box;
  std::vector<std::uint32_t> vertex;  // one of each
};

MovingComponents components_of(const CageState& state) {
  const CornerTable& mesh = state.mesh;
  MovingComponents components{std::vector<Box>(state.components), std::vector<std::uint32_t>(state.components, none)};
  for (std::uint32_t f = 0; f < mesh.face_slots(); ++f) {
    if (!mesh.face_alive(f)) continue;
    const std::uint32_t v = mesh.origin(3 * f), c = state.vertex_component[v];
    components.box[c].unite(state.face_box[f]);
    components.vertex[c] = v;
  }
  return components;
}

}  // namespace

void reject_sweeps_of_components(const CageState& state, const TreeDevice& device, PatchBatch& batch) {
  const MovingComponents components = components_of(state);
  BoxTree component_tree(device);
  component_tree.build(components.box, TreeQuality::fast_build);
  const auto swept = patch_boxes(state, batch, [&](std::size_t i) { return batch.alive(i); });
  BoxTree patches(device);
  patches.build(swept, TreeQuality::fast_build);
  join(patches, component_tree, [&](std::uint32_t patch, std::uint32_t c) {
    const std::uint32_t own = state.vertex_component[state.mesh.origin(batch.candidate[patch].halfedge)];
    if (c != own && swept[patch].contains(components.box[c]) && alive(batch, patch) &&
        sweeps_over(state, batch, patch, state.mesh.vec_at(components.vertex[c])))
      reject(batch, patch);
  });
}

}  // namespace prcage
