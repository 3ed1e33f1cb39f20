// The process that calls make_cage() keeps its own floating-point state and its own thread limits, and the result does
// not depend on them.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cfenv>
#include <functional>
#include <thread>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include "test_meshes.h"

namespace prcage {
namespace {

using testing::same;

// A thread of its own has no arena of TBB's yet and its own floating-point state.
void in_new_thread(const std::function<void()>& f) { std::thread(f).join(); }

std::size_t thread_limit() { return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism); }

Mesh cage_of(const Mesh& input) {
  Options options;
  options.tau = 1.0 / 20;
  options.cycles = 3;
  options.threads = 2;
  const Result r = make_cage(input, options);
  EXPECT_EQ(r.status, Status::ok) << r.message;
  return r.cage;
}

TEST(Host, ThreadLimitsStayAsTheyAre) {
  const std::size_t before = thread_limit();
  const int concurrency = tbb::this_task_arena::max_concurrency();
  cage_of(testing::shape("bumpy", 500));
  EXPECT_EQ(thread_limit(), before);
  EXPECT_EQ(tbb::this_task_arena::max_concurrency(), concurrency);
}

TEST(Host, ItsOwnThreadLimitHolds) {
  const Mesh input = testing::shape("bumpy", 500);
  const Mesh expected = cage_of(input);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  Options options;
  options.threads = 4;
  const Result r = make_cage(input, options);
  EXPECT_EQ(r.status, Status::ok);
  EXPECT_EQ(r.statistics.threads, 1);
  EXPECT_EQ(thread_limit(), 1u);
  EXPECT_TRUE(same(cage_of(input), expected));
}

TEST(Host, MayCallFromInsideItsOwnParallelLoop) {
  const Mesh input = testing::shape("bumpy", 500);
  const Mesh expected = cage_of(input);
  std::atomic<int> equal{0};
  tbb::parallel_for(0, 4, [&](int) { equal += same(cage_of(input), expected) ? 1 : 0; });
  EXPECT_EQ(equal.load(), 4);
}

#if defined(__SSE2__)

constexpr unsigned flush_bits = 0x8040;  // FTZ and DAZ
constexpr unsigned control_bits = 0xffc0;

TEST(Host, FloatingPointStateOfTheCallerIsRestored) {
  const Mesh input = testing::shape("spikes", 400);
  const unsigned states[] = {0x1f80, 0x1f80 | 0x8000, 0x1f80 | 0x40, 0x1f80 | flush_bits, 0x1f80 | 0x4000};
  for (const unsigned state : states)
    in_new_thread([&] {
      _mm_setcsr(state);
      cage_of(input);
      EXPECT_EQ(_mm_getcsr() & control_bits, state & control_bits);
    });
}

TEST(Host, AHostThatFlushesDenormalsGetsTheSameBits) {
  const Mesh input = testing::shape("spikes", 400);
  const Mesh expected = cage_of(input);
  for (const unsigned bits : {0x8000u, 0x40u, flush_bits})
    in_new_thread([&] {
      _mm_setcsr(0x1f80 | bits);
      EXPECT_TRUE(same(cage_of(input), expected)) << bits;
    });
}

TEST(Host, AHostThatRoundsOtherwiseGetsTheSameBits) {
  const Mesh input = testing::shape("spikes", 400);
  const Mesh expected = cage_of(input);
  for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO})
    in_new_thread([&] {
      std::fesetround(mode);
      EXPECT_TRUE(same(cage_of(input), expected)) << mode;
      EXPECT_EQ(std::fegetround(), mode);
    });
}

TEST(Host, AHostThatTrapsFloatingPointErrorsIsNotTrapped) {
  const Mesh input = testing::shape("bracket", 300);
  const Mesh expected = cage_of(input);
  in_new_thread([&] {
    _mm_setcsr(_mm_getcsr() & ~(0x80u | 0x200u | 0x400u));  // invalid operation, division by zero, overflow
    EXPECT_TRUE(same(cage_of(input), expected));
    _mm_setcsr(0x1f80);
  });
}

// Embree sets the flush bits while it builds; TBB hands a thread's first floating-point state on to all workers.
TEST(Host, ItsNextParallelLoopDoesNotFlushDenormals) {
  const Mesh input = testing::shape("bumpy", 500);
  in_new_thread([&] {
    cage_of(input);
    EXPECT_EQ(_mm_getcsr() & flush_bits, 0u);
    std::atomic<unsigned> seen{0};
    tbb::parallel_for(0, 2000, [&](int) { seen |= _mm_getcsr() & flush_bits; });
    EXPECT_EQ(seen.load(), 0u);
  });
}

#endif

}  // namespace
}  // namespace prcage
