// What the public functions that take options have round their work: the options are looked at first, threads belong to
// an arena, nothing but std::bad_alloc is thrown, and time and memory are taken down.
#pragma once

#include <sys/resource.h>

#include <exception>
#include <new>
#include <string>

#include "core/mesh_view.h"
#include "core/simd.h"
#include "parallel/arena.h"
#include "parallel/stopwatch.h"

namespace prcage {

inline std::uint64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

// Calls run(result) unless there is an error in the options. `AnyResult` has a status, a message and statistics.
template <class AnyResult, class Run>
AnyResult run_safely(const MeshView& input, const std::string& options_error, int threads, const Run& run) {
  AnyResult result;
  Statistics& s = result.statistics;
  s.input_vertices = input.vertex_count;
  s.input_faces = input.triangle_count;
  s.simd = name_of(simd_level());
  if (!options_error.empty()) {
    result.status = Status::invalid_options;
    result.message = options_error;
    return result;
  }
  {
    const Stopwatch watch(s.seconds.total);
    try {
      Arena arena(threads);
      s.threads = arena.threads();
      arena.run([&] { run(result); });
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& e) {
      result = AnyResult{};
      result.message = e.what();
    }
  }
  result.statistics.peak_memory_bytes = peak_memory_bytes();
  return result;
}

}  // namespace prcage
