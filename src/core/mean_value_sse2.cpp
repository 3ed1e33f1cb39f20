// Mean value coordinates compiled for SSE2.
#ifdef __x86_64__

#define PRCAGE_ARCH sse2
#include "core/mean_value_kernel.h"
#include "core/mean_value_targets.h"
#include "core/vector_access_xsimd.h"

namespace prcage {

void find_mean_values_sse2(const MeanValueArrays& arrays) { find_mean_values_of<Lanes>(arrays); }

}  // namespace prcage

#endif
