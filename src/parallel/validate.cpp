#include "parallel/validate.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "core/adjacency.h"
#include "core/mesh_view.h"
#include "core/predicates.h"
#include "core/repair.h"
#include "parallel/arena.h"
#include "parallel/morton.h"
#include "parallel/parallel_for.h"
#include "parallel/winding.h"

namespace prcage {
namespace {

constexpr std::size_t max_examples = 5;

enum class FaceOrder { as_given, along_curve };

// Runs the checks in an order in which each can rely on those before it, and goes on past a defect as far as the
// next check still means something.
class Validator {
 public:
  Validator(const Mesh& mesh, const TreeDevice& device, bool accept_inside_out, FaceOrder order)
      : mesh_(mesh),
        device_(device),
        accept_inside_out_(accept_inside_out),
        order_(order),
        out_{{}, ValidSurface(device)} {}

  CheckedMesh run() {
    if (check_faces()) {
      check_connectivity();
      if (check_coordinates()) check_geometry();
    }
    return std::move(out_);
  }

 private:
  const Mesh& mesh_;
  const TreeDevice& device_;
  bool accept_inside_out_;
  FaceOrder order_;
  CheckedMesh out_;

  SubMesh& surface_ = out_.valid.surface;
  std::vector<std::uint32_t> twin_;
  std::vector<std::array<std::uint32_t, 2>> duplicates_;  // faces of surface_

  bool check_faces();
  void take_faces(std::vector<std::uint32_t> faces);
  void check_connectivity();
  bool check_coordinates();
  void check_geometry();
  std::vector<std::uint32_t> repair(std::vector<std::uint32_t> degenerate);
  bool check_self_intersections(const std::vector<std::uint32_t>& degenerate);
  void check_orientation(bool self_intersecting);
  void turn_round();

  bool is_closed_manifold() const;
  void report(DefectKind kind, std::size_t count, std::vector<DefectExample> examples);

  // Reports a list of elements, if there are any, with an example made of each of the first ones.
  template <class Element, class MakeExample>
  void report_all(DefectKind kind, const std::vector<Element>& elements, const MakeExample& make_example) {
    std::vector<DefectExample> examples;
    for (std::size_t i = 0; i < std::min(elements.size(), max_examples); ++i)
      examples.push_back(make_example(elements[i]));
    if (!elements.empty()) report(kind, elements.size(), std::move(examples));
  }

  DefectExample face_example(std::uint32_t face) const;
  DefectExample pair_example(const std::array<std::uint32_t, 2>& faces) const;
  DefectExample edge_example(std::uint32_t halfedge) const;
  DefectExample vertex_example(std::uint32_t vertex) const;
};

void Validator::report(DefectKind kind, std::size_t count, std::vector<DefectExample> examples) {
  out_.validation.defects.push_back({kind, count, std::move(examples)});
}

// ---------------------------------------------- examples, in numbers of the mesh as given

Vec3 centroid(const Mesh& mesh, const Triangle& t) {
  return (vec(mesh.positions[t[0]]) + vec(mesh.positions[t[1]]) + vec(mesh.positions[t[2]])) / 3;
}

DefectExample Validator::face_example(std::uint32_t face) const {
  DefectExample example;
  example.faces[0] = surface_.face_of[face];
  example.position = position(centroid(surface_.mesh, surface_.mesh.triangles[face]));
  return example;
}

DefectExample Validator::pair_example(const std::array<std::uint32_t, 2>& faces) const {
  DefectExample example = face_example(faces[0]);
  example.faces[1] = surface_.face_of[faces[1]];
  if (example.faces[0] > example.faces[1]) std::swap(example.faces[0], example.faces[1]);
  return example;
}

DefectExample Validator::edge_example(std::uint32_t halfedge) const {
  const std::uint32_t a = surface_.mesh.triangles[halfedge / 3][halfedge % 3];
  const std::uint32_t b = surface_.mesh.triangles[halfedge / 3][next_halfedge(halfedge) % 3];
  DefectExample example;
  example.faces[0] = surface_.face_of[halfedge / 3];
  example.vertices = {surface_.vertex_of[a], surface_.vertex_of[b]};
  example.position = position(0.5 * vec(surface_.mesh.positions[a]) + 0.5 * vec(surface_.mesh.positions[b]));
  return example;
}

DefectExample Validator::vertex_example(std::uint32_t vertex) const {
  DefectExample example;
  example.vertices[0] = surface_.vertex_of[vertex];
  example.position = surface_.mesh.positions[vertex];
  return example;
}

// ------------------------------------------------------------------------------------ checks

// Faces that name vertices as they should make up surface_. Returns whether the other checks make sense.
bool Validator::check_faces() {
  const auto& triangles = mesh_.triangles;
  out_.validation.vertices = mesh_.positions.size();
  out_.validation.faces = triangles.size();
  if (triangles.empty()) report(DefectKind::no_faces, 1, {});
  if (triangles.size() > max_faces || mesh_.positions.size() >= none) report(DefectKind::too_large, 1, {});
  if (!out_.validation.valid()) return false;

  std::vector<std::uint32_t> out_of_range;
  std::vector<std::uint32_t> repeated;
  std::vector<std::uint32_t> proper;
  proper.reserve(triangles.size());
  for (std::uint32_t f = 0; f < triangles.size(); ++f) {
    const Triangle& t = triangles[f];
    if (*std::max_element(t.begin(), t.end()) >= mesh_.positions.size())
      out_of_range.push_back(f);
    else if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
      repeated.push_back(f);
    else
      proper.push_back(f);
  }
  take_faces(std::move(proper));
  out_.validation.unreferenced_vertices = mesh_.positions.size() - surface_.vertex_of.size();

  report_all(DefectKind::index_out_of_range, out_of_range, [&](std::uint32_t f) {
    const auto bad = std::find_if(triangles[f].begin(), triangles[f].end(),
                                  [&](std::uint32_t v) { return v >= mesh_.positions.size(); });
    DefectExample example;
    example.faces[0] = f;
    example.vertices[0] = *bad;
    return example;
  });
  report_all(DefectKind::repeated_vertex, repeated, [&](std::uint32_t f) {
    const Triangle& t = triangles[f];
    DefectExample example;
    example.faces[0] = f;
    example.vertices[0] = t[0] == t[1] ? t[0] : t[2];
    example.position = mesh_.positions[example.vertices[0]];
    return example;
  });
  return out_of_range.empty() && !surface_.mesh.triangles.empty();
}

// Frame of the corners of the faces; none if a coordinate is beyond what double precision can carry.
std::optional<UnitFrame> frame_of_faces(const Mesh& mesh, std::span<const std::uint32_t> faces) {
  if (faces.empty()) return std::nullopt;
  std::array<Position, 2> corners{mesh.positions[mesh.triangles[faces[0]][0]]};
  auto& [lower, upper] = corners;
  upper = lower;
  for (const std::uint32_t f : faces) {
    for (const std::uint32_t v : mesh.triangles[f]) {
      const Position& p = mesh.positions[v];
      if (!within_limits(p)) return std::nullopt;
      for (int k = 0; k < 3; ++k) {
        lower[k] = std::min(lower[k], p[k]);
        upper[k] = std::max(upper[k], p[k]);
      }
    }
  }
  return unit_frame(corners);
}

// Along the curve, all stages to come find what is near in space near in memory. Coordinates that have no place on it
// are about to be reported.
void Validator::take_faces(std::vector<std::uint32_t> faces) {
  const auto& positions = mesh_.positions;
  const auto frame = order_ == FaceOrder::along_curve ? frame_of_faces(mesh_, faces) : std::nullopt;
  if (frame) {
    std::vector<Box> boxes(faces.size());
    parallel_each(faces.size(), default_grain, [&](std::size_t i) {
      const Triangle& t = mesh_.triangles[faces[i]];
      boxes[i] = bounding_box(*frame, {positions[t[0]].data(), positions[t[1]].data(), positions[t[2]].data()});
    });
    std::vector<std::uint32_t> order = along_curve(boxes);
    for (std::uint32_t& f : order) f = faces[f];
    faces = std::move(order);
  }
  surface_ = arrange_faces(positions, mesh_.triangles, std::move(faces));
}

void Validator::check_connectivity() {
  const std::vector<Triangle>& triangles = surface_.mesh.triangles;
  const std::size_t vertex_count = surface_.mesh.positions.size();
  const EdgeGroups edges = group_edges(triangles, vertex_count);
  EdgeDefects defects;
  std::vector<std::uint32_t> split_vertices;
  tbb::parallel_invoke([&] { twin_ = pair_halfedges(triangles, edges, defects); },
                       [&] { out_.valid.components = face_components(triangles.size(), edges); },
                       [&] { split_vertices = non_manifold_vertices(triangles, vertex_count, edges); },
                       [&] { duplicates_ = duplicate_faces(triangles, edges); });
  out_.validation.components = out_.valid.components.count();
  out_.validation.euler_characteristic = static_cast<long long>(vertex_count) - static_cast<long long>(edges.size()) +
                                         static_cast<long long>(triangles.size());

  const auto edge = [&](std::uint32_t h) { return edge_example(h); };
  report_all(DefectKind::boundary_edge, defects.boundary, edge);
  report_all(DefectKind::non_manifold_edge, defects.non_manifold, edge);
  report_all(DefectKind::inconsistent_edge, defects.inconsistent, edge);
  report_all(DefectKind::non_manifold_vertex, split_vertices, [&](std::uint32_t v) { return vertex_example(v); });
  report_all(DefectKind::duplicate_face, duplicates_,
             [&](const std::array<std::uint32_t, 2>& faces) { return pair_example(faces); });
}

// Finite, and of a size that double precision can carry.
bool Validator::check_coordinates() {
  const std::vector<Position>& positions = surface_.mesh.positions;
  std::vector<std::uint32_t> not_finite;
  std::vector<std::uint32_t> too_large;
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    if (within_limits(positions[v])) continue;
    const bool finite =
        std::all_of(positions[v].begin(), positions[v].end(), [](double x) { return std::isfinite(x); });
    (finite ? too_large : not_finite).push_back(v);
  }
  const auto example = [&](std::uint32_t v) { return vertex_example(v); };
  report_all(DefectKind::not_finite, not_finite, example);
  report_all(DefectKind::too_large, too_large, example);
  if (!not_finite.empty() || !too_large.empty()) return false;

  out_.validation.diagonal = extent(positions).diagonal();
  if (out_.validation.diagonal >= smallest_diagonal) return true;
  report(DefectKind::too_large, 1, {vertex_example(0)});
  return false;
}

bool Validator::is_closed_manifold() const {
  return std::none_of(out_.validation.defects.begin(), out_.validation.defects.end(), [](const Defect& d) {
    return d.kind == DefectKind::boundary_edge || d.kind == DefectKind::non_manifold_edge ||
           d.kind == DefectKind::inconsistent_edge || d.kind == DefectKind::non_manifold_vertex ||
           d.kind == DefectKind::duplicate_face;
  });
}

void Validator::check_geometry() {
  const auto& positions = surface_.mesh.positions;
  const auto& triangles = surface_.mesh.triangles;
  Measures measures;
  std::vector<std::uint32_t> degenerate;
  tbb::parallel_invoke([&] { measures = measure(positions, triangles); },
                       [&] { out_.validation.duplicate_vertices = count_duplicate_positions(positions); },
                       [&] { degenerate = degenerate_faces(positions, triangles); });
  out_.validation.area = measures.area;
  out_.validation.volume = measures.volume;
  out_.validation.degenerate_faces = degenerate.size();
  const bool closed_manifold = is_closed_manifold();
  if (closed_manifold && !degenerate.empty()) {
    degenerate = repair(std::move(degenerate));
    report_all(DefectKind::degenerate_face, degenerate, [&](std::uint32_t f) { return face_example(f); });
  }
  const bool self_intersecting = check_self_intersections(degenerate);
  if (closed_manifold && degenerate.empty()) check_orientation(self_intersecting);
}

// Replaces surface_ by its repaired form; returns the degenerate faces that are left.
std::vector<std::uint32_t> Validator::repair(std::vector<std::uint32_t> degenerate) {
  Repair repaired = remove_degenerate_faces(surface_.mesh, std::move(twin_), std::move(degenerate));
  for (std::uint32_t& f : repaired.surface.face_of) f = surface_.face_of[f];
  for (std::uint32_t& v : repaired.surface.vertex_of) v = surface_.vertex_of[v];
  surface_ = std::move(repaired.surface);
  const auto& triangles = surface_.mesh.triangles;
  const EdgeGroups edges = group_edges(triangles, surface_.mesh.positions.size());
  EdgeDefects defects;
  twin_ = pair_halfedges(triangles, edges, defects);
  out_.valid.components = face_components(triangles.size(), edges);
  return std::move(repaired.degenerate);
}

// Zero-area faces and repetitions of faces are left out: they have been reported as what they are.
bool Validator::check_self_intersections(const std::vector<std::uint32_t>& degenerate) {
  const auto& positions = surface_.mesh.positions;
  const auto& triangles = surface_.mesh.triangles;
  std::vector<std::uint8_t> keep;
  if (!degenerate.empty() || !duplicates_.empty()) keep.assign(triangles.size(), 1);
  for (const std::uint32_t f : degenerate) keep[f] = 0;
  for (const auto& pair : duplicates_) keep[pair[1]] = 0;

  out_.valid.tree.build(unit_frame(positions), positions, triangles, keep);
  std::vector<std::uint8_t> embedded;
  if (is_closed_manifold()) embedded = embedded_stars(positions, triangles, twin_);
  const FacePairs found = self_intersections(out_.valid.tree, max_examples, embedded);
  if (found.count == 0) return false;
  std::vector<DefectExample> examples;
  for (const auto& pair : found.pairs) examples.push_back(pair_example(pair));
  report(DefectKind::self_intersection, found.count, std::move(examples));
  return true;
}

// Outward components in the open, inward ones within a single outward one; or all of it the other way round. Where
// components may intersect, only a mesh that is wholly inside out is recognised.
void Validator::check_orientation(bool self_intersecting) {
  const Components& components = out_.valid.components;
  if (self_intersecting) {
    const auto signs = volume_signs(out_.valid.tree, components);
    if (std::all_of(signs.begin(), signs.end(), [](int sign) { return sign < 0; }))
      report(DefectKind::inside_out, 1, {face_example(0)});
    return;
  }
  auto nest = nesting(device_, out_.valid.tree, components);
  const auto legal = [](const Nesting& n) { return n.bounds_solid(); };
  const auto legal_if_turned = [](const Nesting& n) { return n.turned().bounds_solid(); };
  if (!std::all_of(nest.begin(), nest.end(), legal) && std::all_of(nest.begin(), nest.end(), legal_if_turned)) {
    if (!accept_inside_out_) {
      report(DefectKind::inside_out, 1, {face_example(0)});
      return;
    }
    turn_round();
    for (Nesting& n : nest) n = n.turned();
  }
  const auto cavity = [](const Nesting& n) { return n.is_cavity(); };
  out_.validation.cavities = static_cast<std::size_t>(std::count_if(nest.begin(), nest.end(), cavity));
  std::vector<std::uint32_t> first_faces;
  for (std::size_t c = 0; c < nest.size(); ++c)
    if (!nest[c].bounds_solid()) first_faces.push_back(components[c].front());
  report_all(DefectKind::nested_orientation, first_faces, [&](std::uint32_t f) { return face_example(f); });
}

void Validator::turn_round() {
  for (Triangle& t : surface_.mesh.triangles) std::swap(t[1], t[2]);
  out_.validation.volume = -out_.validation.volume;
  out_.valid.turned = true;
}

}  // namespace

bool within_limits(const Position& p) {
  return std::all_of(p.begin(), p.end(), [](double x) { return std::abs(x) <= largest_coordinate; });  // NaN is not
}

std::vector<std::uint32_t> degenerate_faces(std::span<const Position> positions, std::span<const Triangle> triangles) {
  return parallel_gather<std::uint32_t>(
      triangles.size(), std::size_t{1} << 14, [&](std::size_t begin, std::size_t end, std::vector<std::uint32_t>& out) {
        for (std::size_t f = begin; f < end; ++f) {
          const Triangle& t = triangles[f];
          if (exact::collinear(positions[t[0]].data(), positions[t[1]].data(), positions[t[2]].data()))
            out.push_back(static_cast<std::uint32_t>(f));
        }
      });
}

CheckedMesh validate_mesh(const Mesh& mesh, const TreeDevice& device, bool accept_inside_out) {
  CheckedMesh checked = Validator(mesh, device, accept_inside_out, FaceOrder::along_curve).run();
  if (checked.validation.valid()) return checked;
  // Once more for the sake of the report, whose examples are the first ones in the file.
  return Validator(mesh, device, accept_inside_out, FaceOrder::as_given).run();
}

Validation validate(const MeshView& input, int threads) {
  Validation validation;
  Arena(threads).run([&] {
    const TreeDevice device;
    validation = validate_mesh(to_mesh(input), device).validation;
  });
  return validation;
}

}  // namespace prcage
