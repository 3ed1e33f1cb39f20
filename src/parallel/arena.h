// The threads of a run. Every parallel part of prcage, Embree's included, runs inside an arena of its own: the
// host's thread limits stay as they are, and the floating-point state that Embree sets while it builds (denormals
// flushed to zero) cannot reach the workers that evaluate exact predicates.
#pragma once

#include <tbb/task_arena.h>

namespace prcage {

class Arena {
 public:
  // threads <= 0: as many as the machine has; never more than TBB's limit in this process.
  explicit Arena(int threads);

  int threads() const { return threads_; }

  // Runs f in the default floating-point state on the calling thread and on every worker, and restores the caller's.
  template <class F>
  void run(F&& f) {
    const FloatState state;
    arena_.execute(f);
  }

 private:
  // Denormals live, rounding to nearest, no traps for its lifetime.
  class FloatState {
   public:
    FloatState();
    ~FloatState();
    FloatState(const FloatState&) = delete;
    FloatState& operator=(const FloatState&) = delete;

   private:
    unsigned saved_;
  };

  int threads_;
  tbb::task_arena arena_;
};

}  // namespace prcage
