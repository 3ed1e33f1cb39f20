#include "parallel/cage_state.h"

#include <algorithm>
#include <atomic>
#include <limits>

#include "parallel/morton.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

template <class T>
void keep(std::vector<T>& values, const std::vector<std::uint32_t>& kept) {
  std::vector<T> ordered(kept.size());
  parallel_each(kept.size(), default_grain, [&](std::size_t i) { ordered[i] = values[kept[i]]; });
  values = std::move(ordered);
}

// In the order in which the faces use them.
std::vector<std::uint32_t> vertices_along(const CornerTable& mesh, const std::vector<std::uint32_t>& faces) {
  std::vector<std::uint32_t> vertices;
  vertices.reserve(faces.size() / 2 + 2);
  std::vector<std::uint8_t> seen(mesh.vertex_slots(), 0);
  for (const std::uint32_t f : faces) {
    for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
      const std::uint32_t v = mesh.corner_vertex[h];
      if (seen[v] == 0) vertices.push_back(v);
      seen[v] = 1;
    }
  }
  return vertices;
}

// Each halfedge gets the cost of its edge, since the lower one may be the other one afterwards.
void reorder_costs(CageState& state, const std::vector<std::uint32_t>& faces) {
  std::vector<float> cost(3 * faces.size());
  parallel_each(cost.size(), default_grain, [&](std::size_t i) {
    const std::uint32_t h = 3 * faces[i / 3] + static_cast<std::uint32_t>(i % 3);
    cost[i] = state.edge_cost[std::min(h, state.mesh.twin[h])];
  });
  state.edge_cost = std::move(cost);
}

}  // namespace

Normal reliable_normal(const double* a, const double* b, const double* c) {
  const Vec3 p(a[0], a[1], a[2]), q(b[0], b[1], b[2]), r(c[0], c[1], c[2]);
  const Vec3 n = (q - p).cross(r - p);
  const double longest = std::max({(q - p).squaredNorm(), (r - q).squaredNorm(), (p - r).squaredNorm()});
  const double length = n.norm();
  if (!(length > 1e-8 * longest)) return {0, 0, 0};
  return {static_cast<float>(n.x() / length), static_cast<float>(n.y() / length), static_cast<float>(n.z() / length)};
}

void set_cost(CageState& state, std::uint32_t h, float cost) {
  state.edge_cost[h] = cost;
  for (const std::uint32_t v : {state.mesh.origin(h), state.mesh.target(h)})
    std::atomic_ref(state.reselect[v]).store(1, std::memory_order_relaxed);
}

void forget_costs(CageState& state) {
  const std::size_t vertices = state.mesh.vertex_slots();
  state.edge_cost.assign(state.mesh.corner_vertex.size(), std::numeric_limits<float>::infinity());
  state.dirty.assign(vertices, Dirt::moved);
  state.best_edge.resize(vertices);
  state.reselect.assign(vertices, 1);
}

std::vector<std::uint32_t> sort_along_curve(CageState& state) {
  Numbering order;
  order.faces = along_curve(state.face_box);  // dead faces have empty boxes
  order.vertices = vertices_along(state.mesh, order.faces);
  reorder_costs(state, order.faces);
  renumber(state.mesh, order);
  keep(state.face_distance, order.faces);
  keep(state.face_near, order.faces);
  keep(state.face_reach, order.faces);
  keep(state.face_box, order.faces);
  keep(state.face_normal, order.faces);
  keep(state.dirty, order.vertices);
  if (state.components > 0) keep(state.vertex_component, order.vertices);
  if (!state.face_room.empty()) keep(state.face_room, order.faces);
  state.best_edge.resize(order.vertices.size());
  state.reselect.assign(order.vertices.size(), 1);
  return std::move(order.faces);
}

}  // namespace prcage
