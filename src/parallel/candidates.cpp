#include "parallel/candidates.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>

#include "core/edge_star.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

constexpr std::uint64_t no_key = std::numeric_limits<std::uint64_t>::max();
// A selected edge whose cost has grown by more than this factor since it was evaluated waits for its turn.
constexpr float most_dearer = 1.5f;
constexpr float no_cost = std::numeric_limits<float>::infinity();
// Bits of the fraction that steps of costs begin with: they are an eighth wide or less.
constexpr int step_bits = 3;

void atomic_min(std::uint64_t& target, std::uint64_t value) {
  std::atomic_ref<std::uint64_t> slot(target);
  std::uint64_t seen = slot.load(std::memory_order_relaxed);
  while (value < seen && !slot.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
}

// Bijective mix of 32 bits.
std::uint32_t mix(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}

// The lower end of the step that the cost, which is not negative, is in.
float step_of(float cost) {
  constexpr int dropped = std::numeric_limits<float>::digits - 1 - step_bits;
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(cost) >> dropped << dropped);
}

struct Scratch {
  EdgeStar star;
  PlacementBatch batch;
  std::vector<std::size_t> index;
  Counts counts;
};

// Adds the problem of an edge to the batch, unless its star is too large or its topology rules a collapse out.
bool gather_if_legal(const CageState& state, const PlacementSettings& settings, std::uint32_t h, Scratch& scratch) {
  EdgeStar& star = scratch.star;
  if (!star.walk(state.mesh, h, settings.max_star)) return false;
  if (!star.link_condition()) {
    ++scratch.counts.rejected_link;
    return false;
  }
  const FaceHeights heights(state.face_distance, state.face_room.empty() ? nullptr : &state.face_room);
  gather_placement(state.mesh, heights, star, settings, scratch.batch);
  return true;
}

// Costs are areas times squared lengths: the root keeps small edges within the range of floats.
float edge_cost_of(double cost, const PlacementSettings& settings) {
  return static_cast<float>(std::sqrt(cost) * settings.cost_scale);
}

// Edges of halfedges [begin, end) that need evaluation: gathered, solved as one batch, costs written back.
void evaluate_range(CageState& state, const PlacementSettings& settings, std::size_t begin, std::size_t end,
                    Scratch& scratch) {
  const CornerTable& mesh = state.mesh;
  PlacementBatch& batch = scratch.batch;
  batch.clear();
  for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
    if (!represents_edge(mesh, h)) continue;
    const Dirt dirt = std::max(state.dirty[mesh.origin(h)], state.dirty[mesh.target(h)]);
    if (dirt == Dirt::clean || (dirt == Dirt::rim && state.edge_cost[h] < no_cost)) continue;
    set_cost(state, h, no_cost);
    ++scratch.counts.evaluated;
    gather_if_legal(state, settings, h, scratch);
  }
  solve_placements(settings, batch);
  for (std::size_t i = 0; i < batch.size(); ++i) {
    state.edge_cost[batch.halfedge[i]] = edge_cost_of(batch.cost[i], settings);
    if (std::isinf(batch.cost[i])) ++scratch.counts.rejected_infeasible;
  }
}

// The least of the edges from v to vertices that are free.
template <class Free>
Candidate best_edge_at(const CageState& state, std::uint32_t v, const CollapseOrder& order, const Free& free) {
  Candidate best{no_key, none};
  if (state.mesh.vertex_halfedge[v] == none) return best;
  float least = no_cost;
  for_each_outgoing(state.mesh, v, [&](std::uint32_t h) {
    if (!free(state.mesh.target(h))) return;
    const std::uint32_t edge = std::min(h, state.mesh.twin[h]);
    const float cost = state.edge_cost[edge], rank = order.rank(cost);
    if (rank > least || cost == no_cost) return;
    const Candidate candidate{order.key(cost, edge), edge};
    if (candidate < best) best = candidate;
    least = rank;
  });
  return best;
}

// Is the edge the least among those whose stars have a face in common with its own? Such an edge has an endpoint at or
// next to one of its endpoints.
bool is_least_nearby(const CornerTable& mesh, const std::vector<Candidate>& least_at, const Candidate& edge) {
  bool least = true;
  for (const std::uint32_t v : {mesh.origin(edge.halfedge), mesh.target(edge.halfedge)}) {
    least = least && least_at[v].key == edge.key;
    if (!least) return false;
    for_each_outgoing(mesh, v, [&](std::uint32_t h) { least = least && least_at[mesh.target(h)].key >= edge.key; });
  }
  return least;
}

// In the order of their origins.
std::vector<Candidate> local_minima(const CornerTable& mesh, const std::vector<Candidate>& least_at) {
  return parallel_gather<Candidate>(mesh.vertex_slots(), 1u << 13, [&](std::size_t begin, std::size_t end, auto& list) {
    for (std::size_t v = begin; v < end; ++v) {
      const Candidate& least = least_at[v];
      if (least.key != no_key && mesh.origin(least.halfedge) == v && is_least_nearby(mesh, least_at, least))
        list.push_back(least);
    }
  });
}

// Edges whose stars have a face in common with one of the selected have an endpoint among the vertices of those stars.
void take_stars(const CornerTable& mesh, const std::vector<Candidate>& selected, std::vector<std::uint8_t>& taken) {
  parallel_each(selected.size(), 64, [&](std::size_t i) {
    const std::uint32_t edge = selected[i].halfedge;
    for (const std::uint32_t v : {mesh.origin(edge), mesh.target(edge)})
      for_each_outgoing(mesh, v, [&](std::uint32_t h) {
        std::atomic_ref(taken[mesh.target(h)]).store(1, std::memory_order_relaxed);
      });
  });
}

// The minima of the edges that share no face with those selected before.
std::vector<Candidate> minima_of_the_rest(const CageState& state, const CollapseOrder& order,
                                          const std::vector<Candidate>& selected) {
  const CornerTable& mesh = state.mesh;
  std::vector<std::uint8_t> taken(mesh.vertex_slots(), 0);
  take_stars(mesh, selected, taken);
  std::vector<Candidate> least_at(mesh.vertex_slots());
  parallel_each(least_at.size(), default_grain, [&](std::size_t v) {
    const Candidate& least = state.best_edge[v];
    if (taken[v] != 0 || mesh.vertex_halfedge[v] == none || least.key == no_key)
      least_at[v] = {no_key, none};
    else if (taken[mesh.origin(least.halfedge)] == 0 && taken[mesh.target(least.halfedge)] == 0)
      least_at[v] = least;
    else
      least_at[v] =
          best_edge_at(state, static_cast<std::uint32_t>(v), order, [&](std::uint32_t w) { return taken[w] == 0; });
  });
  return local_minima(mesh, least_at);
}

}  // namespace

void evaluate_dirty_edges(CageState& state, const PlacementSettings& settings, Counts& counts) {
  tbb::enumerable_thread_specific<Scratch> scratch;
  constexpr std::size_t chunk = 1536;  // halfedges: up to 768 edges in a batch
  parallel_chunks(state.mesh.corner_vertex.size(), chunk, [&](std::size_t begin, std::size_t end) {
    Scratch& local = scratch.local();
    for (std::size_t b = begin; b < end; b += chunk)
      evaluate_range(state, settings, b, std::min(end, b + chunk), local);
  });
  for (const Scratch& local : scratch) counts += local.counts;
  parallel_chunks(state.dirty.size(), 1u << 16, [&](std::size_t begin, std::size_t end) {
    std::fill(state.dirty.begin() + static_cast<std::ptrdiff_t>(begin),
              state.dirty.begin() + static_cast<std::ptrdiff_t>(end), Dirt::clean);
  });
}

std::uint64_t candidate_key(float cost, std::uint32_t halfedge, std::uint64_t seed) {
  const std::uint32_t salt = mix(static_cast<std::uint32_t>(seed) ^ mix(static_cast<std::uint32_t>(seed >> 32)));
  return std::uint64_t{std::bit_cast<std::uint32_t>(cost)} << 32 | mix(halfedge ^ salt);
}

float CollapseOrder::rank(float cost) const { return rough ? step_of(cost) : cost; }

std::vector<Candidate> select_independent_collapses(CageState& state, const CollapseOrder& order) {
  const CornerTable& mesh = state.mesh;
  parallel_each(mesh.vertex_slots(), default_grain, [&](std::size_t v) {
    if (state.reselect[v] == 0) return;
    state.reselect[v] = 0;
    state.best_edge[v] = best_edge_at(state, static_cast<std::uint32_t>(v), order, [](std::uint32_t) { return true; });
  });
  std::vector<Candidate> selected = local_minima(mesh, state.best_edge);
  if (!order.rough) return selected;
  const std::vector<Candidate> more = minima_of_the_rest(state, order, selected);
  std::vector<Candidate> all(selected.size() + more.size());
  std::merge(selected.begin(), selected.end(), more.begin(), more.end(), all.begin(),
             [&](const Candidate& a, const Candidate& b) { return mesh.origin(a.halfedge) < mesh.origin(b.halfedge); });
  return all;
}

PlacedCollapses place_collapses(CageState& state, const PlacementSettings& settings,
                                const std::vector<Candidate>& selected) {
  constexpr std::size_t chunk = 16;
  tbb::enumerable_thread_specific<Scratch> scratch;
  std::vector<Position> point(selected.size());
  std::vector<std::uint8_t> confirmed(selected.size(), 0);
  parallel_chunks(selected.size(), chunk, [&](std::size_t begin, std::size_t end) {
    Scratch& local = scratch.local();
    PlacementBatch& batch = local.batch;
    batch.clear();
    std::vector<std::size_t>& origin = local.index;
    origin.clear();
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t h = selected[i].halfedge;
      if (gather_if_legal(state, settings, h, local))
        origin.push_back(i);
      else
        set_cost(state, h, no_cost);
    }
    solve_placements(settings, batch);
    for (std::size_t k = 0; k < batch.size(); ++k) {
      const std::uint32_t h = batch.halfedge[k];
      const float cost = edge_cost_of(batch.cost[k], settings);
      point[origin[k]] = batch.solution[k];
      confirmed[origin[k]] = cost < no_cost && cost <= most_dearer * state.edge_cost[h] ? 1 : 0;
      set_cost(state, h, cost);
    }
  });
  PlacedCollapses placed;
  for (std::size_t i = 0; i < selected.size(); ++i) {
    if (confirmed[i] == 0) continue;
    placed.candidate.push_back(selected[i]);
    placed.point.push_back(point[i]);
  }
  return placed;
}

void keep_cheapest(PlacedCollapses& placed, std::size_t count) {
  if (placed.candidate.size() <= count) return;
  std::vector<Candidate> order = placed.candidate;
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end());
  const Candidate first_left_out = order[count];
  std::size_t kept = 0;
  for (std::size_t i = 0; i < placed.candidate.size(); ++i) {
    if (!(placed.candidate[i] < first_left_out)) continue;
    placed.candidate[kept] = placed.candidate[i];
    placed.point[kept++] = placed.point[i];
  }
  placed.candidate.resize(kept);
  placed.point.resize(kept);
}

std::vector<Candidate> select_independent_flips(const CornerTable& mesh, const std::vector<Candidate>& candidates) {
  const auto corners = [&mesh](std::uint32_t h) {
    return std::array<std::uint32_t, 4>{mesh.origin(h), mesh.target(h), mesh.apex(h), mesh.apex(mesh.twin[h])};
  };
  std::vector<std::uint64_t> at_vertex(mesh.vertex_slots(), no_key);
  parallel_each(candidates.size(), default_grain, [&](std::size_t i) {
    for (const std::uint32_t v : corners(candidates[i].halfedge)) atomic_min(at_vertex[v], candidates[i].key);
  });
  std::vector<Candidate> selected;
  for (const Candidate& c : candidates) {
    const auto v = corners(c.halfedge);
    if (std::all_of(v.begin(), v.end(), [&](std::uint32_t u) { return at_vertex[u] == c.key; })) selected.push_back(c);
  }
  return selected;
}

}  // namespace prcage
