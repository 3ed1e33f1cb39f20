// The instruction set of the vectorised kernels, chosen when the program runs. Results do not depend on it.
#pragma once

#include <span>
#include <string_view>

namespace prcage {

// Each contains the ones before. avx512 stands for F, CD, DQ, BW and VL. On processors other than x86-64 there is only
// scalar.
enum class SimdLevel { scalar, sse2, avx2, avx512 };

// As spelt in PRCAGE_SIMD and in reports.
std::string_view name_of(SimdLevel level);

// What this CPU and its operating system support, from scalar to the best.
std::span<const SimdLevel> available_simd_levels();

// The level that a name asks for, or `best` if that is less or nothing has that name.
SimdLevel parse_simd_level(std::string_view name, SimdLevel best);

// The best available level, or a lesser one that the environment variable PRCAGE_SIMD names. Read once.
SimdLevel simd_level();

}  // namespace prcage
