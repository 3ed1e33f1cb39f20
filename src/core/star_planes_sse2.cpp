// The planes of stars compiled for SSE2.
#ifdef __x86_64__

#define PRCAGE_ARCH sse2
#include "core/star_planes_lanes.h"
#include "core/star_planes_targets.h"

namespace prcage {

void make_star_planes_sse2(const StarArrays& arrays) { make_stars<Lanes>(arrays); }

}  // namespace prcage

#endif
