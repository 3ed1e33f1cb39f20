// What benchmarks have in common: workloads that are made once and kept, loops inside an arena, instruction sets.
#pragma once

#include <benchmark/benchmark.h>

#include <cstdint>

#include "core/simd.h"
#include "perf/workload.h"

namespace prcage::perf {

// The C_0 of a bumpy sphere of 50,000 faces (percent == 100), or its cage at so many percent of the faces, in the cycle
// that the engine reached by then.
Workload& bumpy_workload(std::int64_t percent);

// body() once an iteration, inside an arena of state.range(0) threads.
template <class Body>
void loop_in_arena(benchmark::State& state, const Body& body) {
  in_arena(static_cast<int>(state.range(0)), [&] {
    for (auto _ : state) body();
  });
}

// The same with prepare() before each iteration, off the clock.
template <class Prepare, class Body>
void loop_in_arena(benchmark::State& state, const Prepare& prepare, const Body& body) {
  in_arena(static_cast<int>(state.range(0)), [&] {
    for (auto _ : state) {
      state.PauseTiming();
      prepare();
      state.ResumeTiming();
      body();
    }
  });
}

// Can this processor do that?
bool available(SimdLevel level);

// Things done per second of wall time.
inline benchmark::Counter rate(std::size_t things_per_iteration) {
  return {static_cast<double>(things_per_iteration), benchmark::Counter::kIsIterationInvariantRate};
}

}  // namespace prcage::perf
