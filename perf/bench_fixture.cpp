#include "perf/bench_fixture.h"

#include <algorithm>
#include <map>
#include <memory>

namespace prcage::perf {

Workload& bumpy_workload(std::int64_t percent) {
  // Never destroyed: at the end of the process the libraries behind it may be gone already.
  static auto& workloads = *new std::map<std::int64_t, std::unique_ptr<Workload>>;
  std::unique_ptr<Workload>& workload = workloads[percent];
  if (!workload) {
    in_arena(0, [&] {
      workload = std::make_unique<Workload>("bumpy", 50000);
      if (percent < 100)
        workload->simplify_to(workload->input.triangles.size() * static_cast<std::size_t>(percent) / 100);
    });
  }
  return *workload;
}

bool available(SimdLevel level) {
  const auto levels = available_simd_levels();
  return std::find(levels.begin(), levels.end(), level) != levels.end();
}

}  // namespace prcage::perf
