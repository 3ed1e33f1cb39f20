// Random numbers by number: the k-th one is a function of seed, stream and k alone. So threads may draw any of them in
// any order, and the result of a parallel loop does not depend on who drew what.
#pragma once

#include <cstdint>

namespace prcage {

class CounterRandom {
 public:
  CounterRandom(std::uint64_t seed, std::uint64_t stream) : key_(mix(mix(seed) + stream)) {}

  // Uniform in [0, 1): a multiple of 2^-53.
  double uniform(std::uint64_t counter) const {
    return static_cast<double>(mix(key_ + (counter + 1) * golden_ratio) >> 11) * 0x1p-53;
  }

 private:
  static constexpr std::uint64_t golden_ratio = 0x9e3779b97f4a7c15u;

  // The output function of SplitMix64 (Steele, Lea, Flood 2014): a bijection that spreads every bit over all.
  static std::uint64_t mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  }

  std::uint64_t key_;
};

}  // namespace prcage
