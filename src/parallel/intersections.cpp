#include "parallel/intersections.h"

#include <algorithm>

#include "core/adjacency.h"
#include "core/predicates.h"
#include "core/star.h"
#include "parallel/pair_collector.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

// Do the two faces have a vertex of the set in common?
bool share_one_of(std::span<const std::uint8_t> set, const Triangle& s, const Triangle& t) {
  return std::any_of(s.begin(), s.end(),
                     [&](std::uint32_t v) { return (v == t[0] || v == t[1] || v == t[2]) && set[v] != 0; });
}

}  // namespace

bool touch(const double* const s[3], const double* const t[3]) {
  return !certainly_separated(s, t) && exact::triangles_intersect(s[0], s[1], s[2], t[0], t[1], t[2]);
}

std::vector<std::uint8_t> embedded_stars(std::span<const Position> positions, std::span<const Triangle> triangles,
                                         std::span<const std::uint32_t> twin) {
  std::vector<std::uint32_t> outgoing(positions.size(), none);
  for (std::uint32_t h = 0; h < twin.size(); ++h) outgoing[triangles[h / 3][h % 3]] = h;
  std::vector<std::uint8_t> embedded(positions.size(), 0);
  parallel_chunks(positions.size(), default_grain, [&](std::size_t begin, std::size_t end) {
    std::vector<const double*> link;
    for (std::size_t v = begin; v < end; ++v) {
      if (outgoing[v] == none) continue;
      link.clear();
      std::uint32_t h = outgoing[v];
      do {
        const std::uint32_t next = next_halfedge(h);
        link.push_back(positions[triangles[next / 3][next % 3]].data());
        h = twin[previous_halfedge(h)];
      } while (h != outgoing[v]);
      embedded[v] = star_certainly_embedded(positions[v].data(), link.data(), link.size()) ? 1 : 0;
    }
  });
  return embedded;
}

FacePairs self_intersections(const SurfaceTree& surface, std::size_t limit, std::span<const std::uint8_t> embedded) {
  PairCollector found(limit);
  self_join(surface.runs(), [&](std::uint32_t i, std::uint32_t j) {
    if (!embedded.empty() && share_one_of(embedded, surface.triangles()[i], surface.triangles()[j])) return;
    if (improper_contact(surface.triangle(i), surface.triangle(j))) found.add(i, j);
  });
  return found.result();
}

FacePairs self_intersections(const SurfaceTree& surface, const SurfaceTree& changed,
                             std::span<const std::uint8_t> is_changed, std::size_t limit) {
  PairCollector found(limit);
  join(changed.runs(), surface.runs(), [&](std::uint32_t i, std::uint32_t j) {
    if (i == j || (is_changed[j] != 0 && i > j)) return;  // pairs of two changed faces come twice
    if (improper_contact(surface.triangle(i), surface.triangle(j))) found.add(std::min(i, j), std::max(i, j));
  });
  return found.result();
}

FacePairs contacts(const SurfaceTree& a, const SurfaceTree& b, std::size_t limit) {
  PairCollector found(limit);
  join(a.runs(), b.runs(), [&](std::uint32_t i, std::uint32_t j) {
    if (touch(a.triangle(i).p, b.triangle(j).p)) found.add(i, j);
  });
  return found.result();
}

}  // namespace prcage
