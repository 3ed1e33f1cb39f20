// Mean value coordinates of a million vertices with respect to a cage of 500 faces: the kernel by instruction set, and
// its share of what the machine can do; and the whole deformation in one step.
//
// The kernel multiplies and adds, and never in one instruction: results would depend on whether the CPU can. So its
// peak is that of separate multiplications and additions, measured here as well: independent chains, no memory.
#include <benchmark/benchmark.h>

#include <numeric>
#include <vector>

#include "core/adjacency.h"
#include "core/mean_value.h"
#include "core/prcage.h"
#include "perf/bench_fixture.h"
#include "tools/shapes.h"

namespace prcage::perf {
namespace {

constexpr std::size_t cage_faces = 500;

Mesh knot(std::size_t faces) {
  std::string error;
  return make_shape("knot", faces, 0, error);
}

// A million vertices and a cage of 500 faces round them.
struct Bodies {
  Mesh input = knot(2000000);
  Mesh cage;

  Bodies() {
    Options options;
    options.face_budget = cage_faces;
    cage = make_cage(knot(20000), options).cage;
  }
};

const Bodies& bodies() {
  static const Bodies all;
  return all;
}

// The cage as the kernel wants it.
struct KernelCage {
  std::vector<std::uint32_t> edge, opposite, column;
  MeanValueCage arrays{};

  explicit KernelCage(const Mesh& cage) : opposite(3 * cage.triangles.size()), column(cage.positions.size()) {
    const EdgeGroups edges = group_edges(cage.triangles, cage.positions.size());
    for (std::uint32_t e = 0; e < edges.size(); ++e) {
      for (const std::uint32_t h : edges[e]) opposite[h / 3 * 3 + previous_halfedge(h) % 3] = e;
      const std::uint32_t h = edges[e][0];
      edge.push_back(cage.triangles[h / 3][h % 3]);
      edge.push_back(cage.triangles[h / 3][next_halfedge(h) % 3]);
    }
    std::iota(column.begin(), column.end(), 0u);
    arrays = {cage.positions.size(), edges.size(),
              cage.triangles.size(), cage.positions.front().data(),
              edge.data(),           cage.triangles.front().data(),
              opposite.data()};
  }
};

// Additions, multiplications, divisions and roots for one point, each counted as one; what only points near the cage
// need is left out. Of a vertex: 3 to subtract, 5 for the square, 5 for the unit vector, 3 for the weight. Of an edge:
// 5 for the cosine, 2 for the sine, 27 for the polynomial. Of a face: 27 for the normals, 15 for their sum, 5 for the
// determinant, 4 to divide by it, 18 for the weights.
double operations_per_point(const MeanValueCage& cage) {
  return 16.0 * static_cast<double>(cage.vertices) + 34.0 * static_cast<double>(cage.edges) +
         69.0 * static_cast<double>(cage.faces);
}

// Blocks of neighbours, spread over the million.
std::vector<Position> sample_points(const Mesh& mesh) {
  constexpr std::size_t blocks = 64, block_size = 128;
  std::vector<Position> points;
  for (std::size_t b = 0; b < blocks; ++b) {
    const auto first = mesh.positions.begin() + static_cast<std::ptrdiff_t>(mesh.positions.size() / blocks * b);
    points.insert(points.end(), first, first + block_size);
  }
  return points;
}

void mean_values(benchmark::State& state, SimdLevel level) {
  if (!available(level)) return state.SkipWithError("not available on this machine");
  const KernelCage cage(bodies().cage);
  const std::vector<Position> points = sample_points(bodies().input);
  constexpr std::size_t block_size = 128;
  std::vector<double> rows(block_size * cage.column.size());
  std::vector<ScratchRow> scratch(mean_value_scratch_rows(cage.arrays));
  for (auto _ : state) {
    for (std::size_t i = 0; i < points.size(); i += block_size) {
      find_mean_values({&cage.arrays, block_size, points[i].data(), rows.data(), cage.column.size(), cage.column.data(),
                        scratch.front().number},
                       level);
      benchmark::ClobberMemory();
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
  state.counters["faces"] = static_cast<double>(cage.arrays.faces);
  state.counters["flops"] = benchmark::Counter(operations_per_point(cage.arrays) * static_cast<double>(points.size()),
                                               benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK_CAPTURE(mean_values, scalar, SimdLevel::scalar)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(mean_values, sse2, SimdLevel::sse2)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(mean_values, avx2, SimdLevel::avx2)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(mean_values, avx512, SimdLevel::avx512)->Unit(benchmark::kMillisecond);

// ---------------------------------------------------------------------------------------------------- peak

constexpr int chain_steps = 10000;
constexpr std::size_t chains = 12;  // of each kind: enough to hide latencies, few enough for 16 registers and more

// Half of the chains add, half multiply; a multiplication by one keeps the numbers as they are.
template <class V>
[[gnu::always_inline]] inline void run_chains(double start) {
  V chain[chains];
#pragma GCC unroll 12
  for (V& v : chain) v = V{} + start;
  V one = V{} + 1.0;
  asm("" : "+v"(one));
  for (int step = 0; step < chain_steps; ++step) {
#pragma GCC unroll 12
    for (std::size_t i = 0; i < chains; i += 2) {
      chain[i] = chain[i] + one;
      chain[i + 1] = chain[i + 1] * one;
      asm volatile("" : "+v"(chain[i]), "+v"(chain[i + 1]));
    }
  }
}

[[gnu::noinline]] void chains_sse2() { run_chains<double __attribute__((vector_size(16)))>(1); }
#ifdef __x86_64__
[[gnu::noinline, gnu::target("avx2")]] void chains_avx2() { run_chains<double __attribute__((vector_size(32)))>(1); }
[[gnu::noinline, gnu::target("avx512f")]] void chains_avx512() {
  run_chains<double __attribute__((vector_size(64)))>(1);
}
#endif

void peak(benchmark::State& state, SimdLevel level, void (*run)(), double lanes) {
  if (!available(level)) return state.SkipWithError("not available on this machine");
  for (auto _ : state) run();
  state.counters["flops"] =
      benchmark::Counter(lanes * chains * chain_steps, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK_CAPTURE(peak, sse2, SimdLevel::sse2, chains_sse2, 2);
#ifdef __x86_64__
BENCHMARK_CAPTURE(peak, avx2, SimdLevel::avx2, chains_avx2, 4);
BENCHMARK_CAPTURE(peak, avx512, SimdLevel::avx512, chains_avx512, 8);
#endif

// --------------------------------------------------------------------------------------------------- whole

// A million vertices from the mesh to the deformed mesh, no weights kept.
void deform_in_one_step(benchmark::State& state) {
  const Bodies& all = bodies();
  for (auto _ : state)
    benchmark::DoNotOptimize(deform(all.input, all.cage, all.cage, static_cast<int>(state.range(0))));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(all.input.positions.size()));
}
BENCHMARK(deform_in_one_step)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kSecond);

// Weights of ten vertices of the cage each, and the deformation from them.
void deform_bound_mesh(benchmark::State& state) {
  const Bodies& all = bodies();
  BindOptions options;
  options.keep = 10;
  options.precision = Precision::float32;
  static const CageWeights weights = bind(all.input, all.cage, options);
  for (auto _ : state) benchmark::DoNotOptimize(deform(weights, all.cage, static_cast<int>(state.range(0))));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(weights.vertices));
}
BENCHMARK(deform_bound_mesh)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace prcage::perf
