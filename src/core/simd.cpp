#include "core/simd.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace prcage {
namespace {

constexpr std::array all_levels{SimdLevel::scalar, SimdLevel::sse2, SimdLevel::avx2, SimdLevel::avx512};

// The compiler's own test also asks whether the operating system saves the wide registers.
SimdLevel best_level() {
#ifdef __x86_64__
  __builtin_cpu_init();
  if (!__builtin_cpu_supports("avx2")) return SimdLevel::sse2;
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
                      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
                      __builtin_cpu_supports("avx512vl");
  return avx512 ? SimdLevel::avx512 : SimdLevel::avx2;
#else
  return SimdLevel::scalar;
#endif
}

}  // namespace

std::string_view name_of(SimdLevel level) {
  switch (level) {
    case SimdLevel::scalar:
      return "scalar";
    case SimdLevel::sse2:
      return "sse2";
    case SimdLevel::avx2:
      return "avx2";
    case SimdLevel::avx512:
      return "avx512";
  }
  return "";
}

std::span<const SimdLevel> available_simd_levels() {
  static const SimdLevel best = best_level();
  return std::span(all_levels).first(static_cast<std::size_t>(best) + 1);
}

SimdLevel parse_simd_level(std::string_view name, SimdLevel best) {
  const auto named = [name](SimdLevel level) { return name_of(level) == name; };
  const auto found = std::find_if(all_levels.begin(), all_levels.end(), named);
  return found == all_levels.end() ? best : std::min(*found, best);
}

SimdLevel simd_level() {
  static const SimdLevel level = [] {
    const SimdLevel best = available_simd_levels().back();
    const char* name = std::getenv("PRCAGE_SIMD");
    return name == nullptr ? best : parse_simd_level(name, best);
  }();
  return level;
}

}  // namespace prcage
