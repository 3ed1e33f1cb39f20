// Random numbers for tests of the numeric kernels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>

#include "test_meshes.h"

namespace prcage::testing {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine_); }
  std::size_t below(std::size_t n) { return engine_() % n; }
  Vec3 unit() { return random_unit(engine_); }
  std::mt19937_64& engine() { return engine_; }

 private:
  std::mt19937_64 engine_;
};

}  // namespace prcage::testing
