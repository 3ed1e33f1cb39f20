#include "core/mean_value.h"

#include "core/mean_value_kernel.h"
#include "core/mean_value_targets.h"

namespace prcage {

void find_mean_values(const MeanValueArrays& arrays, SimdLevel level) {
  switch (level) {
#ifdef __x86_64__
    case SimdLevel::sse2:
      return find_mean_values_sse2(arrays);
    case SimdLevel::avx2:
      return find_mean_values_avx2(arrays);
    case SimdLevel::avx512:
      return find_mean_values_avx512(arrays);
#endif
    default:
      return find_mean_values_of<double>(arrays);
  }
}

}  // namespace prcage
