#include "core/qp3_batch.h"

#include <cassert>

#include "core/qp3_kernel.h"
#include "core/qp3_targets.h"

namespace prcage {
namespace {

// The kernels read both as plain numbers.
static_assert(sizeof(Symmetric3) == 6 * sizeof(double) && sizeof(Vec3) == 3 * sizeof(double));

QpBatchArrays arrays_of(const Qp3Batch& batch, double tolerance, std::span<Vec3> x, std::span<QpStatus> status) {
  return {batch.size(),
          &batch.form[0].xx,
          batch.linear[0].data(),
          batch.first_row.data(),
          batch.row_length.data(),
          batch.rows.data(),
          tolerance,
          x[0].data(),
          status.data()};
}

void solve_one_by_one(const Qp3Batch& batch, const QpBatchArrays& arrays, std::span<Vec3> x) {
  for (std::size_t i = 0; i < batch.size(); ++i)
    arrays.status[i] = solve_qp3(batch.form[i], batch.linear[i], slabs_of(arrays, i), arrays.tolerance, x[i]);
}

}  // namespace

void solve_qp3_batch(const Qp3Batch& batch, double tolerance, std::span<Vec3> x, std::span<QpStatus> status,
                     SimdLevel level) {
  if (batch.size() == 0) return;
  assert(batch.linear.size() == batch.size() && batch.first_row.size() == batch.size() &&
         batch.row_length.size() == batch.size());
  assert(x.size() >= batch.size() && status.size() >= batch.size());
  const QpBatchArrays arrays = arrays_of(batch, tolerance, x, status);
  switch (level) {
#ifdef __x86_64__
    case SimdLevel::sse2:
      return solve_qp3_batch_sse2(arrays);
    case SimdLevel::avx2:
      return solve_qp3_batch_avx2(arrays);
    case SimdLevel::avx512:
      return solve_qp3_batch_avx512(arrays);
#endif
    default:
      return solve_one_by_one(batch, arrays, x);
  }
}

}  // namespace prcage
