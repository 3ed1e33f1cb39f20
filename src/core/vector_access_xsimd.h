// Access to the vectors of one instruction set, PRCAGE_ARCH as xsimd names it. For the sources of kernels only.
#pragma once

#include <xsimd/xsimd.hpp>

#include "core/vector_access.h"

namespace prcage {
namespace {

using Lanes = xsimd::batch<double, xsimd::PRCAGE_ARCH>;

template <>
struct Access<Lanes> {
  static constexpr std::size_t width = Lanes::size;
  static Lanes load(const double* from) { return Lanes::load_unaligned(from); }
  static void store(const Lanes& value, double* to) { value.store_unaligned(to); }
  static Lanes lane_numbers() {
    alignas(64) static constexpr double numbers[most_lanes] = {0, 1, 2, 3, 4, 5, 6, 7};
    return Lanes::load_aligned(numbers);
  }
};

}  // namespace
}  // namespace prcage
