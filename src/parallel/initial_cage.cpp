#include "parallel/initial_cage.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/displacement.h"
#include "core/distance.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

// Steps below 2^-30 sigma are beyond what doubles resolve at the scale of the diagonal.
constexpr int max_halvings = 30;
constexpr std::size_t examples = 5;

// Positions of C_0 as a function of the steps.
class Displacer {
 public:
  Displacer(const Mesh& surface, const CornerTable& mesh, const DisplacementSettings& settings)
      : surface_(surface), settings_(settings), direction_(mesh.vertex_slots()), singular_(mesh.vertex_slots(), 0) {
    parallel_each(mesh.vertex_slots(), default_grain, [&](std::size_t v) {
      singular_[v] = displacement_direction(mesh, static_cast<std::uint32_t>(v), direction_[v]) ? 0 : 1;
    });
  }

  double first_step(std::size_t v) const {
    return std::min(settings_.step, settings_.longest_move / std::max(1.0, direction_[v].norm()));
  }

  Position moved(std::size_t v, double step) const {
    const Vec3 p = vec(surface_.positions[v]) + step * direction_[v];
    if (!settings_.float_positions) return position(p);
    Position rounded;
    for (int k = 0; k < 3; ++k) rounded[static_cast<std::size_t>(k)] = static_cast<double>(static_cast<float>(p[k]));
    return rounded;
  }

  std::size_t singular_count() const {
    return static_cast<std::size_t>(std::count(singular_.begin(), singular_.end(), 1));
  }

 private:
  const Mesh& surface_;
  const DisplacementSettings& settings_;
  std::vector<Vec3> direction_;
  std::vector<std::uint8_t> singular_;
};

struct Conflicts {
  FacePairs self;
  FacePairs input;
  bool none() const { return self.count == 0 && input.count == 0; }
};

// Conflicts of the cage's faces in `changed` (all if it is empty).
Conflicts find_conflicts(const std::vector<Position>& positions, const std::vector<Triangle>& triangles,
                         const SurfaceTree& input, std::span<const std::uint8_t> changed, const TreeDevice& device) {
  SurfaceTree cage(device);
  cage.build(input.frame(), positions, triangles, TreeQuality::fast_build);
  if (changed.empty()) return {self_intersections(cage), contacts(cage, input)};
  SurfaceTree part(device);
  part.build(input.frame(), positions, triangles, TreeQuality::fast_build, changed);
  return {self_intersections(cage, part, changed), contacts(part, input)};
}

// Halves the step at the corners of all faces in conflict. Returns the vertices that changed.
std::vector<std::uint32_t> halve_at(const Conflicts& conflicts, const std::vector<Triangle>& triangles,
                                    std::vector<double>& step) {
  std::vector<std::uint32_t> vertices;
  const auto add_face = [&](std::uint32_t f) { vertices.insert(vertices.end(), triangles[f].begin(), triangles[f].end()); };
  for (const auto& [f, g] : conflicts.self.pairs) {
    add_face(f);
    add_face(g);
  }
  for (const auto& pair : conflicts.input.pairs) add_face(pair[0]);
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (const std::uint32_t v : vertices) step[v] *= 0.5;
  return vertices;
}

std::vector<std::uint8_t> faces_at(const std::vector<std::uint32_t>& vertices, const CornerTable& mesh) {
  std::vector<std::uint8_t> flagged(mesh.face_slots(), 0);
  for (const std::uint32_t v : vertices) for_each_outgoing(mesh, v, [&](std::uint32_t h) { flagged[h / 3] = 1; });
  return flagged;
}

// Distance of a displaced face's centroid to the face it comes from: an upper bound of its distance to the input.
double centroid_distance(const Mesh& surface, const std::vector<Position>& moved, std::size_t f) {
  const Triangle& t = surface.triangles[f];
  const Vec3 centroid = (vec(moved[t[0]]) + vec(moved[t[1]]) + vec(moved[t[2]])) / 3;
  return (centroid - closest_point(centroid, vec(surface.positions[t[0]]), vec(surface.positions[t[1]]),
                                   vec(surface.positions[t[2]])))
      .norm();
}

void fill_state(const Mesh& surface, const UnitFrame& frame, CageState& state) {
  const std::size_t faces = surface.triangles.size();
  state.live_faces = faces;
  state.face_distance.resize(faces);
  state.face_box.resize(faces);
  state.face_owner.assign(faces, none);
  state.edge_cost.assign(3 * faces, std::numeric_limits<float>::infinity());
  state.dirty.assign(surface.positions.size(), 1);
  const std::vector<Position>& moved = state.mesh.position;
  parallel_each(faces, default_grain, [&](std::size_t f) {
    const Triangle& t = surface.triangles[f];
    state.face_distance[f] = round_distance_up(centroid_distance(surface, moved, f));
    state.face_box[f] = bounding_box(frame, {moved[t[0]].data(), moved[t[1]].data(), moved[t[2]].data()});
  });
}

void keep_examples(FacePairs& pairs) {
  if (pairs.pairs.size() > examples) pairs.pairs.resize(examples);
}

}  // namespace

InitialCage displace(const Mesh& surface, const SurfaceTree& input, const DisplacementSettings& settings,
                     const TreeDevice& device) {
  InitialCage result;
  CornerTable& mesh = result.state.mesh;
  mesh = CornerTable::from_mesh(surface);
  const Displacer displacer(surface, mesh, settings);
  result.singular_vertices = displacer.singular_count();

  const std::size_t vertices = surface.positions.size();
  result.step.resize(vertices);
  parallel_each(vertices, default_grain, [&](std::size_t v) {
    result.step[v] = displacer.first_step(v);
    mesh.position[v] = displacer.moved(v, result.step[v]);
  });

  std::vector<std::uint8_t> was_halved(vertices, 0);
  Conflicts conflicts = find_conflicts(mesh.position, surface.triangles, input, {}, device);
  for (int halving = 0; halving < max_halvings && !conflicts.none(); ++halving) {
    const std::vector<std::uint32_t> changed = halve_at(conflicts, surface.triangles, result.step);
    for (const std::uint32_t v : changed) {
      was_halved[v] = 1;
      mesh.position[v] = displacer.moved(v, result.step[v]);
    }
    conflicts = find_conflicts(mesh.position, surface.triangles, input, faces_at(changed, mesh), device);
  }
  result.halved_vertices = static_cast<std::size_t>(std::count(was_halved.begin(), was_halved.end(), 1));
  result.valid = conflicts.none();
  result.self_intersections = std::move(conflicts.self);
  result.contacts = std::move(conflicts.input);
  keep_examples(result.self_intersections);
  keep_examples(result.contacts);
  fill_state(surface, input.frame(), result.state);
  return result;
}

}  // namespace prcage
