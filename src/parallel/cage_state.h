// What the engine works on: the cage, what is known per face and per edge, and the settings of the present cycle.
// All arrays are flat and indexed like the corner table; every stage of a round reads some and writes others.
#pragma once

#include <cstdint>
#include <vector>

#include "core/corner_table.h"
#include "core/placement.h"
#include "parallel/box_tree.h"

namespace prcage {

struct CageState {
  CornerTable mesh;
  std::size_t live_faces = 0;
  std::vector<float> face_distance;       // per face: upper bound of d(c_f, M)
  std::vector<std::uint32_t> face_near;   // per face: input face to which face_distance was measured
  std::vector<Box> face_box;              // per face; empty for dead faces
  std::vector<float> edge_cost;           // per halfedge, valid for the lower one of an edge; infinity: no candidate
  std::vector<std::uint8_t> dirty;        // per vertex: edges at it must be evaluated again
  std::vector<std::uint32_t> face_owner;  // per face: patch of the present round that would remove it, or none
};

// Distance as a float that is not smaller.
float round_distance_up(double distance);

// Removes dead elements from all arrays once less than `live_share` of the face slots are in use.
void compact_if_sparse(CageState& state, double live_share);

// The lower halfedge stands for an edge.
inline bool represents_edge(const CornerTable& mesh, std::uint32_t h) {
  return mesh.corner_vertex[h] != none && h < mesh.twin[h];
}

}  // namespace prcage
