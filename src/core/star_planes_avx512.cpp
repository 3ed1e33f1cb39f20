// The planes of stars compiled for AVX-512 (F, CD, DQ, BW, VL), with flags of its own.
#ifdef __x86_64__

#define PRCAGE_ARCH avx512bw
#include "core/star_planes_lanes.h"
#include "core/star_planes_targets.h"

namespace prcage {

void make_star_planes_avx512(const StarArrays& arrays) { make_stars<Lanes>(arrays); }

}  // namespace prcage

#endif
