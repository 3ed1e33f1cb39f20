#include "parallel/arena.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace prcage {
namespace {

#if defined(__SSE2__)
constexpr unsigned default_state = 0x1f80;  // of MXCSR: no flushing, rounding to nearest, nothing traps
unsigned float_state() { return _mm_getcsr(); }
void set_float_state(unsigned state) { _mm_setcsr(state); }
#else
constexpr unsigned default_state = 0;
unsigned float_state() { return 0; }
void set_float_state(unsigned) {}
#endif

// More than the process allows would only make TBB complain; the limit itself is the host's.
int resolve(int threads) {
  if (threads <= 0) return tbb::this_task_arena::max_concurrency();
  const auto limit = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::min(threads, static_cast<int>(limit));
}

}  // namespace

Arena::FloatState::FloatState() : saved_(float_state()) { set_float_state(default_state); }
Arena::FloatState::~FloatState() { set_float_state(saved_); }

Arena::Arena(int threads) : threads_(resolve(threads)), arena_(threads_) {
  // An arena keeps the floating-point state of the thread that first runs work in it, so that has to happen
  // before Embree changes the state.
  run([] { tbb::parallel_for(0, 1, [](int) {}); });
}

}  // namespace prcage
