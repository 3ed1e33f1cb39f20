// Exact removal of zero-area faces, as CAD programs and welding leave them. Neither the point set of the surface nor
// the volume it bounds changes by a single bit, only how they are cut into triangles:
//
//   cap     one corner lies strictly inside the opposite edge. That edge is flipped: the two new faces tile the
//           neighbour across it exactly.
//   needle  two corners are at the same position. The edge between them is collapsed if the link condition holds.
//
// Connectivity stays closed, manifold and oriented, the Euler characteristic and the components stay as they are.
#pragma once

#include <cstdint>
#include <vector>

#include "core/surface.h"

namespace prcage {

struct Repair {
  SubMesh surface;                        // repaired, with vertices in use only; a flipped face keeps its number
  std::vector<std::uint32_t> degenerate;  // faces of `surface` that could not be removed, ascending
  std::size_t flips = 0;                  // edges flipped
  std::size_t collapses = 0;              // edges of length zero collapsed, two faces each
};

// `twin` pairs the halfedges of `mesh`, which must be a closed oriented manifold (see adjacency.h), `degenerate` lists
// its zero-area faces in ascending order. The faces that are left keep their order. Coordinates of vertices in use
// must be finite.
Repair remove_degenerate_faces(const Mesh& mesh, std::vector<std::uint32_t> twin,
                               std::vector<std::uint32_t> degenerate);

}  // namespace prcage
