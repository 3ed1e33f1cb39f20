// What the engine works on: the cage, what is known per face and per edge, and the settings of the present cycle.
// All arrays are flat and indexed like the corner table; every stage of a round reads some and writes others.
#pragma once

#include <cstdint>
#include <vector>

#include "core/corner_table.h"
#include "core/placement.h"
#include "parallel/box_tree.h"

namespace prcage {

// What happened at a vertex since its edges were evaluated.
enum class Dirt : std::uint8_t { clean, rim, moved };  // nothing; faces at it were replaced; it moved

struct CageState {
  CornerTable mesh;
  std::size_t live_faces = 0;
  std::vector<float> face_distance;      // per face: upper bound of d(c_f, M)
  std::vector<std::uint32_t> face_near;  // per face: input face to which face_distance was measured
  std::vector<Box> face_box;             // per face; empty for dead faces
  std::vector<float> vertex_distance;    // per vertex: upper bound of its distance to M
  std::vector<float> edge_cost;          // per halfedge, valid for the lower one of an edge; infinity: no candidate
  std::vector<Dirt> dirty;               // per vertex
};

// Distance as a float that is not smaller.
float round_distance_up(double distance);

// Removes dead elements and puts the live ones in the order of a space-filling curve, so that what is near in space
// is near in memory, and runs of faces have small boxes. The order depends on the cage only.
void sort_along_curve(CageState& state);

// The lower halfedge stands for an edge.
inline bool represents_edge(const CornerTable& mesh, std::uint32_t h) {
  return mesh.corner_vertex[h] != none && h < mesh.twin[h];
}

}  // namespace prcage
