// What can be said of a triangle mesh as a surface from its plain arrays, whether it is a manifold or not: components,
// fans of faces round vertices, Euler characteristic, duplicates, measures. Linear time or nearly so; no threads.
//
// Vertex indices must be in range and distinct within a face unless a function says otherwise.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/adjacency.h"
#include "core/vec3.h"

namespace prcage {

// Coordinates that every computation of the engine can carry in double precision: fourth powers of lengths up to the
// diagonal neither overflow nor lose their last bits to underflow, so that error bounds relative to magnitudes hold.
// The exact predicates, filters and all, are exact well beyond this.
inline constexpr double largest_coordinate = 1e15;
inline constexpr double smallest_diagonal = 1e-60;

// A selection of a mesh's faces with only the vertices that they use.
struct SubMesh {
  Mesh mesh;
  std::vector<std::uint32_t> vertex_of;  // vertex of `mesh` -> vertex of the whole
  std::vector<std::uint32_t> face_of;    // face of `mesh` -> face of the whole
};

// Faces with keep[f] != 0, all if `keep` is empty; faces and vertices in their old order. Indices of the faces that are
// kept must be in range.
SubMesh select_faces(std::span<const Position> positions, std::span<const Triangle> triangles,
                     std::span<const std::uint8_t> keep = {});
// The listed faces in the order of the list, vertices in the order in which these use them.
SubMesh arrange_faces(std::span<const Position> positions, std::span<const Triangle> triangles,
                      std::vector<std::uint32_t> faces);

// Connected components of the faces: two faces are connected if they share an edge. Numbered in order of their first
// faces; the faces of component c are faces[offsets[c]] .. faces[offsets[c + 1] - 1], ascending.
struct Components {
  std::vector<std::uint32_t> of_face;
  std::vector<std::uint32_t> faces;
  std::vector<std::uint32_t> offsets;

  std::size_t count() const { return offsets.size() - 1; }
  std::span<const std::uint32_t> operator[](std::size_t c) const {
    return {faces.data() + offsets[c], faces.data() + offsets[c + 1]};
  }
};

Components face_components(std::size_t face_count, const EdgeGroups& edges);

// Vertices whose faces are not connected with each other across edges at the vertex, ascending. A non-manifold edge
// alone does not make its ends non-manifold vertices.
std::vector<std::uint32_t> non_manifold_vertices(std::span<const Triangle> triangles, std::size_t vertex_count,
                                                 const EdgeGroups& edges);

// Pairs of faces on the same three vertices, {earlier, later}, in order of the later: each face that repeats an
// earlier one comes once.
std::vector<std::array<std::uint32_t, 2>> duplicate_faces(std::span<const Triangle> triangles, const EdgeGroups& edges);

// Vertices at the position of a vertex before them; -0 equals 0. Coordinates must not be NaN.
std::size_t count_duplicate_positions(std::span<const Position> positions);

struct Extent {
  Vec3 lower = Vec3::Zero();
  Vec3 upper = Vec3::Zero();
  double diagonal() const;
};

Extent extent(std::span<const Position> positions);

struct Measures {
  double area = 0;
  double volume = 0;  // signed: positive if the faces look outward
};

Measures measure(std::span<const Position> positions, std::span<const Triangle> triangles);

}  // namespace prcage
