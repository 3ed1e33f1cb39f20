#include "parallel/cage_state.h"

#include <cmath>
#include <limits>

namespace prcage {
namespace {

template <class T>
void keep(std::vector<T>& values, const std::vector<std::uint32_t>& kept) {
  for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
  values.resize(kept.size());
}

}  // namespace

float round_distance_up(double distance) {
  return std::nextafter(static_cast<float>(distance), std::numeric_limits<float>::infinity());
}

void compact_if_sparse(CageState& state, double live_share) {
  if (static_cast<double>(state.live_faces) >= live_share * static_cast<double>(state.mesh.face_slots())) return;
  const Compaction kept = compact(state.mesh);
  // The lower halfedge of an edge stays the lower one: live elements keep their order.
  for (std::size_t i = 0; i < kept.faces.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      state.edge_cost[3 * i + k] = state.edge_cost[3 * std::size_t{kept.faces[i]} + k];
  state.edge_cost.resize(3 * kept.faces.size());
  keep(state.face_distance, kept.faces);
  keep(state.face_near, kept.faces);
  keep(state.face_box, kept.faces);
  keep(state.dirty, kept.vertices);
  state.face_owner.assign(kept.faces.size(), none);
}

}  // namespace prcage
