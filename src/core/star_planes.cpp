#include "core/star_planes.h"

#include "core/star_planes_kernel.h"
#include "core/star_planes_targets.h"

namespace prcage {

void make_star_planes(const StarArrays& arrays, SimdLevel level) {
  switch (level) {
#ifdef __x86_64__
    case SimdLevel::sse2:
      return make_star_planes_sse2(arrays);
    case SimdLevel::avx2:
      return make_star_planes_avx2(arrays);
    case SimdLevel::avx512:
      return make_star_planes_avx512(arrays);
#endif
    default:
      return make_stars<double>(arrays);
  }
}

}  // namespace prcage
