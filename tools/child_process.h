// Runs this program again as a child: with limits on its time and memory, its streams in files, and never longer than
// its parent.
#pragma once

#include <chrono>
#include <csignal>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace prcage {

struct ChildCommand {
  std::vector<std::string> arguments;    // without the name of the program
  std::string out;                       // file for its standard output
  std::string err;                       // file for its standard error
  std::uint64_t memory_limit_bytes = 0;  // of its address space; 0: none
  double timeout_seconds = 0;            // 0: none
};

struct ChildEnd {
  int exit_code = 0;       // meaningful if signal is 0
  int signal = 0;          // that ended it
  bool timed_out = false;  // it was told to end
  std::uint64_t peak_memory_bytes = 0;
  double seconds = 0;
};

// One run of this program. The child leads a process group of its own, so that a Ctrl-C on the terminal reaches the
// parent alone, and the kernel kills it if the parent dies. Not for several threads.
class ChildProcess {
 public:
  // Throws std::system_error if there can be no child. A failure to become the program is exit code 127.
  explicit ChildProcess(const ChildCommand& command);
  // Kills a child that still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // How the child ended, once and as soon as it did. To be called often: it is this call that ends a child whose time
  // is over, at first by SIGTERM and two seconds later by SIGKILL.
  std::optional<ChildEnd> poll();

 private:
  void enforce_timeout();
  void kill_group(int signal) const;

  using Clock = std::chrono::steady_clock;

  pid_t id_ = 0;  // 0: ended
  Clock::time_point start_;
  std::chrono::duration<double> timeout_;
  bool terminated_ = false;
  bool killed_ = false;
};

// Between construction and destruction, SIGINT, SIGTERM, SIGHUP and the end of a child do nothing by themselves but
// wait to be asked for. A signal that was ignored before (nohup) stays so. Threads that are started meanwhile inherit
// this; children do not.
class SignalWait {
 public:
  SignalWait();
  ~SignalWait();
  SignalWait(const SignalWait&) = delete;
  SignalWait& operator=(const SignalWait&) = delete;

  // Sleeps until a child ended or for this long. True if the program is asked to stop instead.
  bool stop_requested_within(std::chrono::milliseconds time) const;

 private:
  sigset_t awaited_{};
  sigset_t previous_{};
};

}  // namespace prcage
