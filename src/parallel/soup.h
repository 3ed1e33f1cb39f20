// Triangles of any kind: open, intersecting, doubled, without orientation. What a cage can enclose of them, and what it
// is certified against. Must be called inside an Arena.
#pragma once

#include <string>

#include "core/surface.h"
#include "parallel/certify.h"
#include "parallel/intersections.h"

namespace prcage {

// Selects the faces that have an area and a place; the others are counted in `dropped`, each as the first kind that it
// is of. Returns why there is nothing to work with, a clause for people, or nothing.
std::string usable_faces(const Mesh& mesh, Mesh& faces, DroppedFaces& dropped);

// Movable: `tree` borrows arrays of `faces` that a move leaves where they are.
struct Soup {
  Mesh faces;
  Components components;  // of faces that share edges
  bool closed = false;    // and oriented
  SurfaceTree tree;

  explicit Soup(const TreeDevice& device) : tree(device) {}
};

// Of faces that usable_faces() selected.
Soup make_soup(Mesh faces, const TreeDevice& device);

// The triangles of the soup, in a cage that must have the topology of a wrap.
Enclosed enclosed(const Soup& soup, std::size_t components, long long euler_characteristic);

}  // namespace prcage
