// The stages of a round, each on what the stages before it made of the same cage: C_0, where every edge is a candidate,
// and a cage at a fifth of the faces, where most are not. Rates are edges, candidates or patches per second.
#include "parallel/commit.h"
#include "parallel/conflicts.h"
#include "parallel/flips.h"
#include "perf/bench_fixture.h"

namespace prcage::perf {
namespace {

void cages_and_threads(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"threads", "percent"})->ArgsProduct({{1, 2}, {100, 20}});
  benchmark->Unit(benchmark::kMillisecond)->UseRealTime();
}

Workload& workload_of(const benchmark::State& state) { return bumpy_workload(state.range(1)); }

Round round_of(Workload& workload) {
  return in_arena(0, [&] {
    workload.make_dirty();
    return begin_round(workload);
  });
}

// A batch whose patches are all in the race before every iteration.
template <class Body>
void with_fresh_batch(benchmark::State& state, const Body& body) {
  Workload& workload = workload_of(state);
  Round round = round_of(workload);
  PatchBatch& batch = round.batch;
  loop_in_arena(
      state, [&] { std::fill(batch.verdict.begin(), batch.verdict.end(), Verdict::accepted); },
      [&] { body(workload, batch); });
  state.counters["patches"] = rate(batch.size());
}

// Link condition, constraints, QP and cost of all edges.
void evaluate(benchmark::State& state) {
  Workload& workload = workload_of(state);
  Counts counts;
  loop_in_arena(
      state,
      [&] {
        workload.make_dirty();
        counts = {};
      },
      [&] { evaluate_dirty_edges(workload.state, workload.placement, counts); });
  state.counters["edges"] = rate(counts.evaluated);
}
BENCHMARK(evaluate)->Apply(cages_and_threads);

void select(benchmark::State& state) {
  Workload& workload = workload_of(state);
  const Round round = round_of(workload);
  std::vector<std::uint8_t>& reselect = workload.state.reselect;
  loop_in_arena(
      state, [&] { std::fill(reselect.begin(), reselect.end(), std::uint8_t{1}); },
      [&] { benchmark::DoNotOptimize(select_independent_collapses(workload.state, {})); });
  state.counters["edges"] = rate(workload.state.live_faces * 3 / 2);
  state.counters["selected"] = static_cast<double>(round.selected.size());
}
BENCHMARK(select)->Apply(cages_and_threads);

void place(benchmark::State& state) {
  Workload& workload = workload_of(state);
  const Round round = round_of(workload);
  loop_in_arena(state,
                [&] { benchmark::DoNotOptimize(place_collapses(workload.state, workload.placement, round.selected)); });
  state.counters["candidates"] = rate(round.selected.size());
}
BENCHMARK(place)->Apply(cages_and_threads);

void build(benchmark::State& state) {
  Workload& workload = workload_of(state);
  const Round round = round_of(workload);
  loop_in_arena(
      state, [&] { benchmark::DoNotOptimize(build_collapses(workload.state, workload.tree.frame(), round.placed)); });
  state.counters["patches"] = rate(round.batch.size());
}
BENCHMARK(build)->Apply(cages_and_threads);

void local_tests(benchmark::State& state) {
  with_fresh_batch(state, [](Workload& workload, PatchBatch& batch) { test_patches_locally(workload.state, batch); });
}
BENCHMARK(local_tests)->Apply(cages_and_threads);

BandLimits limits_of(const Workload& workload) {
  BandLimits limits;
  limits.centroids = limits.reach = workload.placement.band.outer;
  return limits;
}

// After the first iteration with the memo of the band full.
void band_test(benchmark::State& state) {
  with_fresh_batch(state, [](Workload& workload, PatchBatch& batch) {
    test_patches_against_band(workload.state, workload.band, limits_of(workload), batch);
  });
}
BENCHMARK(band_test)->Apply(cages_and_threads);

void collide_with_cage(benchmark::State& state) {
  with_fresh_batch(state, [](Workload& workload, PatchBatch& batch) {
    reject_hits_on_cage(workload.state, workload.device, batch);
  });
}
BENCHMARK(collide_with_cage)->Apply(cages_and_threads);

void collide_with_each_other(benchmark::State& state) {
  with_fresh_batch(
      state, [](Workload& workload, PatchBatch& batch) { reject_conflicts(workload.state, workload.device, batch); });
}
BENCHMARK(collide_with_each_other)->Apply(cages_and_threads);

// A batch that passed all tests, on a fresh copy of the cage.
void commit(benchmark::State& state) {
  Workload& workload = workload_of(state);
  Round round = round_of(workload);
  PatchBatch& batch = round.batch;
  in_arena(0, [&] {
    test_patches_locally(workload.state, batch);
    test_patches_against_band(workload.state, workload.band, limits_of(workload), batch);
    reject_hits_on_cage(workload.state, workload.device, batch);
    reject_conflicts(workload.state, workload.device, batch);
  });
  CageState cage;
  loop_in_arena(
      state, [&] { cage = workload.state; }, [&] { commit_collapses(cage, batch); });
  state.counters["patches"] = rate(batch.size());
}
BENCHMARK(commit)->Apply(cages_and_threads);

// Along the space-filling curve, as at the beginning of a cycle.
void sort(benchmark::State& state) {
  Workload& workload = workload_of(state);
  CageState cage;
  loop_in_arena(
      state, [&] { cage = workload.state; }, [&] { sort_along_curve(cage); });
  state.counters["faces"] = rate(workload.state.live_faces);
}
BENCHMARK(sort)->Apply(cages_and_threads);

// All rounds of flips after a cycle, on a fresh copy of the cage.
void flip(benchmark::State& state) {
  Workload& workload = workload_of(state);
  CageState cage;
  Counts counts;
  loop_in_arena(
      state,
      [&] {
        cage = workload.state;
        counts = {};
      },
      [&] {
        flip_edges(cage, {limits_of(workload), 0}, workload.tree.frame(), workload.device, workload.band, nullptr,
                   counts);
      });
  state.counters["tried"] = rate(counts.flips_tried);
}
BENCHMARK(flip)->Apply(cages_and_threads);

}  // namespace
}  // namespace prcage::perf
