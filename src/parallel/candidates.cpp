#include "parallel/candidates.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>

#include "parallel/parallel_for.h"

namespace prcage {
namespace {

constexpr std::uint64_t no_key = std::numeric_limits<std::uint64_t>::max();
constexpr float no_cost = std::numeric_limits<float>::infinity();

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

struct Scratch {
  PlacementBatch batch;
  Counts counts;
};

bool small_enough(const CornerTable& mesh, std::uint32_t h, std::uint32_t max_star) {
  const std::uint32_t a = mesh.valence(mesh.origin(h), max_star);
  return a < max_star && a + mesh.valence(mesh.target(h), max_star) <= max_star + 2;
}

// Edges of halfedges [begin, end) that need evaluation: gathered, solved as one batch, costs written back.
void evaluate_range(CageState& state, const PlacementSettings& settings, std::size_t begin, std::size_t end,
                    Scratch& scratch) {
  const CornerTable& mesh = state.mesh;
  PlacementBatch& batch = scratch.batch;
  batch.clear();
  for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
    if (!represents_edge(mesh, h)) continue;
    if (!state.dirty[mesh.origin(h)] && !state.dirty[mesh.target(h)]) continue;
    state.edge_cost[h] = no_cost;
    ++scratch.counts.evaluated;
    if (!small_enough(mesh, h, settings.max_star)) continue;
    if (!link_condition(mesh, h)) {
      ++scratch.counts.rejected_link;
      continue;
    }
    gather_placement(mesh, state.face_distance, h, settings, batch);
  }
  solve_placements(settings, batch);
  for (std::size_t i = 0; i < batch.size(); ++i) {
    // Costs are areas times squared lengths: the root keeps small edges within the range of floats.
    state.edge_cost[batch.halfedge[i]] = static_cast<float>(std::sqrt(batch.cost[i]) * settings.cost_scale);
    if (std::isinf(batch.cost[i])) ++scratch.counts.rejected_infeasible;
  }
}

}  // namespace

void evaluate_dirty_edges(CageState& state, const PlacementSettings& settings, Counts& counts) {
  tbb::enumerable_thread_specific<Scratch> scratch;
  constexpr std::size_t chunk = 384;  // halfedges; about 200 edges
  parallel_chunks(state.mesh.corner_vertex.size(), chunk, [&](std::size_t begin, std::size_t end) {
    Scratch& local = scratch.local();
    for (std::size_t b = begin; b < end; b += chunk)
      evaluate_range(state, settings, b, std::min(end, b + chunk), local);
  });
  for (const Scratch& local : scratch) counts += local.counts;
  parallel_chunks(state.dirty.size(), 1u << 16, [&](std::size_t begin, std::size_t end) {
    std::fill(state.dirty.begin() + static_cast<std::ptrdiff_t>(begin),
              state.dirty.begin() + static_cast<std::ptrdiff_t>(end), std::uint8_t{0});
  });
}

std::uint64_t candidate_key(float cost, std::uint32_t halfedge, std::uint64_t seed) {
  const std::uint32_t salt = mix(static_cast<std::uint32_t>(seed) ^ mix(static_cast<std::uint32_t>(seed >> 32)));
  return std::uint64_t{std::bit_cast<std::uint32_t>(cost)} << 32 | mix(halfedge ^ salt);
}

std::vector<Candidate> select_independent_collapses(const CageState& state, std::uint64_t seed) {
  const CornerTable& mesh = state.mesh;
  const std::size_t halfedges = mesh.corner_vertex.size();
  const auto is_candidate = [&](std::uint32_t h) { return represents_edge(mesh, h) && state.edge_cost[h] < no_cost; };
  // Best key among the edges at a vertex.
  std::vector<std::uint64_t> at_vertex(mesh.vertex_slots(), no_key);
  parallel_each(halfedges, default_grain, [&](std::size_t i) {
    const auto h = static_cast<std::uint32_t>(i);
    if (!is_candidate(h)) return;
    const std::uint64_t key = candidate_key(state.edge_cost[h], h, seed);
    atomic_min(at_vertex[mesh.origin(h)], key);
    atomic_min(at_vertex[mesh.target(h)], key);
  });
  // Best key among the candidates whose star holds any face of the vertex: a star holds a face exactly if an endpoint
  // of its edge is a corner of the face.
  std::vector<std::uint64_t> at_faces(mesh.vertex_slots(), no_key);
  parallel_each(mesh.face_slots(), default_grain, [&](std::size_t f) {
    const std::uint32_t* v = &mesh.corner_vertex[3 * f];
    if (v[0] == none) return;
    const std::uint64_t best = std::min({at_vertex[v[0]], at_vertex[v[1]], at_vertex[v[2]]});
    for (int k = 0; k < 3; ++k) atomic_min(at_faces[v[k]], best);
  });
  auto selected = parallel_gather<Candidate>(halfedges, 1u << 14, [&](std::size_t begin, std::size_t end, auto& list) {
    for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
      if (!is_candidate(h)) continue;
      const std::uint64_t key = candidate_key(state.edge_cost[h], h, seed);
      if (at_faces[mesh.origin(h)] == key && at_faces[mesh.target(h)] == key) list.push_back({key, h});
    }
  });
  tbb::parallel_sort(selected);
  return selected;
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
  std::sort(selected.begin(), selected.end());
  return selected;
}

}  // namespace prcage
