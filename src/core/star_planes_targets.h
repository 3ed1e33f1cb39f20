// The maker of planes for each instruction set; only one that the CPU has may be called.
#pragma once

#include "core/star_planes_problem.h"

namespace prcage {

void make_star_planes_sse2(const StarArrays& arrays);
void make_star_planes_avx2(const StarArrays& arrays);
void make_star_planes_avx512(const StarArrays& arrays);

}  // namespace prcage
