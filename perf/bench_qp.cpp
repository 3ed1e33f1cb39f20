// The QP solver on problems recorded from real runs: one by one and as a batch, by instruction set and number of
// planes. The file is the one that the build made, or the one named by the environment variable PRCAGE_QP_FILE.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <vector>

#include "core/qp3_batch.h"
#include "perf/bench_fixture.h"
#include "perf/qp_file.h"

namespace prcage::perf {
namespace {

const QpProblems& all_problems() {
  static const QpProblems problems = [] {
    const char* path = std::getenv("PRCAGE_QP_FILE");
    return read_qps(path != nullptr ? path : PRCAGE_QP_FILE);
  }();
  return problems;
}

// Problems with more planes than the bucket below and at most `most`; 0 stands for all problems.
constexpr std::array<std::size_t, 7> buckets{16, 20, 24, 28, 32, 40, 64};

QpProblems problems_of(std::size_t most) {
  const QpProblems& all = all_problems();
  if (most == 0) return all;
  std::size_t least = 0;
  for (const std::size_t bucket : buckets)
    if (bucket < most) least = bucket + 1;
  QpProblems problems;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.plane_count[i] >= least && all.plane_count[i] <= most)
      problems.add(all.form[i], all.linear[i], all.planes(i), all.plane_count[i]);
  return problems;
}

void plane_counts(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("planes")->Arg(0);
  for (const std::size_t bucket : buckets) benchmark->Arg(static_cast<std::int64_t>(bucket));
}

void describe(benchmark::State& state, const QpProblems& problems, std::size_t solved) {
  const auto count = static_cast<double>(problems.size());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(problems.size()));
  state.counters["problems"] = count;
  state.counters["mean_planes"] = static_cast<double>(problems.all_planes()) / count;
  state.counters["feasible"] = static_cast<double>(solved) / count;
}

// The tolerance of solve_placements().
constexpr double tolerance = 1e-10;

void qp_one_by_one(benchmark::State& state) {
  const QpProblems problems = problems_of(static_cast<std::size_t>(state.range(0)));
  if (problems.size() == 0) return state.SkipWithError("no problem of that size was recorded");
  std::size_t solved = 0;
  for (auto _ : state) {
    solved = 0;
    for (std::size_t i = 0; i < problems.size(); ++i) {
      Vec3 x;
      const QpStatus status = solve_qp3(problems.form[i], problems.linear[i], problems.planes(i), tolerance, x);
      if (status == QpStatus::solved) ++solved;
      benchmark::DoNotOptimize(x);
    }
  }
  describe(state, problems, solved);
}
BENCHMARK(qp_one_by_one)->Apply(plane_counts);

constexpr std::size_t batch_size = 768;  // the largest of evaluate_dirty_edges()

// What a batch writes.
struct Solutions {
  std::vector<Vec3> x;
  std::vector<QpStatus> status;

  explicit Solutions(std::size_t problems) : x(problems), status(problems) {}
  void solve(const Qp3Batch& batch, std::size_t first, SimdLevel level) {
    solve_qp3_batch(batch, tolerance, std::span(x).subspan(first, batch.size()),
                    std::span(status).subspan(first, batch.size()), level);
  }
  std::size_t solved() const {
    return static_cast<std::size_t>(std::count(status.begin(), status.end(), QpStatus::solved));
  }
};

Qp3Batch batch_of(const QpProblems& problems, std::size_t first) {
  const std::size_t count = std::min(batch_size, problems.size() - first);
  return {std::span(problems.form).subspan(first, count), std::span(problems.linear).subspan(first, count),
          std::span(problems.first_row).subspan(first, count), std::span(problems.row_length).subspan(first, count),
          problems.rows};
}

void all_on_own_clock(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("planes")->Arg(0)->UseManualTime();
}

// One batch after the other through all problems: their planes come from memory.
void qp_batch(benchmark::State& state, SimdLevel level) {
  if (!available(level)) return state.SkipWithError("not available on this machine");
  const QpProblems problems = problems_of(static_cast<std::size_t>(state.range(0)));
  if (problems.size() == 0) return state.SkipWithError("no problem of that size was recorded");
  Solutions solutions(problems.size());
  for (auto _ : state) {
    for (std::size_t i = 0; i < problems.size(); i += batch_size) solutions.solve(batch_of(problems, i), i, level);
    benchmark::ClobberMemory();
  }
  describe(state, problems, solutions.solved());
}

// As the engine solves them: the planes of a batch have just been written, always to the same place. Off the clock,
// which runs for each batch by itself.
void qp_batch_written(benchmark::State& state, SimdLevel level) {
  using Clock = std::chrono::steady_clock;
  if (!available(level)) return state.SkipWithError("not available on this machine");
  const QpProblems problems = problems_of(static_cast<std::size_t>(state.range(0)));
  if (problems.size() == 0) return state.SkipWithError("no problem of that size was recorded");
  Solutions solutions(problems.size());
  QpProblems written;
  for (auto _ : state) {
    Clock::duration spent{0};
    for (std::size_t i = 0; i < problems.size(); i += batch_size) {
      written.clear();
      for (std::size_t k = i; k < std::min(i + batch_size, problems.size()); ++k)
        written.add(problems.form[k], problems.linear[k], problems.planes(k), problems.plane_count[k]);
      const auto start = Clock::now();
      solutions.solve(batch_of(written, 0), i, level);
      spent += Clock::now() - start;
    }
    state.SetIterationTime(std::chrono::duration<double>(spent).count());
  }
  describe(state, problems, solutions.solved());
}

BENCHMARK_CAPTURE(qp_batch, scalar, SimdLevel::scalar)->Apply(plane_counts);
BENCHMARK_CAPTURE(qp_batch, sse2, SimdLevel::sse2)->Apply(plane_counts);
BENCHMARK_CAPTURE(qp_batch, avx2, SimdLevel::avx2)->Apply(plane_counts);
BENCHMARK_CAPTURE(qp_batch, avx512, SimdLevel::avx512)->Apply(plane_counts);
BENCHMARK_CAPTURE(qp_batch_written, scalar, SimdLevel::scalar)->Apply(all_on_own_clock);
BENCHMARK_CAPTURE(qp_batch_written, sse2, SimdLevel::sse2)->Apply(all_on_own_clock);
BENCHMARK_CAPTURE(qp_batch_written, avx2, SimdLevel::avx2)->Apply(all_on_own_clock);
BENCHMARK_CAPTURE(qp_batch_written, avx512, SimdLevel::avx512)->Apply(all_on_own_clock);

}  // namespace
}  // namespace prcage::perf
