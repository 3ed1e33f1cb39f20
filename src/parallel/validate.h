// Is a mesh a legal input, and if so, the surface that the run works on with the data that were computed on the way.
// Must be called inside an Arena.
#pragma once

#include "core/surface.h"
#include "parallel/intersections.h"

namespace prcage {

// A closed oriented manifold without zero-area faces, free of self-intersections, that bounds a volume.
// Movable: `tree` borrows arrays of `surface` that a move leaves where they are.
struct ValidSurface {
  SubMesh surface;  // numbers of the mesh as given; faces cut anew by the repair of zero-area faces keep their numbers
  Components components;
  SurfaceTree tree;
  bool turned = false;  // all faces were turned round, see below

  explicit ValidSurface(const TreeDevice& device) : tree(device) {}
};

struct CheckedMesh {
  Validation validation;
  ValidSurface valid;  // meaningful only if validation.valid()
};

// With accept_inside_out, a mesh whose only defect is that it is inside out is turned round and is valid.
CheckedMesh validate_mesh(const Mesh& mesh, const TreeDevice& device, bool accept_inside_out = false);

// Zero-area faces, ascending, exact. Coordinates must be finite.
std::vector<std::uint32_t> degenerate_faces(std::span<const Position> positions, std::span<const Triangle> triangles);

// Are all coordinates finite and of a size that the engine can carry (core/surface.h)?
bool within_limits(const Position& p);

}  // namespace prcage
