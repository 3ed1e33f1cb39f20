// The batch solver compiled for SSE2.
#ifdef __x86_64__

#define PRCAGE_ARCH sse2
#include "core/qp3_lanes.h"
#include "core/qp3_targets.h"

namespace prcage {

void solve_qp3_batch_sse2(const QpBatchArrays& batch) { solve_in_lanes(batch); }

}  // namespace prcage

#endif
