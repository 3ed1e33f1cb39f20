// What a person sees and does while a run goes on: a progress bar on the terminal, and Ctrl-C.
#pragma once

#include <condition_variable>
#include <csignal>
#include <functional>
#include <mutex>
#include <string>
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
  // The line, given the seconds since the start. Called by the thread.
  using Line = std::function<std::string(double)>;

  explicit ProgressBar(Line line);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

 private:
  void draw_until_stopped(const std::stop_token& stop);

  Line line_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;  // last: it uses the members above
};

// "[######......]  50 %" for a progress of 0 to 1.
std::string progress_text(double progress);

// The line of a run with these numbers of levels and cycles; 0: not known beforehand.
std::string progress_line(const Control& control, std::size_t levels, int cycles, double seconds);

}  // namespace prcage
