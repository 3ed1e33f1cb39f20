// The evolving cage: a closed oriented triangle mesh in flat arrays that supports edge collapses and flips.
//
// Corner table. Halfedge h = 3 f + i runs from corner i of face f to the next corner; twin[h] is its opposite.
// A dead face has corner_vertex == none in its three slots, a dead vertex has vertex_halfedge == none. Elements die
// in place and are removed by renumber(). Operations that touch disjoint stars (faces incident to the edge's
// endpoints) may run at the same time.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/adjacency.h"
#include "core/vec3.h"

namespace prcage {

struct CornerTable {
  std::vector<Position> position;              // per vertex
  std::vector<std::uint32_t> vertex_halfedge;  // per vertex: a halfedge that leaves it
  std::vector<std::uint32_t> corner_vertex;    // per halfedge: the vertex it leaves
  std::vector<std::uint32_t> twin;             // per halfedge

  // From a closed oriented manifold mesh.
  static CornerTable from_mesh(const Mesh& mesh);
  // The live part, vertices and faces in their present order.
  Mesh to_mesh() const;

  std::size_t face_slots() const { return corner_vertex.size() / 3; }
  std::size_t vertex_slots() const { return position.size(); }
  bool face_alive(std::uint32_t f) const { return corner_vertex[3 * std::size_t{f}] != none; }

  std::uint32_t origin(std::uint32_t h) const { return corner_vertex[h]; }
  std::uint32_t target(std::uint32_t h) const { return corner_vertex[next_halfedge(h)]; }
  std::uint32_t apex(std::uint32_t h) const { return corner_vertex[previous_halfedge(h)]; }
  // The next halfedge that leaves the same vertex, counterclockwise.
  std::uint32_t next_around(std::uint32_t h) const { return twin[previous_halfedge(h)]; }

  const double* point(std::uint32_t v) const { return position[v].data(); }
  Vec3 vec_at(std::uint32_t v) const { return vec(position[v]); }
  Triangle face(std::uint32_t f) const {
    const std::uint32_t* v = &corner_vertex[3 * std::size_t{f}];
    return {v[0], v[1], v[2]};
  }
  std::array<Vec3, 3> corners(std::uint32_t f) const {
    const auto [a, b, c] = face(f);
    return {vec_at(a), vec_at(b), vec_at(c)};
  }

  // Number of edges at v, counting stops at limit.
  std::uint32_t valence(std::uint32_t v, std::uint32_t limit = none) const;
};

// Calls visit(h) for every halfedge that leaves v, counterclockwise from vertex_halfedge[v].
template <class Visit>
void for_each_outgoing(const CornerTable& mesh, std::uint32_t v, const Visit& visit) {
  const std::uint32_t first = mesh.vertex_halfedge[v];
  std::uint32_t h = first;
  do {
    visit(h);
    h = mesh.next_around(h);
  } while (h != first);
}

// Collapses the edge of h onto its origin, which moves to p: the target vertex and the two faces at the edge die.
// The link condition must hold.
void collapse_edge(CornerTable& mesh, std::uint32_t h, const Position& p);

// Replaces edge (a, b) of h by the edge between the two opposite vertices, which must not be joined already. The two
// faces keep their numbers; afterwards h and its twin are the new edge.
void flip_edge(CornerTable& mesh, std::uint32_t h);

// Old number of each new element.
struct Numbering {
  std::vector<std::uint32_t> faces;
  std::vector<std::uint32_t> vertices;
};

// The live elements in their present order.
Numbering live_elements(const CornerTable& mesh);

// Puts the elements in the given order, which must hold the live ones, each once. Dead ones are removed.
void renumber(CornerTable& mesh, const Numbering& order);

// Link condition for collapsing the edge of h in a closed surface: the endpoints have exactly the two opposite
// vertices as common neighbours, those keep a valence of at least 3, and the merged vertex does too.
bool link_condition(const CornerTable& mesh, std::uint32_t h);

}  // namespace prcage
