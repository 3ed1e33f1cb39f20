// Broad phase: building Embree's trees of boxes, and pairs per second of a join.
#include <tbb/enumerable_thread_specific.h>

#include <functional>

#include "parallel/box_tree.h"
#include "parallel/intersections.h"
#include "perf/bench_fixture.h"

namespace prcage::perf {
namespace {

void build_tree(benchmark::State& state, TreeQuality quality) {
  const Workload& workload = bumpy_workload(100);
  BoxTree tree(workload.device);
  loop_in_arena(state, [&] { tree.build(workload.state.face_box, quality); });
  state.counters["boxes"] = rate(workload.state.face_box.size());
}
BENCHMARK_CAPTURE(build_tree, fast_build, TreeQuality::fast_build)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime();
BENCHMARK_CAPTURE(build_tree, fast_query, TreeQuality::fast_query)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime();

// The loop of a join of two trees: pairs are counted by each thread for itself.
template <class Join>
void count_pairs(benchmark::State& state, const Join& join_trees) {
  using Counter = tbb::enumerable_thread_specific<std::size_t>;
  std::size_t pairs = 0;
  loop_in_arena(state, [&] {
    Counter counter(std::size_t{0});
    join_trees([&counter](std::uint32_t, std::uint32_t) { ++counter.local(); });
    pairs = counter.combine(std::plus<>());
  });
  state.counters["pairs"] = rate(pairs);
}

void join_with_itself(benchmark::State& state) {
  const Workload& workload = bumpy_workload(100);
  BoxTree tree(workload.device);
  in_arena(1, [&] { tree.build(workload.state.face_box, TreeQuality::fast_build); });
  count_pairs(state, [&](const auto& visit) { self_join(tree, visit); });
}
BENCHMARK(join_with_itself)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime();

// The input and its C_0 lie as close to each other as surfaces can.
void join_of_cage_and_input(benchmark::State& state) {
  const Workload& workload = bumpy_workload(100);
  BoxTree tree(workload.device);
  in_arena(1, [&] { tree.build(workload.state.face_box, TreeQuality::fast_build); });
  count_pairs(state, [&](const auto& visit) { join(tree, workload.tree.runs(), visit); });
}
BENCHMARK(join_of_cage_and_input)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime();

// Join and exact tests together, as validation and the certificate do it.
void self_intersections_of_input(benchmark::State& state) {
  const Workload& workload = bumpy_workload(100);
  loop_in_arena(state, [&] { benchmark::DoNotOptimize(self_intersections(workload.tree).count); });
  state.counters["faces"] = rate(workload.input.triangles.size());
}
BENCHMARK(self_intersections_of_input)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime();

}  // namespace
}  // namespace prcage::perf
