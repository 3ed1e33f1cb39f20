// Rounding to single precision away from a number, against the standard library.
#include "core/round_outward.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace prcage {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

void expect_next_floats(double x) {
  EXPECT_EQ(float_above(x), std::nextafter(static_cast<float>(x), infinity)) << x;
  EXPECT_EQ(float_below(x), std::nextafter(static_cast<float>(x), -infinity)) << x;
}

TEST(RoundOutward, IsTheNextFloatOnEitherSide) {
  const double tiny = std::numeric_limits<float>::denorm_min(), largest = std::numeric_limits<float>::max();
  for (const double x : {0.0, tiny, 0.1 * tiny, 1.0, 1.0 + 1e-9, 0.1, largest, 1e300, HUGE_VAL}) {
    expect_next_floats(x);
    expect_next_floats(-x);
  }
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> mantissa(-1, 1), exponent(-45, 38);
  for (int i = 0; i < 10000; ++i) expect_next_floats(mantissa(random) * std::pow(10, exponent(random)));
}

TEST(RoundOutward, LosesNothing) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-3, 3);
  for (int i = 0; i < 10000; ++i) {
    const double x = uniform(random);
    EXPECT_GT(float_above(x), x);
    EXPECT_LT(float_below(x), x);
  }
}

}  // namespace
}  // namespace prcage
