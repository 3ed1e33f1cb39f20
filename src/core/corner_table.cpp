#include "core/corner_table.h"

#include <atomic>
#include <cassert>

#include "core/edge_star.h"

namespace prcage {
namespace {

void pair_up(CornerTable& mesh, std::uint32_t g, std::uint32_t h) {
  mesh.twin[g] = h;
  mesh.twin[h] = g;
}

void kill_face(CornerTable& mesh, std::uint32_t h) {
  const std::uint32_t first = h - h % 3;
  for (std::uint32_t i = first; i < first + 3; ++i) mesh.corner_vertex[i] = mesh.twin[i] = none;
}

}  // namespace

CornerTable CornerTable::from_mesh(const Mesh& mesh) {
  CornerTable table;
  table.position = mesh.positions;
  EdgeDefects defects;
  table.twin = pair_halfedges(mesh.triangles, mesh.positions.size(), defects);
  assert(defects.empty());
  table.corner_vertex.resize(3 * mesh.triangles.size());
  table.vertex_halfedge.assign(mesh.positions.size(), none);
  for (std::uint32_t h = 0; h < table.corner_vertex.size(); ++h) {
    const std::uint32_t v = mesh.triangles[h / 3][h % 3];
    table.corner_vertex[h] = v;
    if (table.vertex_halfedge[v] == none) table.vertex_halfedge[v] = h;
  }
  return table;
}

Mesh CornerTable::to_mesh() const {
  Mesh mesh;
  std::vector<std::uint32_t> number(vertex_slots(), none);
  for (std::uint32_t v = 0; v < vertex_slots(); ++v) {
    if (vertex_halfedge[v] == none) continue;
    number[v] = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(position[v]);
  }
  for (std::uint32_t f = 0; f < face_slots(); ++f) {
    if (!face_alive(f)) continue;
    const auto [a, b, c] = face(f);
    mesh.triangles.push_back({number[a], number[b], number[c]});
  }
  return mesh;
}

std::uint32_t CornerTable::valence(std::uint32_t v, std::uint32_t limit) const {
  const std::uint32_t first = vertex_halfedge[v];
  std::uint32_t n = 0;
  std::uint32_t h = first;
  do {
    ++n;
    h = next_around(h);
  } while (h != first && n < limit);
  return n;
}

void collapse_edge(CornerTable& mesh, std::uint32_t h, const Position& p) {
  const std::uint32_t t = mesh.twin[h];
  const std::uint32_t a = mesh.origin(h);
  const std::uint32_t b = mesh.target(h);
  for_each_outgoing(mesh, b, [&](std::uint32_t g) { mesh.corner_vertex[g] = a; });
  mesh.position[a] = p;
  mesh.vertex_halfedge[b] = none;
  // In each dying face the two other edges become one: the halfedges across them are twins now, and they leave the
  // opposite vertex and a.
  for (const std::uint32_t edge : {h, t}) {
    const std::uint32_t into_apex = mesh.twin[next_halfedge(edge)];        // leaves the apex
    const std::uint32_t out_of_apex = mesh.twin[previous_halfedge(edge)];  // ends at the apex
    const std::uint32_t apex = mesh.apex(edge);
    // Another collapse may have the same apex. Only the one that kills the face which the entry names changes it.
    const std::atomic_ref at_apex(mesh.vertex_halfedge[apex]);
    if (at_apex.load(std::memory_order_relaxed) / 3 == edge / 3) at_apex.store(into_apex, std::memory_order_relaxed);
    mesh.vertex_halfedge[a] = out_of_apex;
    pair_up(mesh, into_apex, out_of_apex);
  }
  kill_face(mesh, h);
  kill_face(mesh, t);
}

void flip_edge(CornerTable& mesh, std::uint32_t h) {
  const std::uint32_t t = mesh.twin[h];
  const std::uint32_t h_next = next_halfedge(h), h_prev = previous_halfedge(h);
  const std::uint32_t t_next = next_halfedge(t), t_prev = previous_halfedge(t);
  const std::uint32_t a = mesh.origin(h), b = mesh.target(h), c = mesh.apex(h), d = mesh.apex(t);
  const std::uint32_t bc = mesh.twin[h_next], ca = mesh.twin[h_prev], ad = mesh.twin[t_next], db = mesh.twin[t_prev];
  // Face of h becomes (d, c, a), face of t becomes (c, d, b), with h from d to c and t from c to d.
  mesh.corner_vertex[h] = d;
  mesh.corner_vertex[h_next] = c;
  mesh.corner_vertex[h_prev] = a;
  mesh.corner_vertex[t] = c;
  mesh.corner_vertex[t_next] = d;
  mesh.corner_vertex[t_prev] = b;
  pair_up(mesh, h_next, ca);
  pair_up(mesh, h_prev, ad);
  pair_up(mesh, t_next, db);
  pair_up(mesh, t_prev, bc);
  mesh.vertex_halfedge[a] = h_prev;
  mesh.vertex_halfedge[b] = t_prev;
  mesh.vertex_halfedge[c] = h_next;
  mesh.vertex_halfedge[d] = t_next;
}

Numbering live_elements(const CornerTable& mesh) {
  Numbering live;
  for (std::uint32_t v = 0; v < mesh.vertex_slots(); ++v)
    if (mesh.vertex_halfedge[v] != none) live.vertices.push_back(v);
  for (std::uint32_t f = 0; f < mesh.face_slots(); ++f)
    if (mesh.face_alive(f)) live.faces.push_back(f);
  return live;
}

void renumber(CornerTable& mesh, const Numbering& order) {
  const auto inverse = [](const std::vector<std::uint32_t>& old, std::size_t slots) {
    std::vector<std::uint32_t> number(slots, none);
    for (std::size_t i = 0; i < old.size(); ++i) number[old[i]] = static_cast<std::uint32_t>(i);
    return number;
  };
  const std::vector<std::uint32_t> new_vertex = inverse(order.vertices, mesh.vertex_slots());
  const std::vector<std::uint32_t> new_face = inverse(order.faces, mesh.face_slots());
  const auto new_halfedge = [&](std::uint32_t h) { return 3 * new_face[h / 3] + h % 3; };
  const auto per_corner = [&](const auto& value_of_halfedge) {
    std::vector<std::uint32_t> values(3 * order.faces.size());
    for (std::size_t h = 0; h < values.size(); ++h)
      values[h] = value_of_halfedge(3 * order.faces[h / 3] + static_cast<std::uint32_t>(h % 3));
    return values;
  };
  mesh.corner_vertex = per_corner([&](std::uint32_t h) { return new_vertex[mesh.corner_vertex[h]]; });
  mesh.twin = per_corner([&](std::uint32_t h) { return new_halfedge(mesh.twin[h]); });
  std::vector<Position> position(order.vertices.size());
  std::vector<std::uint32_t> vertex_halfedge(order.vertices.size());
  for (std::size_t i = 0; i < order.vertices.size(); ++i) {
    position[i] = mesh.position[order.vertices[i]];
    vertex_halfedge[i] = new_halfedge(mesh.vertex_halfedge[order.vertices[i]]);
  }
  mesh.position = std::move(position);
  mesh.vertex_halfedge = std::move(vertex_halfedge);
}

bool link_condition(const CornerTable& mesh, std::uint32_t h) {
  EdgeStar star;
  star.walk(mesh, h);
  return star.link_condition();
}

}  // namespace prcage
