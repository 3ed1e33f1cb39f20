// The batch solver for each instruction set; only one that the CPU has may be called.
#pragma once

#include "core/qp3_problem.h"

namespace prcage {

void solve_qp3_batch_sse2(const QpBatchArrays& batch);
void solve_qp3_batch_avx2(const QpBatchArrays& batch);
void solve_qp3_batch_avx512(const QpBatchArrays& batch);

}  // namespace prcage
