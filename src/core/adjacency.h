// Which faces share which edges: twins of halfedges, found in linear time, and what is wrong where a surface is not
// a closed oriented manifold.
//
// Halfedge h = 3 f + i runs from corner i of face f to the next corner.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec3.h"

namespace prcage {

inline constexpr std::uint32_t none = 0xffffffffu;
inline constexpr std::size_t max_faces = none / 3;  // halfedges have 32-bit numbers

inline std::uint32_t next_halfedge(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
inline std::uint32_t previous_halfedge(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

// The edges of a surface with the halfedges on each: halfedges[offsets[e]] .. halfedges[offsets[e + 1] - 1], ascending.
// Edges are in ascending order of their smaller vertex, then of the larger.
struct EdgeGroups {
  std::vector<std::uint32_t> halfedges;
  std::vector<std::uint32_t> offsets;

  std::size_t size() const { return offsets.size() - 1; }
  std::span<const std::uint32_t> operator[](std::size_t e) const {
    return {halfedges.data() + offsets[e], halfedges.data() + offsets[e + 1]};
  }
};

// Vertex indices must be in range and distinct within a face; no more than 2^32 / 3 faces.
EdgeGroups group_edges(std::span<const Triangle> triangles, std::size_t vertex_count);

// Halfedges at fault, one per edge (the lowest), ascending.
struct EdgeDefects {
  std::vector<std::uint32_t> boundary;      // no other halfedge on the edge
  std::vector<std::uint32_t> non_manifold;  // more than two
  std::vector<std::uint32_t> inconsistent;  // two in the same direction

  bool empty() const { return boundary.empty() && non_manifold.empty() && inconsistent.empty(); }
};

// twin[h] is the halfedge of the same edge in the opposite direction, none where the edge is defective. Same
// conditions as group_edges().
std::vector<std::uint32_t> pair_halfedges(std::span<const Triangle> triangles, std::size_t vertex_count,
                                          EdgeDefects& defects);
std::vector<std::uint32_t> pair_halfedges(std::span<const Triangle> triangles, const EdgeGroups& edges,
                                          EdgeDefects& defects);

}  // namespace prcage
