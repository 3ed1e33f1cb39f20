// The planes of stars compiled for AVX2, with flags of its own.
#ifdef __x86_64__

#define PRCAGE_ARCH avx2
#include "core/star_planes_lanes.h"
#include "core/star_planes_targets.h"

namespace prcage {

void make_star_planes_avx2(const StarArrays& arrays) { make_stars<Lanes>(arrays); }

}  // namespace prcage

#endif
