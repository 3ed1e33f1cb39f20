#include "parallel/soup.h"

#include <algorithm>

#include "core/adjacency.h"
#include "parallel/winding.h"

namespace prcage {
namespace {

// Faces whose corners are vertices at finite positions.
std::vector<std::uint32_t> placed_faces(const Mesh& mesh, DroppedFaces& dropped) {
  const auto& positions = mesh.positions;
  std::vector<std::uint32_t> placed;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    const Triangle& t = mesh.triangles[f];
    if (!std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return v < positions.size(); }))
      ++dropped.index_out_of_range;
    else if (!std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return within_limits(positions[v]); }))
      ++dropped.not_finite;
    else
      placed.push_back(f);
  }
  return placed;
}

}  // namespace

std::string usable_faces(const Mesh& mesh, Mesh& faces, DroppedFaces& dropped) {
  if (mesh.triangles.size() > max_faces || mesh.positions.size() >= none) return "the input has too many faces";
  const Mesh placed = arrange_faces(mesh.positions, mesh.triangles, placed_faces(mesh, dropped)).mesh;
  std::vector<std::uint8_t> keep(placed.triangles.size(), 1);
  for (const std::uint32_t f : degenerate_faces(placed.positions, placed.triangles)) keep[f] = 0;
  dropped.no_area = static_cast<std::size_t>(std::count(keep.begin(), keep.end(), std::uint8_t{0}));
  if (dropped.total() == mesh.triangles.size()) return "the input has no face with an area and finite coordinates";
  faces = select_faces(placed.positions, placed.triangles, keep).mesh;
  if (extent(faces.positions).diagonal() < smallest_diagonal) return "the input is too small for double precision";
  return {};
}

Soup make_soup(Mesh faces, const TreeDevice& device) {
  Soup soup(device);
  soup.faces = std::move(faces);
  const auto& positions = soup.faces.positions;
  const auto& triangles = soup.faces.triangles;
  const EdgeGroups edges = group_edges(triangles, positions.size());
  EdgeDefects defects;
  pair_halfedges(triangles, edges, defects);
  soup.closed = defects.empty();
  soup.components = face_components(triangles.size(), edges);
  soup.tree.build(unit_frame(positions), positions, triangles);
  return soup;
}

Enclosed enclosed(const Soup& soup, std::size_t components, long long euler_characteristic) {
  return {&soup.tree,
          soup.closed,
          components,
          euler_characteristic,
          component_points(soup.faces.positions, soup.faces.triangles, soup.components),
          false};
}

}  // namespace prcage
