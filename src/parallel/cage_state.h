// What the engine works on: the cage, what is known per face and per edge, and the settings of the present cycle.
// All arrays are flat and indexed like the corner table; every stage of a round reads some and writes others.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/corner_table.h"
#include "core/placement.h"
#include "parallel/box_tree.h"

namespace prcage {

// What happened at a vertex since its edges were evaluated.
enum class Dirt : std::uint8_t { clean, rim, moved };  // nothing; faces at it were replaced; it moved

// Unit normal, off by no more than 1e-6, or zero for faces so thin that theirs is not reliable.
using Normal = std::array<float, 3>;
Normal reliable_normal(const double* a, const double* b, const double* c);

// An edge that might be collapsed or flipped. Keys are unique and order candidates by cost, equal costs by a hash of
// the edge.
struct Candidate {
  std::uint64_t key;
  std::uint32_t halfedge;

  bool operator<(const Candidate& other) const { return key < other.key; }
};

struct CageState {
  CornerTable mesh;
  std::size_t live_faces = 0;
  std::vector<float> face_distance;      // per face: upper bound of d(c_f, M); negative inside of M if the band has
                                         // two sides
  std::vector<std::uint32_t> face_near;  // per face: an input face near its centroid
  std::vector<float> face_reach;         // per face: upper bound of the distance of its points to M
  std::vector<Box> face_box;             // per face; empty for dead faces
  std::vector<Normal> face_normal;       // per face
  std::vector<float> edge_cost;          // per halfedge, valid for the lower one of an edge; infinity: no candidate
  std::vector<Candidate> best_edge;      // per vertex: the cheapest edge at it, valid where reselect is 0
  std::vector<std::uint8_t> reselect;    // per vertex: the cost of an edge at it has changed
  std::vector<Dirt> dirty;               // per vertex

  // Where components are in each other's way, since all of them move: how many there are, and that of each vertex.
  std::size_t components = 0;
  std::vector<std::uint32_t> vertex_component;

  // Where a wrap bounds the surface, per face: how far its centroid is from it, 0 beyond it. Else empty.
  std::vector<float> face_room;
};

// Sets the cost of the edge of h, the lower halfedge. Its ends are looked at again by the next selection. Thread-safe
// for different edges.
void set_cost(CageState& state, std::uint32_t h, float cost);

// Forgets what is known of edges: all are to be evaluated.
void forget_costs(CageState& state);

// Removes dead elements and puts the live ones in the order of a space-filling curve, so that what is near in space
// is near in memory, and runs of faces have small boxes. The order depends on the cage only. Returns the old numbers of
// the faces.
std::vector<std::uint32_t> sort_along_curve(CageState& state);

// The lower halfedge stands for an edge.
inline bool represents_edge(const CornerTable& mesh, std::uint32_t h) {
  return mesh.corner_vertex[h] != none && h < mesh.twin[h];
}

}  // namespace prcage
