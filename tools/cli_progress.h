// What a person sees and does while a run goes on: a progress bar on the terminal, and Ctrl-C.
#pragma once

#include <condition_variable>
#include <csignal>
#include <mutex>
#include <thread>

#include "core/prcage.h"

namespace prcage {

// From construction to destruction, the first SIGINT or SIGTERM cancels the run and the second one of a kind ends
// the process as if nobody listened. A signal that was ignored before (nohup) stays ignored. One at a time.
class InterruptGuard {
 public:
  explicit InterruptGuard(Control& control);
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

 private:
  struct sigaction previous_interrupt_ {};
  struct sigaction previous_terminate_ {};
};

// Redraws one line on standard error from a thread of its own and clears it when it is destroyed.
class ProgressBar {
 public:
  ProgressBar(const Control& control, int cycles);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

 private:
  void draw_until_stopped(const std::stop_token& stop);

  const Control& control_;
  int cycles_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;  // last: it uses the members above
};

}  // namespace prcage
