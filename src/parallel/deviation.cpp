#include "parallel/deviation.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/area_samples.h"
#include "parallel/closest_face.h"
#include "parallel/parallel_for.h"
#include "parallel/winding.h"

namespace prcage {
namespace {

// Distances below this share of l are taken for none: their sides mean nothing.
constexpr double least_distance = 1e-12;

// Samples spread over the area, the vertices, and the middles of the faces.
std::vector<Position> points_on(const SurfaceTree& surface, std::size_t samples) {
  std::vector<Position> points(surface.positions().begin(), surface.positions().end());
  for (std::uint32_t f = 0; f < surface.triangles().size(); ++f) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) sum += vec(surface.positions()[surface.triangles()[f][k]]);
    points.push_back(position(sum / 3));
  }
  const AreaSamples spread(surface.positions(), surface.triangles(), samples, CounterRandom(0, 0));
  for (std::size_t i = 0; i < spread.size(); ++i) points.push_back(position(spread[i].point));
  return points;
}

std::vector<double> distances(const std::vector<Position>& points, const SurfaceTree& to) {
  const ClosestFace closest(to);
  std::vector<double> distance(points.size());
  parallel_chunks(points.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::uint32_t hint = none;
    for (std::size_t i = begin; i < end; ++i) {
      const ClosestFace::Near near = closest.nearest(vec(points[i]), hint);
      hint = near.face;
      distance[i] = near.distance;
    }
  });
  return distance;
}

double largest_distance(const SurfaceTree& from, const SurfaceTree& to, std::size_t samples) {
  const std::vector<double> distance = distances(points_on(from, samples), to);
  return *std::max_element(distance.begin(), distance.end());
}

}  // namespace

double measured_hausdorff(const SurfaceTree& input, const SurfaceTree& surface, std::size_t samples) {
  return std::max(largest_distance(input, surface, samples), largest_distance(surface, input, samples));
}

TwoSidedDeviation measure_deviation(const TreeDevice& device, const SurfaceTree& input, const SurfaceTree& surface,
                                    double diagonal, std::size_t samples) {
  TwoSidedDeviation deviation;
  deviation.from_input = largest_distance(input, surface, samples) / diagonal;

  const std::vector<Position> points = points_on(surface, samples);
  const std::vector<double> distance = distances(points, input);
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::erase_if(order, [&](std::uint32_t i) { return !(distance[i] > least_distance * diagonal); });
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    return distance[i] != distance[j] ? distance[i] > distance[j] : i < j;
  });
  // The farthest first: a few of them nearly always tell both sides.
  for (std::size_t begin = 0, size = 64; begin < order.size(); begin += size, size *= 2) {
    if (deviation.outside > 0 && deviation.inside > 0) break;
    const std::size_t end = std::min(order.size(), begin + size);
    std::vector<Position> some;
    for (std::size_t k = begin; k < end; ++k) some.push_back(points[order[k]]);
    const std::vector<Winding> windings = winding_numbers(device, input, some);
    for (std::size_t k = begin; k < end; ++k) {
      if (!windings[k - begin].known) continue;
      double& side = windings[k - begin].number == 0 ? deviation.outside : deviation.inside;
      side = std::max(side, distance[order[k]] / diagonal);
    }
  }
  return deviation;
}

}  // namespace prcage
