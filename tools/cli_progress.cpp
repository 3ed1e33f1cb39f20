#include "tools/cli_progress.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <string>
#include <utility>

#include <fmt/core.h>

namespace prcage {
namespace {

// All that a signal handler may touch: a lock-free atomic, and through it the atomic flag of the control.
std::atomic<Control*> interruptible{nullptr};
static_assert(std::atomic<Control*>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

void cancel_run(int) {
  if (Control* control = interruptible.load()) control->cancel();
}

void install(int signal, struct sigaction& previous) {
  sigaction(signal, nullptr, &previous);
  if (previous.sa_handler == SIG_IGN) return;
  struct sigaction action {};
  action.sa_handler = &cancel_run;
  action.sa_flags = SA_RESTART | SA_RESETHAND;
  sigaction(signal, &action, nullptr);
}

}  // namespace

InterruptGuard::InterruptGuard(Control& control) {
  interruptible.store(&control);
  install(SIGINT, previous_interrupt_);
  install(SIGTERM, previous_terminate_);
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &previous_interrupt_, nullptr);
  sigaction(SIGTERM, &previous_terminate_, nullptr);
  interruptible.store(nullptr);
}

std::string progress_text(double progress) {
  constexpr std::size_t width = 24;
  const double part = std::clamp(progress, 0.0, 1.0);
  const auto filled = static_cast<std::size_t>(part * width);
  return fmt::format("[{}{}] {:3.0f} %", std::string(filled, '#'), std::string(width - filled, '.'), 100 * part);
}

std::string progress_line(const Control& control, std::size_t levels, int cycles, double seconds) {
  const std::string stage = control.stopped() ? "stopping" : to_string(control.stage());
  const std::string level = levels > 1 ? fmt::format("  level {}/{}", control.level(), levels) : "";
  std::string cycle = control.cycle() > 0 ? fmt::format("  cycle {}", control.cycle()) : "";
  if (!cycle.empty() && cycles > 0) cycle += fmt::format("/{}", cycles);
  return fmt::format("{}{}  {}{}  {} faces  {:.0f} s", progress_text(control.progress()), level, stage, cycle,
                     control.faces(), seconds);
}

ProgressBar::ProgressBar(Line line)
    : line_(std::move(line)), thread_([this](const std::stop_token& stop) { draw_until_stopped(stop); }) {}

ProgressBar::~ProgressBar() {
  thread_.request_stop();
  thread_.join();
  fmt::print(stderr, "\r\x1b[K");
}

void ProgressBar::draw_until_stopped(const std::stop_token& stop) {
  using namespace std::chrono_literals;
  const auto start = std::chrono::steady_clock::now();
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, stop, 100ms, [&stop] { return stop.stop_requested(); })) {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    fmt::print(stderr, "\r{}\x1b[K", line_(elapsed.count()));
  }
}

}  // namespace prcage
