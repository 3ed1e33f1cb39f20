// The certificate of a cage: every claim checked from scratch, with exact predicates on the coordinates as they are.
// Must be called inside an Arena.
//
// Winding numbers w_C of the cage and w_M of the input decide enclosure:
//   - no face of the cage touches a face of the input, so that w_C is constant on each component of the input and w_M
//     on each of the cage;
//   - w_C = 1 at every component of the input: it is inside;
//   - w_M = 0 at every component of the cage: no part of the cage sits in the input's solid;
//   - w_C is 0 and 1 on the two sides of every component of the cage: the cage bounds a volume.
// Where only triangles are to be enclosed and they are not closed, there is no w_M: the three other conditions say that
// each of them is inside.
#pragma once

#include <vector>

#include "core/surface.h"
#include "parallel/intersections.h"
#include "parallel/validate.h"

namespace prcage {

// Can the questions of the certificate be asked at all: are there faces, do they name three existing vertices each, are
// these finite and within the limits? On success `used` is the mesh without unreferenced vertices.
bool well_formed(const Mesh& mesh, SubMesh& used);

// What a cage is certified against. Borrows the tree.
struct Enclosed {
  const SurfaceTree* surface = nullptr;
  bool closed = false;  // and oriented: winding numbers exist
  std::size_t components = 0;
  long long euler_characteristic = 0;
  std::vector<Position> component_points;  // a vertex of each component
  bool solid = true;                       // if not, only its triangles must be enclosed, and it need not be closed
};

// The input that validate_mesh() found valid.
Enclosed enclosed(const CheckedMesh& input);

Certificate certify_cage(const TreeDevice& device, const Enclosed& input, const Mesh& cage);

// What a simplified surface is certified against.
struct Simplified {
  UnitFrame frame;  // of the surface
  std::size_t components = 0;
  std::size_t cavities = 0;
  long long euler_characteristic = 0;
};

SurfaceCertificate certify_simplified(const TreeDevice& device, const Simplified& input, const Mesh& surface);

// Behind certify(): against any input, legal or not.
Certificate certify_meshes(const Mesh& input, const Mesh& cage);

}  // namespace prcage
