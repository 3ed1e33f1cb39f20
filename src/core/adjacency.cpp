#include "core/adjacency.h"

#include <algorithm>

namespace prcage {
namespace {

std::uint32_t origin(std::span<const Triangle> triangles, std::uint32_t h) { return triangles[h / 3][h % 3]; }

struct Edge {
  std::uint32_t low;
  std::uint32_t high;
};

Edge edge_of(std::span<const Triangle> triangles, std::uint32_t h) {
  const std::uint32_t a = origin(triangles, h);
  const std::uint32_t b = origin(triangles, next_halfedge(h));
  return {std::min(a, b), std::max(a, b)};
}

// Halfedges in buckets by the smaller vertex of their edge, ascending within a bucket (counting sort). Bucket v is
// [bounds[v], bounds[v + 1]).
void bucket_by_smaller_vertex(std::span<const Triangle> triangles, std::size_t vertex_count,
                              std::vector<std::uint32_t>& halfedges, std::vector<std::uint32_t>& bounds) {
  const auto count = static_cast<std::uint32_t>(3 * triangles.size());
  bounds.assign(vertex_count + 2, 0);
  for (std::uint32_t h = 0; h < count; ++h) ++bounds[edge_of(triangles, h).low + 2];
  for (std::size_t v = 2; v < bounds.size(); ++v) bounds[v] += bounds[v - 1];
  halfedges.resize(count);
  for (std::uint32_t h = 0; h < count; ++h) halfedges[bounds[edge_of(triangles, h).low + 1]++] = h;
  bounds.pop_back();
}

}  // namespace

EdgeGroups group_edges(std::span<const Triangle> triangles, std::size_t vertex_count) {
  EdgeGroups edges;
  std::vector<std::uint32_t> bounds;
  bucket_by_smaller_vertex(triangles, vertex_count, edges.halfedges, bounds);
  edges.offsets.reserve(edges.halfedges.size() / 2 + 1);

  // A bucket holds a handful of halfedges: sorting it by (larger vertex, halfedge) is what a second counting sort
  // would do, without leaving the cache.
  std::vector<std::uint64_t> keys;
  for (std::size_t v = 0; v < vertex_count; ++v) {
    keys.clear();
    for (std::uint32_t i = bounds[v]; i < bounds[v + 1]; ++i) {
      const std::uint32_t h = edges.halfedges[i];
      keys.push_back(std::uint64_t{edge_of(triangles, h).high} << 32 | h);
    }
    std::sort(keys.begin(), keys.end());
    for (std::size_t k = 0; k < keys.size(); ++k) {
      const auto at = static_cast<std::uint32_t>(bounds[v] + k);
      if (k == 0 || keys[k] >> 32 != keys[k - 1] >> 32) edges.offsets.push_back(at);
      edges.halfedges[at] = static_cast<std::uint32_t>(keys[k]);
    }
  }
  edges.offsets.push_back(static_cast<std::uint32_t>(edges.halfedges.size()));
  return edges;
}

std::vector<std::uint32_t> pair_halfedges(std::span<const Triangle> triangles, const EdgeGroups& edges,
                                          EdgeDefects& defects) {
  defects = {};
  std::vector<std::uint32_t> twin(3 * triangles.size(), none);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto group = edges[e];
    if (group.size() == 1) {
      defects.boundary.push_back(group[0]);
    } else if (group.size() > 2) {
      defects.non_manifold.push_back(group[0]);
    } else if (origin(triangles, group[0]) == origin(triangles, group[1])) {
      defects.inconsistent.push_back(group[0]);
    } else {
      twin[group[0]] = group[1];
      twin[group[1]] = group[0];
    }
  }
  for (auto* list : {&defects.boundary, &defects.non_manifold, &defects.inconsistent})
    std::sort(list->begin(), list->end());
  return twin;
}

std::vector<std::uint32_t> pair_halfedges(std::span<const Triangle> triangles, std::size_t vertex_count,
                                          EdgeDefects& defects) {
  return pair_halfedges(triangles, group_edges(triangles, vertex_count), defects);
}

}  // namespace prcage
