#include "parallel/arena.h"

#include <tbb/parallel_for.h>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace prcage {
namespace {

#if defined(__SSE2__)
constexpr unsigned flush_bits = 0x8040;  // FTZ and DAZ of MXCSR
unsigned float_state() { return _mm_getcsr(); }
void set_float_state(unsigned state) { _mm_setcsr(state); }
#else
constexpr unsigned flush_bits = 0;
unsigned float_state() { return 0; }
void set_float_state(unsigned) {}
#endif

int resolve(int threads) { return threads > 0 ? threads : tbb::this_task_arena::max_concurrency(); }

}  // namespace

Arena::FloatState::FloatState() : saved_(float_state()) { set_float_state(saved_ & ~flush_bits); }
Arena::FloatState::~FloatState() { set_float_state(saved_); }

Arena::Arena(int threads) : threads_(resolve(threads)), arena_(threads_) {
  // An arena keeps the floating-point state of the thread that first runs work in it, so that has to happen
  // before Embree changes the state.
  run([] { tbb::parallel_for(0, 1, [](int) {}); });
}

}  // namespace prcage
