// Measures of a mesh that need no validity: what `prcage info` prints of any file that can be read.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/prcage.h"

namespace prcage {

struct ValueRange {
  double min = 0;
  double mean = 0;
  double max = 0;
};

// Of the usable faces: those with indices in range and finite coordinates. Lengths in the unit of the file, angles in
// degrees. All zero if there is no usable face.
struct MeshMeasures {
  std::size_t vertices = 0;  // as given
  std::size_t faces = 0;     // as given
  std::size_t usable_faces = 0;
  std::size_t referenced_vertices = 0;  // by usable faces
  std::array<double, 3> lower{};        // bounding box of the referenced vertices
  std::array<double, 3> upper{};
  double diagonal = 0;  // l
  double area = 0;
  double volume = 0;           // signed; means something for closed meshes only
  std::size_t components = 0;  // of faces connected through vertices
  std::size_t edges = 0;
  std::size_t boundary_edges = 0;      // with one face
  std::size_t non_manifold_edges = 0;  // with more than two
  long long euler_characteristic = 0;
  ValueRange edge_length;     // over the edges
  ValueRange smallest_angle;  // over the faces, of each its smallest angle
  double largest_angle = 0;
};

MeshMeasures measure(const Mesh& mesh);

// Faces with indices in range and finite coordinates.
std::size_t count_usable_faces(const Mesh& mesh);

// Edges with one face only.
std::size_t count_boundary_edges(const Mesh& mesh);

}  // namespace prcage
