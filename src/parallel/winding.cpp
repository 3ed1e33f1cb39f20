#include "parallel/winding.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "core/predicates.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

// Enough by far: a random segment is degenerate once in millions of times, unless it leans by less than the precision
// of the coordinates.
constexpr int max_attempts = 64;

// How far a segment leans from its axis, relative to the diagonal of the bounding box: little at first, so that its
// box is thin.
double lean(int attempt) { return std::min(std::ldexp(1e-5, attempt), 0.5); }

std::uint64_t mix(std::uint64_t x) {  // splitmix64
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

double unit_random(std::uint64_t seed) { return static_cast<double>(mix(seed) >> 11) * 0x1p-53; }

// End of the segment for one attempt at one point: outside the box, a random way along a random axis.
Position far_end(const Position& point, const Extent& box, std::uint64_t query, int attempt) {
  const std::uint64_t seed = mix(query * max_attempts + static_cast<std::uint64_t>(attempt)) & ~std::uint64_t{7};
  const auto axis = static_cast<Eigen::Index>(mix(seed) % 3);
  const double diagonal = box.diagonal();
  Position end = point;
  const double beyond = (0.5 + 0.25 * unit_random(seed + 1)) * diagonal;
  const bool up = unit_random(seed + 2) < 0.5;
  for (int k = 0; k < 3; ++k) {
    double& x = end[static_cast<std::size_t>(k)];
    if (k == axis)
      x = up ? box.upper[k] + beyond : box.lower[k] - beyond;
    else
      x += (unit_random(seed + 3 + static_cast<std::uint64_t>(k)) - 0.5) * 2 * lean(attempt) * diagonal;
  }
  return end;
}

enum class Meeting { none, outward, inward, degenerate, on_surface };

// How the segment from p to the far end q, which is off the surface, meets a closed triangle of a closed surface. One
// that lies in the plane of the segment, or has no area, is met only across an edge: a neighbour that does not lie so
// reports that.
Meeting meet(const double* p, const double* q, const double* a, const double* b, const double* c) {
  const int at_p = exact::orient3d(a, b, c, p);
  const int at_q = exact::orient3d(a, b, c, q);
  if (at_p == 0 && exact::segment_triangle_intersect(p, p, a, b, c)) return Meeting::on_surface;
  if (at_p == 0 || at_q == 0 || at_p == at_q) return Meeting::none;
  const int ab = exact::orient3d(p, q, a, b);
  const int bc = exact::orient3d(p, q, b, c);
  const int ca = exact::orient3d(p, q, c, a);
  if (std::max({ab, bc, ca}) > 0 && std::min({ab, bc, ca}) < 0) return Meeting::none;
  if (ab == 0 || bc == 0 || ca == 0) return Meeting::degenerate;
  return at_p < 0 ? Meeting::outward : Meeting::inward;
}

// What the segment of one query has met so far; written by many threads in any order.
struct Tally {
  std::atomic<int> crossings{0};
  std::atomic<bool> degenerate{false};
  std::atomic<bool> on_surface{false};

  void add(Meeting meeting) {
    switch (meeting) {
      case Meeting::none:
        break;
      case Meeting::outward:
        crossings.fetch_add(1, std::memory_order_relaxed);
        break;
      case Meeting::inward:
        crossings.fetch_sub(1, std::memory_order_relaxed);
        break;
      case Meeting::degenerate:
        degenerate.store(true, std::memory_order_relaxed);
        break;
      case Meeting::on_surface:
        on_surface.store(true, std::memory_order_relaxed);
        break;
    }
  }
};

bool outside(const Extent& box, const Position& p) {
  return (vec(p).array() < box.lower.array()).any() || (vec(p).array() > box.upper.array()).any();
}

}  // namespace

std::vector<Winding> winding_numbers(const TreeDevice& device, const SurfaceTree& surface,
                                     std::span<const Position> points, const IgnoredComponents& ignored) {
  const Extent box = extent(surface.positions());
  std::vector<Winding> result(points.size());
  std::vector<std::uint32_t> open;  // queries without an answer
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (outside(box, points[i]))
      result[i].known = true;
    else
      open.push_back(i);
  }

  for (int attempt = 0; attempt < max_attempts && !open.empty(); ++attempt) {
    std::vector<Position> ends(open.size());
    std::vector<Box> boxes(open.size());
    std::vector<Tally> tallies(open.size());
    for (std::size_t k = 0; k < open.size(); ++k) {
      ends[k] = far_end(points[open[k]], box, open[k], attempt);
      boxes[k] = bounding_box(surface.frame(), {points[open[k]].data(), ends[k].data()});
    }
    BoxTree segments(device);
    segments.build(boxes, TreeQuality::fast_query);
    join(segments, surface.runs(), [&](std::uint32_t k, std::uint32_t f) {
      if (ignored.components != nullptr && ignored.components->of_face[f] == ignored.skip[open[k]]) return;
      tallies[k].add(meet(points[open[k]].data(), ends[k].data(), surface.corner(f, 0), surface.corner(f, 1),
                          surface.corner(f, 2)));
    });

    std::vector<std::uint32_t> still_open;
    for (std::size_t k = 0; k < open.size(); ++k) {
      if (tallies[k].on_surface) continue;
      if (tallies[k].degenerate)
        still_open.push_back(open[k]);
      else
        result[open[k]] = {true, tallies[k].crossings};
    }
    open.swap(still_open);
  }
  return result;
}

std::vector<Position> component_points(std::span<const Position> positions, std::span<const Triangle> triangles,
                                       const Components& components) {
  std::vector<Position> points(components.count());
  for (std::size_t c = 0; c < points.size(); ++c) points[c] = positions[triangles[components[c].front()][0]];
  return points;
}

std::vector<int> volume_signs(const SurfaceTree& surface, const Components& components) {
  std::vector<int> signs(components.count());
  parallel_each(components.count(), 1, [&](std::size_t c) {
    std::vector<const double*> corners;
    corners.reserve(3 * components[c].size());
    for (const std::uint32_t f : components[c])
      for (std::size_t i = 0; i < 3; ++i) corners.push_back(surface.corner(f, i));
    signs[c] = exact::volume_sign(corners.data(), components[c].size());
  });
  return signs;
}

std::vector<Nesting> nesting(const TreeDevice& device, const SurfaceTree& surface, const Components& components) {
  std::vector<Nesting> result(components.count());
  const auto signs = volume_signs(surface, components);
  for (std::size_t c = 0; c < result.size(); ++c) result[c].sign = signs[c];
  if (result.size() == 1) {
    result[0].others.known = true;
    return result;
  }
  const auto points = component_points(surface.positions(), surface.triangles(), components);
  std::vector<std::uint32_t> own(result.size());
  std::iota(own.begin(), own.end(), 0u);
  const auto others = winding_numbers(device, surface, points, {&components, own});
  for (std::size_t c = 0; c < result.size(); ++c) result[c].others = others[c];
  return result;
}

}  // namespace prcage
