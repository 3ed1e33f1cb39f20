#include "parallel/parallel_for.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace prcage {

void run_chunks(std::size_t n, std::size_t grain, const void* body, ChunkCall call) {
  if (n == 0) return;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, grain),
                    [&](const tbb::blocked_range<std::size_t>& range) { call(body, range.begin(), range.end()); });
}

}  // namespace prcage
