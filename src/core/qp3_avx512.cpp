// The batch solver compiled for AVX-512 (F, CD, DQ, BW, VL), with flags of its own.
#ifdef __x86_64__

#define PRCAGE_ARCH avx512bw
#include "core/qp3_lanes.h"
#include "core/qp3_targets.h"

namespace prcage {

void solve_qp3_batch_avx512(const QpBatchArrays& batch) { solve_in_lanes(batch); }

}  // namespace prcage

#endif
