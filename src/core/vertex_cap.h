// Singular vertices (paper sec. 3.4, "Handling Singularities"): those whose face normals leave no direction to move in,
// e.g. where two sheets turn their backs to each other.
//
// The vertex is cut off: a ring of points on its edges, all at the same small distance, replaces it, and the polygon of
// the ring is closed by a cap of triangles. Seen from the vertex the ring is a polygon on a sphere around the part of
// space outside the solid, and the cap is a triangulation of that polygon; a flat triangle of ring points lies in the
// cone over its spherical triangle, hence outside. Ears are cut, with exact predicates instead of the stereographic
// projection and Delaunay triangulation of the paper, until the vertex is regular with respect to what is left of the
// polygon (it then stays as the centre of a smaller fan) or nothing is left. Each ring point only has two faces of the
// input to clear.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/corner_table.h"

namespace prcage {

struct VertexCap {
  std::vector<std::uint32_t> fan;                       // halfedges that leave the vertex, counterclockwise
  std::vector<std::array<std::uint32_t, 3>> triangles;  // positions in the fan; fan.size() is the centre
  bool keeps_centre = false;
  Vec3 centre_direction = Vec3::Zero();  // clears all triangles at the centre

  bool empty() const { return triangles.empty(); }
};

// Empty if no ear can be cut and the vertex is still singular.
VertexCap plan_cap(const CornerTable& mesh, std::uint32_t vertex);

// Cuts the vertex off at `radius`, less than the length of its edges. The vertex becomes the centre if the cap keeps
// it, else ring point 0; the other ring points are new vertices. Returns the ring in the order of the fan.
std::vector<std::uint32_t> cap_vertex(CornerTable& mesh, const VertexCap& cap, double radius);

}  // namespace prcage
