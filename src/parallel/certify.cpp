#include "parallel/certify.h"

#include <algorithm>

#include "core/mesh_view.h"
#include "parallel/arena.h"
#include "parallel/soup.h"
#include "parallel/winding.h"

namespace prcage {
namespace {

bool names_vertices(const Mesh& mesh, const Triangle& t) {
  return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return v < mesh.positions.size(); }) && t[0] != t[1] &&
         t[1] != t[2] && t[2] != t[0];
}

struct Topology {
  EdgeGroups edges;
  EdgeDefects defects;
  Components components;
  long long euler_characteristic = 0;
};

Topology topology(const Mesh& mesh) {
  Topology t;
  t.edges = group_edges(mesh.triangles, mesh.positions.size());
  pair_halfedges(mesh.triangles, t.edges, t.defects);
  t.components = face_components(mesh.triangles.size(), t.edges);
  t.euler_characteristic = static_cast<long long>(mesh.positions.size()) - static_cast<long long>(t.edges.size()) +
                           static_cast<long long>(mesh.triangles.size());
  return t;
}

// Pairs of intersecting faces; a zero-area face counts as one pair with itself and is left out otherwise.
std::size_t count_self_intersections(const TreeDevice& device, const SurfaceTree& cage,
                                     const std::vector<std::uint32_t>& degenerate) {
  if (degenerate.empty()) return self_intersections(cage, 0).count;
  std::vector<std::uint8_t> keep(cage.triangles().size(), 1);
  for (const std::uint32_t f : degenerate) keep[f] = 0;
  SurfaceTree proper(device);
  proper.build(cage.frame(), cage.positions(), cage.triangles(), keep);
  return degenerate.size() + self_intersections(proper, 0).count;
}

bool all_wind(const std::vector<Winding>& windings, int number) {
  return std::all_of(windings.begin(), windings.end(),
                     [number](const Winding& w) { return w.known && w.number == number; });
}

// What the certificates of cages and of simplified surfaces have in common. `tree` is over the surface.
template <class AnyCertificate, class Input>
void certify_embedding(const TreeDevice& device, const SurfaceTree& tree, const Topology& t, const Input& input,
                       AnyCertificate& certificate) {
  const auto positions = tree.positions();
  const auto triangles = tree.triangles();
  certificate.closed = t.defects.boundary.empty();
  certificate.oriented = t.defects.inconsistent.empty();
  certificate.manifold =
      t.defects.non_manifold.empty() && non_manifold_vertices(triangles, positions.size(), t.edges).empty();
  certificate.components = t.components.count();
  certificate.euler_characteristic = t.euler_characteristic;
  certificate.component_count_equal = t.components.count() == input.components;
  certificate.euler_characteristic_equal = t.euler_characteristic == input.euler_characteristic;
  const auto degenerate = degenerate_faces(positions, triangles);
  certificate.no_degenerate_face = degenerate.empty();
  certificate.self_intersections = count_self_intersections(device, tree, degenerate);
  certificate.self_intersection_free = certificate.self_intersections == 0;
}

std::size_t count_cavities(const std::vector<Nesting>& nest) {
  return static_cast<std::size_t>(
      std::count_if(nest.begin(), nest.end(), [](const Nesting& n) { return n.is_cavity(); }));
}

// The last three conditions of the header; the first, no contact, is the caller's.
bool encloses(const TreeDevice& device, const Enclosed& input, const SurfaceTree& cage, const Components& components) {
  if (input.solid && !input.closed) return false;
  const auto cage_points = component_points(cage.positions(), cage.triangles(), components);
  const auto nest = nesting(device, cage, components);
  return all_wind(winding_numbers(device, cage, input.component_points), 1) &&
         (!input.closed || all_wind(winding_numbers(device, *input.surface, cage_points), 0)) &&
         std::all_of(nest.begin(), nest.end(), [](const Nesting& n) { return n.bounds_solid(); });
}

}  // namespace

bool well_formed(const Mesh& mesh, SubMesh& used) {
  if (mesh.triangles.empty()) return false;
  for (const Triangle& t : mesh.triangles)
    if (!names_vertices(mesh, t)) return false;
  used = select_faces(mesh.positions, mesh.triangles);
  return std::all_of(used.mesh.positions.begin(), used.mesh.positions.end(), within_limits) &&
         extent(used.mesh.positions).diagonal() >= smallest_diagonal;
}

Enclosed enclosed(const CheckedMesh& input) {
  const SubMesh& surface = input.valid.surface;
  return {&input.valid.tree, true, input.validation.components, input.validation.euler_characteristic,
          component_points(surface.mesh.positions, surface.mesh.triangles, input.valid.components)};
}

Certificate certify_cage(const TreeDevice& device, const Enclosed& input, const Mesh& cage) {
  Certificate certificate;
  SubMesh used;
  if (!well_formed(cage, used)) return certificate;
  const auto& positions = used.mesh.positions;
  const auto& triangles = used.mesh.triangles;

  const Topology t = topology(used.mesh);
  SurfaceTree surface(device);
  surface.build(input.surface->frame(), positions, triangles);
  certify_embedding(device, surface, t, input, certificate);
  certificate.contacts = contacts(surface, *input.surface, 0).count;
  certificate.no_contact = certificate.contacts == 0;
  certificate.encloses = t.defects.empty() && certificate.no_contact && encloses(device, input, surface, t.components);
  return certificate;
}

SurfaceCertificate certify_simplified(const TreeDevice& device, const Simplified& input, const Mesh& surface) {
  SurfaceCertificate certificate;
  SubMesh used;
  if (!well_formed(surface, used)) return certificate;
  const Topology t = topology(used.mesh);
  SurfaceTree tree(device);
  tree.build(input.frame, used.mesh.positions, used.mesh.triangles);
  certify_embedding(device, tree, t, input, certificate);
  if (!t.defects.empty() || !certificate.self_intersection_free) return certificate;
  const auto nest = nesting(device, tree, t.components);
  certificate.bounds_solid = std::all_of(nest.begin(), nest.end(), [](const Nesting& n) { return n.bounds_solid(); });
  certificate.cavities = count_cavities(nest);
  certificate.cavity_count_equal = certificate.cavities == input.cavities;
  return certificate;
}

Certificate certify_meshes(const Mesh& input, const Mesh& cage) {
  SubMesh used;
  if (!well_formed(input, used)) return {};
  const auto& positions = used.mesh.positions;
  const auto& triangles = used.mesh.triangles;
  const TreeDevice device;
  SurfaceTree surface(device);
  surface.build(unit_frame(positions), positions, triangles);
  const Topology t = topology(used.mesh);
  return certify_cage(device,
                      {&surface, t.defects.empty(), t.components.count(), t.euler_characteristic,
                       component_points(positions, triangles, t.components)},
                      cage);
}

namespace {

Certificate certify_around_triangles(const Mesh& input, const Mesh& wrap, const Mesh& cage) {
  SubMesh used_wrap;
  Mesh faces;
  DroppedFaces dropped;
  if (!well_formed(wrap, used_wrap) || !usable_faces(input, faces, dropped).empty()) return {};
  const TreeDevice device;
  const Topology t = topology(used_wrap.mesh);
  const Soup soup = make_soup(std::move(faces), device);
  return certify_cage(device, enclosed(soup, t.components.count(), t.euler_characteristic), cage);
}

}  // namespace

namespace {

// The frame holds the surface, too: boxes beyond the frame of the input would lose precision.
SurfaceCertificate certify_simplified_meshes(const Mesh& input, const Mesh& surface) {
  SubMesh used;
  if (!well_formed(input, used)) return {};
  const TreeDevice device;
  SurfaceTree tree(device);
  tree.build(unit_frame(used.mesh.positions), used.mesh.positions, used.mesh.triangles);
  const Topology t = topology(used.mesh);
  const std::size_t cavities = t.defects.empty() ? count_cavities(nesting(device, tree, t.components)) : 0;
  return certify_simplified(device, {tree.frame(), t.components.count(), cavities, t.euler_characteristic}, surface);
}

}  // namespace

SurfaceCertificate certify_surface(const MeshView& input, const MeshView& surface, int threads) {
  SurfaceCertificate certificate;
  Arena(threads).run([&] { certificate = certify_simplified_meshes(to_mesh(input), to_mesh(surface)); });
  return certificate;
}

Certificate certify_around(const MeshView& input, const MeshView& wrap, const MeshView& cage, int threads) {
  Certificate certificate;
  Arena(threads).run([&] { certificate = certify_around_triangles(to_mesh(input), to_mesh(wrap), to_mesh(cage)); });
  return certificate;
}

Certificate certify(const MeshView& input, const MeshView& cage, int threads) {
  Certificate certificate;
  Arena(threads).run([&] { certificate = certify_meshes(to_mesh(input), to_mesh(cage)); });
  return certificate;
}

}  // namespace prcage
