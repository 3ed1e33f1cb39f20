// CGAL's surface meshes in the contenders: simplification to a number of faces, and the way back to ours.
#pragma once

#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/prcage.h"

namespace prcage::perf {

// CGAL's defaults (Lindstrom and Turk). The predicate stops at fewer edges than it is told; a closed surface has 3 for
// every 2 faces.
template <class Surface>
void simplify(Surface& surface, std::size_t faces) {
  namespace simplification = CGAL::Surface_mesh_simplification;
  simplification::edge_collapse(surface, simplification::Count_stop_predicate<Surface>(faces / 2 * 3 + 1));
}

template <class Surface>
Mesh to_mesh(Surface& surface) {
  surface.collect_garbage();
  Mesh mesh;
  for (const auto v : surface.vertices()) {
    const auto& p = surface.point(v);
    mesh.positions.push_back({p.x(), p.y(), p.z()});
  }
  for (const auto f : surface.faces()) {
    std::array<std::uint32_t, 3> t{};
    std::size_t i = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(f))) t[i++] = static_cast<std::uint32_t>(v.idx());
    mesh.triangles.push_back(t);
  }
  return mesh;
}

}  // namespace prcage::perf
