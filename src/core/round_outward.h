// Single-precision numbers beyond double-precision ones, for bounds that must not lose anything to rounding.
#pragma once

#include <bit>
#include <cstdint>

namespace prcage {

// The number after, or before, the one nearest to x: never equal to x unless that is infinite. As std::nextafter gives
// it, without a call for each.
inline float float_above(double x) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(x) + 0.0f);  // no negative zero
  constexpr std::uint32_t infinity = 0x7f800000;
  return std::bit_cast<float>(bits >> 31 != 0 ? bits - 1 : bits + (bits < infinity ? 1 : 0));
}
inline float float_below(double x) { return -float_above(-x); }

}  // namespace prcage
