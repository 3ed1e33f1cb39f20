// Mean value coordinates compiled for AVX-512 (F, CD, DQ, BW, VL), with flags of its own.
#ifdef __x86_64__

#define PRCAGE_ARCH avx512bw
#include "core/mean_value_kernel.h"
#include "core/mean_value_targets.h"
#include "core/vector_access_xsimd.h"

namespace prcage {

void find_mean_values_avx512(const MeanValueArrays& arrays) { find_mean_values_of<Lanes>(arrays); }

}  // namespace prcage

#endif
