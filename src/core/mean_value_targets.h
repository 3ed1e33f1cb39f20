// Mean value coordinates for each instruction set; only one that the CPU has may be called.
#pragma once

#include "core/mean_value_problem.h"

namespace prcage {

void find_mean_values_sse2(const MeanValueArrays& arrays);
void find_mean_values_avx2(const MeanValueArrays& arrays);
void find_mean_values_avx512(const MeanValueArrays& arrays);

}  // namespace prcage
