#include "parallel/initial_cage.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "core/displacement.h"
#include "core/distance.h"
#include "core/predicates.h"
#include "core/round_outward.h"
#include "core/vertex_cap.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

// Steps below 2^-36 sigma are beyond what doubles resolve at the scale of the diagonal.
constexpr int max_halvings = 36;
// Steps that have become smaller may free what was held by their vertices: more rounds than halvings.
constexpr int max_separating_rounds = 4 * max_halvings;
constexpr std::size_t examples = 5;
// Radius at which a singular vertex is cut off as a share of its shortest edge.
constexpr double radius_share = 0.25;

// Whether the radius at which a vertex was cut off shrinks with the step: what is in the way of a cap may be nearer
// than that. Where the vertex has slivers, ring points on their long edges come too close to each other then.
enum class CapRadius { shrinks, stays };

// The connectivity of C_0, and its positions as a function of the steps. Vertices may outnumber the input's: singular
// ones are cut off.
class Displacer {
 public:
  Displacer(const Mesh& surface, const DisplacementSettings& settings, CapRadius radius)
      : surface_(surface),
        settings_(settings),
        radius_(radius),
        mesh_(CornerTable::from_mesh(surface)),
        direction_(mesh_.vertex_slots()) {
    std::vector<std::uint8_t> regular(mesh_.vertex_slots());
    parallel_each(mesh_.vertex_slots(), default_grain, [&](std::size_t v) {
      regular[v] = displacement_direction(mesh_, static_cast<std::uint32_t>(v), settings.step, direction_[v]) ? 1 : 0;
    });
    for (std::uint32_t v = 0; v < regular.size(); ++v)
      if (regular[v] == 0) cap_singular(v);
  }

  const CornerTable& mesh() const { return mesh_; }  // positions are those of the input
  std::size_t singular_vertices() const { return singular_; }
  std::size_t capped_vertices() const { return capped_; }

  double first_step(std::size_t v) const {
    return std::min(settings_.step, settings_.longest_move / std::max(1.0, direction_[v].norm()));
  }

  Position moved(std::size_t v, double step) const {
    const Vec3 p = start(v, step) + step * direction_[v];
    return settings_.float_positions ? round_to_floats(p) : position(p);
  }

  // The way of vertex v to twice its move, since what is in the way may come towards it.
  std::array<Position, 2> way_out(std::size_t v, double step) const {
    const Vec3 from = start(v, step);
    return {position(from), position(from + 2 * step * direction_[v])};
  }

  // The vertex of the surface that became v or that v was cut off from.
  std::uint32_t vertex_of_surface(std::size_t v) const {
    const auto cut = cut_off_from_.find(static_cast<std::uint32_t>(v));
    return cut == cut_off_from_.end() ? static_cast<std::uint32_t>(v) : cut->second;
  }

 private:
  // Where vertex v moves off from. A radius that shrinks with the step does so more slowly, since moves have to become
  // small against the cap.
  Vec3 start(std::size_t v, double step) const {
    const Vec3 p = vec(mesh_.position[v]);
    if (radius_ == CapRadius::stays || !cut_off_from_.contains(static_cast<std::uint32_t>(v))) return p;
    const Vec3 corner = vec(surface_.positions[vertex_of_surface(v)]);
    return corner + std::sqrt(step / first_step(v)) * (p - corner);
  }

  // Cuts the vertex off; each point of the ring only has the two faces beside its edge to clear.
  void cap_singular(std::uint32_t v) {
    ++singular_;
    const VertexCap cap = plan_cap(mesh_, v);
    if (cap.empty()) return;  // keeps its mean normal
    ++capped_;
    const std::size_t n = cap.fan.size();
    const Vec3 corner = mesh_.vec_at(v);
    std::vector<Vec3> normal;
    double shortest = std::numeric_limits<double>::infinity();
    for (const std::uint32_t h : cap.fan) {
      normal.push_back(unit_normal(mesh_, h));
      shortest = std::min(shortest, (mesh_.vec_at(mesh_.target(h)) - corner).norm());
    }
    const std::vector<std::uint32_t> ring =
        cap_vertex(mesh_, cap, std::min(settings_.longest_radius, radius_share * shortest));
    direction_.resize(mesh_.vertex_slots());
    if (cap.keeps_centre) direction_[v] = cap.centre_direction;
    for (std::size_t i = 0; i < n; ++i) {
      cut_off_from_[ring[i]] = v;
      const std::array<Vec3, 2> beside{normal[i], normal[(i + n - 1) % n]};
      if (!clearing_direction(beside, direction_[ring[i]])) direction_[ring[i]] = (beside[0] + beside[1]).normalized();
    }
  }

  const Mesh& surface_;
  const DisplacementSettings& settings_;
  CapRadius radius_;
  CornerTable mesh_;
  std::vector<Vec3> direction_;
  std::unordered_map<std::uint32_t, std::uint32_t> cut_off_from_;  // of ring points: the singular vertex
  std::size_t singular_ = 0;
  std::size_t capped_ = 0;
};

// Of the vertices with asked[v] != 0 those whose way out meets the input beyond their own faces.
std::vector<std::uint8_t> blocked_vertices(const Displacer& displacer, const std::vector<double>& step,
                                           const std::vector<std::uint8_t>& asked, const SurfaceTree& input,
                                           const TreeDevice& device) {
  std::vector<Box> boxes(step.size());
  parallel_each(step.size(), default_grain, [&](std::size_t v) {
    if (asked[v] == 0) return;
    const auto [from, to] = displacer.way_out(v, step[v]);
    boxes[v] = bounding_box(input.frame(), {from.data(), to.data()});
  });
  BoxRuns ways(device);
  ways.build(boxes);
  std::vector<std::uint8_t> blocked(step.size(), 0);
  join(ways, input.runs(), [&](std::uint32_t v, std::uint32_t f) {
    const Triangle& t = input.triangles()[f];
    if (std::find(t.begin(), t.end(), displacer.vertex_of_surface(v)) != t.end()) return;
    const auto [from, to] = displacer.way_out(v, step[v]);
    if (exact::segment_triangle_intersect(from.data(), to.data(), input.corner(f, 0), input.corner(f, 1),
                                          input.corner(f, 2)))
      std::atomic_ref(blocked[v]).store(1, std::memory_order_relaxed);
  });
  return blocked;
}

// Halves the steps of vertices that would pass through another sheet of the input. Sheets that have passed through each
// other no longer meet, except at their rims: the search for conflicts would free one ring of faces after the other.
// Returns the vertices that are still blocked.
std::vector<std::uint8_t> halve_where_blocked(const Displacer& displacer, const SurfaceTree& input,
                                              const TreeDevice& device, std::vector<double>& step) {
  std::vector<std::uint8_t> asked(step.size(), 1);
  for (int halving = 0;; ++halving) {
    asked = blocked_vertices(displacer, step, asked, input, device);
    if (halving == max_halvings || std::find(asked.begin(), asked.end(), 1) == asked.end()) return asked;
    for (std::size_t v = 0; v < step.size(); ++v)
      if (asked[v] != 0) step[v] *= 0.5;
  }
}

struct Conflicts {
  FacePairs self;
  FacePairs input;
  bool none() const { return self.count == 0 && input.count == 0; }
};

// The faces of a corner table without dead ones as triples of vertices.
std::span<const Triangle> triangles_of(const CornerTable& mesh) {
  static_assert(sizeof(Triangle) == 3 * sizeof(std::uint32_t));
  return {reinterpret_cast<const Triangle*>(mesh.corner_vertex.data()), mesh.face_slots()};
}

// Zero-area faces have no side: what they could touch touches a neighbour of theirs, and collapses remove them.
std::vector<std::uint8_t> faces_with_area(const CornerTable& mesh) {
  std::vector<std::uint8_t> flagged(mesh.face_slots());
  parallel_each(mesh.face_slots(), default_grain, [&](std::size_t f) {
    const Triangle& t = triangles_of(mesh)[f];
    flagged[f] = exact::collinear(mesh.point(t[0]), mesh.point(t[1]), mesh.point(t[2])) ? 0 : 1;
  });
  return flagged;
}

Conflicts find_conflicts(const CornerTable& mesh, const SurfaceTree& input, const TreeDevice& device) {
  SurfaceTree cage(device);
  cage.build(input.frame(), mesh.position, triangles_of(mesh), faces_with_area(mesh));
  const auto embedded = embedded_stars(mesh.position, triangles_of(mesh), mesh.twin);
  return {self_intersections(cage, no_limit, embedded), contacts(cage, input)};
}

// The same for the faces at `vertices` only.
Conflicts find_conflicts_at(const std::vector<std::uint32_t>& vertices, const CornerTable& mesh,
                            const SurfaceTree& input, const TreeDevice& device) {
  const std::vector<std::uint8_t> all = faces_with_area(mesh);
  std::vector<std::uint8_t> some(mesh.face_slots(), 0);
  for (const std::uint32_t v : vertices) for_each_outgoing(mesh, v, [&](std::uint32_t h) { some[h / 3] = all[h / 3]; });
  SurfaceTree cage(device);
  cage.build(input.frame(), mesh.position, triangles_of(mesh), all);
  SurfaceTree part(device);
  part.build(input.frame(), mesh.position, triangles_of(mesh), some);
  return {self_intersections(cage, part, some), contacts(part, input)};
}

// Halves the longest steps at the corners of each pair of faces in conflict: corners that made way before stay where
// they are. Returns the vertices that changed.
std::vector<std::uint32_t> halve_at(const Conflicts& conflicts, const CornerTable& mesh, std::vector<double>& step) {
  std::vector<std::uint32_t> vertices;
  const auto add = [&](std::initializer_list<std::uint32_t> faces) {
    double longest = 0;
    for (const std::uint32_t f : faces)
      for (const std::uint32_t v : triangles_of(mesh)[f]) longest = std::max(longest, step[v]);
    for (const std::uint32_t f : faces)
      for (const std::uint32_t v : triangles_of(mesh)[f])
        if (step[v] > 0.5 * longest) vertices.push_back(v);
  };
  for (const auto& [f, g] : conflicts.self.pairs) add({f, g});
  for (const auto& pair : conflicts.input.pairs) add({pair[0]});
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (const std::uint32_t v : vertices) step[v] *= 0.5;
  return vertices;
}

// A face of the surface beside face f of the cage: itself, or for a face of a cap one at a vertex of it.
std::uint32_t face_beside(const CornerTable& mesh, std::uint32_t f, std::size_t surface_faces) {
  std::uint32_t found = f;
  for (std::uint32_t h = 3 * f; found >= surface_faces && h < 3 * f + 3; ++h)
    for_each_outgoing(mesh, mesh.origin(h), [&](std::uint32_t g) { found = std::min(found, g / 3); });
  return found < surface_faces ? found : 0;
}

TriangleDistance distance_from(const Mesh& surface, std::uint32_t face) {
  const Triangle& t = surface.triangles[face];
  return {vec(surface.positions[t[0]]), vec(surface.positions[t[1]]), vec(surface.positions[t[2]])};
}

// Where a vertex could not but pass through another sheet, a face of it counts as in contact with the input.
void add_blocked(const std::vector<std::uint8_t>& blocked, const CornerTable& mesh, FacePairs& contacts) {
  for (std::size_t v = 0; v < blocked.size(); ++v) {
    if (blocked[v] == 0) continue;
    const std::uint32_t f = mesh.vertex_halfedge[v] / 3;
    ++contacts.count;
    contacts.pairs.push_back({f, f});
  }
}

void keep_examples(FacePairs& pairs) {
  if (pairs.pairs.size() > examples) pairs.pairs.resize(examples);
}

}  // namespace

void describe_faces(const Mesh& surface, const UnitFrame& frame, CageState& state) {
  const CornerTable& mesh = state.mesh;
  const std::size_t faces = mesh.face_slots();
  state.live_faces = faces;
  state.face_distance.resize(faces);
  state.face_near.resize(faces);
  state.face_reach.resize(faces);
  state.face_box.resize(faces);
  state.face_normal.resize(faces);
  forget_costs(state);
  parallel_each(faces, default_grain, [&](std::size_t f) {
    const Triangle& t = triangles_of(mesh)[f];
    const std::array<Vec3, 3> corners{mesh.vec_at(t[0]), mesh.vec_at(t[1]), mesh.vec_at(t[2])};
    state.face_near[f] = face_beside(mesh, static_cast<std::uint32_t>(f), surface.triangles.size());
    const TriangleDistance near = distance_from(surface, state.face_near[f]);
    state.face_distance[f] = float_above(std::sqrt(near.squared((corners[0] + corners[1] + corners[2]) / 3)));
    state.face_reach[f] = float_above(std::sqrt(near.largest_squared(corners)));
    state.face_box[f] = bounding_box(frame, {mesh.point(t[0]), mesh.point(t[1]), mesh.point(t[2])});
    state.face_normal[f] = reliable_normal(mesh.point(t[0]), mesh.point(t[1]), mesh.point(t[2]));
  });
}

namespace {

InitialCage displace(const Mesh& surface, const SurfaceTree& input, const DisplacementSettings& settings,
                     CapRadius radius, const TreeDevice& device) {
  const Displacer displacer(surface, settings, radius);
  InitialCage result;
  result.singular_vertices = displacer.singular_vertices();
  result.capped_vertices = displacer.capped_vertices();
  CornerTable& mesh = result.state.mesh;
  mesh = displacer.mesh();

  const std::size_t vertices = mesh.vertex_slots();
  result.step.resize(vertices);
  parallel_each(vertices, default_grain, [&](std::size_t v) { result.step[v] = displacer.first_step(v); });
  const std::vector<std::uint8_t> blocked = halve_where_blocked(displacer, input, device, result.step);
  parallel_each(vertices, default_grain, [&](std::size_t v) { mesh.position[v] = displacer.moved(v, result.step[v]); });

  Conflicts conflicts = find_conflicts(mesh, input, device);
  for (int round = 0; round < max_separating_rounds && !conflicts.none(); ++round) {
    const std::vector<std::uint32_t> changed = halve_at(conflicts, mesh, result.step);
    for (const std::uint32_t v : changed) mesh.position[v] = displacer.moved(v, result.step[v]);
    conflicts = find_conflicts_at(changed, mesh, input, device);
  }
  for (std::size_t v = 0; v < vertices; ++v) result.halved_vertices += result.step[v] < displacer.first_step(v) ? 1 : 0;
  add_blocked(blocked, mesh, conflicts.input);
  result.valid = conflicts.none();
  result.self_intersections = std::move(conflicts.self);
  result.contacts = std::move(conflicts.input);
  keep_examples(result.self_intersections);
  keep_examples(result.contacts);
  describe_faces(surface, input.frame(), result.state);
  return result;
}

}  // namespace

InitialCage displace(const Mesh& surface, const SurfaceTree& input, const DisplacementSettings& settings,
                     const TreeDevice& device) {
  InitialCage cage = displace(surface, input, settings, CapRadius::shrinks, device);
  if (cage.valid || cage.capped_vertices == 0) return cage;
  InitialCage other = displace(surface, input, settings, CapRadius::stays, device);
  return other.valid ? std::move(other) : std::move(cage);
}

}  // namespace prcage
