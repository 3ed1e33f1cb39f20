// Exact predicates and the tests of pairs of triangles that are built on them: where the filter decides, and where it
// cannot.
#include <benchmark/benchmark.h>

#include <array>
#include <random>
#include <vector>

#include "core/predicates.h"
#include "core/triangle_pair.h"
#include "core/vec3.h"

namespace prcage::perf {
namespace {

constexpr std::size_t sets = 1024;

using Points = std::vector<Position>;

// Points of the unit cube.
Points random_points(std::size_t count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> coordinate;
  Points points(count);
  for (Position& p : points) p = {coordinate(random), coordinate(random), coordinate(random)};
  return points;
}

// In a plane that is not parallel to an axis, but for the rounding of z: the filter fails on many of them.
Points nearly_coplanar_points(std::size_t count) {
  Points points = random_points(count);
  for (Position& p : points) p[2] = 0.3 * p[0] + 0.7 * p[1];
  return points;
}

// run(p) for sets of `size` points p[0], p[1], ... in turn.
template <class Run>
void over_sets(benchmark::State& state, const Points& points, std::size_t size, const Run& run) {
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(run(&points[i * size]));
    i = (i + 1) % (points.size() / size);
  }
  state.SetItemsProcessed(state.iterations());
}

void orient3d(benchmark::State& state, Points (*make)(std::size_t)) {
  over_sets(state, make(4 * sets), 4,
            [](const Position* p) { return exact::orient3d(p[0].data(), p[1].data(), p[2].data(), p[3].data()); });
}
BENCHMARK_CAPTURE(orient3d, generic, random_points);
BENCHMARK_CAPTURE(orient3d, nearly_coplanar, nearly_coplanar_points);

void collinear(benchmark::State& state) {
  over_sets(state, random_points(3 * sets), 3,
            [](const Position* p) { return exact::collinear(p[0].data(), p[1].data(), p[2].data()); });
}
BENCHMARK(collinear);

// Two random triangles, the second one moved along x by `distance`, with the first `shared` vertices in common.
std::vector<std::array<TriangleRef, 2>> triangle_pairs(Points& points, double distance, std::uint32_t shared) {
  points = random_points(6 * sets);
  std::vector<std::array<TriangleRef, 2>> pairs(sets);
  for (std::size_t i = 0; i < sets; ++i) {
    Position* p = &points[6 * i];
    for (std::uint32_t k = 0; k < 3; ++k) {
      p[3 + k][0] += distance;
      if (k < shared) p[3 + k] = p[k];
      pairs[i][0].p[k] = p[k].data();
      pairs[i][0].v[k] = k;
      pairs[i][1].p[k] = p[3 + k].data();
      pairs[i][1].v[k] = k < shared ? k : 3 + k;
    }
  }
  return pairs;
}

template <class Test>
void over_pairs(benchmark::State& state, double distance, std::uint32_t shared, const Test& test) {
  Points points;
  const auto pairs = triangle_pairs(points, distance, shared);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(test(pairs[i][0], pairs[i][1]));
    i = (i + 1) % sets;
  }
  state.SetItemsProcessed(state.iterations());
}

void triangles_intersect(benchmark::State& state, double distance) {
  over_pairs(state, distance, 0, [](const TriangleRef& a, const TriangleRef& b) {
    return exact::triangles_intersect(a.p[0], a.p[1], a.p[2], b.p[0], b.p[1], b.p[2]);
  });
}
BENCHMARK_CAPTURE(triangles_intersect, apart, 1.0);
BENCHMARK_CAPTURE(triangles_intersect, near, 0.25);

void certain_separation(benchmark::State& state, double distance) {
  over_pairs(state, distance, 0,
             [](const TriangleRef& a, const TriangleRef& b) { return certainly_separated(a.p, b.p); });
}
BENCHMARK_CAPTURE(certain_separation, apart, 1.0);
BENCHMARK_CAPTURE(certain_separation, near, 0.25);

void contact(benchmark::State& state, double distance, std::uint32_t shared) {
  over_pairs(state, distance, shared,
             [](const TriangleRef& a, const TriangleRef& b) { return improper_contact(a, b); });
}
BENCHMARK_CAPTURE(contact, apart, 1.0, 0u);
BENCHMARK_CAPTURE(contact, near, 0.25, 0u);
BENCHMARK_CAPTURE(contact, shared_vertex, 0.25, 1u);
BENCHMARK_CAPTURE(contact, shared_edge, 0.25, 2u);

}  // namespace
}  // namespace prcage::perf
