#include "tools/child_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace prcage {
namespace {

constexpr int cannot_become_program = 127;  // as shells say it

void limit(int resource, rlim_t most) {
  const rlimit limits{most, most};
  if (setrlimit(static_cast<__rlimit_resource>(resource), &limits) != 0) _exit(cannot_become_program);
}

void redirect(int descriptor, const char* path, int flags) {
  const int file = open(path, flags, 0666);
  if (file < 0 || dup2(file, descriptor) < 0) _exit(cannot_become_program);
  close(file);
}

// Between fork and exec only what is safe in a signal handler may be called: the parent may have other threads.
[[noreturn]] void become_program(const ChildCommand& command, char* const* arguments, pid_t parent) noexcept {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(cannot_become_program);  // it died before the line above
  redirect(STDIN_FILENO, "/dev/null", O_RDONLY);
  redirect(STDOUT_FILENO, command.out.c_str(), O_WRONLY | O_CREAT | O_TRUNC);
  redirect(STDERR_FILENO, command.err.c_str(), O_WRONLY | O_CREAT | O_TRUNC);
  limit(RLIMIT_CORE, 0);  // thousands of meshes may crash
  if (command.memory_limit_bytes > 0) limit(RLIMIT_AS, command.memory_limit_bytes);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  execv("/proc/self/exe", arguments);
  _exit(cannot_become_program);
}

pid_t start(const ChildCommand& command) {
  std::vector<std::string> words{"prcage"};
  words.insert(words.end(), command.arguments.begin(), command.arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "cannot start a process");
  if (child == 0) become_program(command, pointers.data(), parent);
  setpgid(child, child);  // whoever of the two comes first
  return child;
}

}  // namespace

ChildProcess::ChildProcess(const ChildCommand& command)
    : id_(start(command)), start_(Clock::now()), timeout_(command.timeout_seconds) {}

ChildProcess::~ChildProcess() {
  if (id_ == 0) return;
  kill_group(SIGKILL);
  while (waitpid(id_, nullptr, 0) < 0 && errno == EINTR) continue;
}

std::optional<ChildEnd> ChildProcess::poll() {
  int status = 0;
  rusage usage{};
  if (wait4(id_, &status, WNOHANG, &usage) != id_) {
    enforce_timeout();
    return std::nullopt;
  }
  id_ = 0;
  ChildEnd end;
  end.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  end.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
  end.timed_out = terminated_;
  end.peak_memory_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
  end.seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  return end;
}

void ChildProcess::enforce_timeout() {
  if (timeout_.count() == 0) return;
  constexpr std::chrono::seconds grace(2);
  const std::chrono::duration<double> elapsed = Clock::now() - start_;
  if (!terminated_ && elapsed > timeout_) {
    kill_group(SIGTERM);
    terminated_ = true;
  } else if (!killed_ && elapsed > timeout_ + grace) {
    kill_group(SIGKILL);
    killed_ = true;
  }
}

void ChildProcess::kill_group(int signal) const { kill(-id_, signal); }

SignalWait::SignalWait() {
  sigemptyset(&awaited_);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler != SIG_IGN) sigaddset(&awaited_, signal);
  }
  std::signal(SIGCHLD, SIG_DFL);  // a parent that ignores it would leave us without the ends of children
  sigaddset(&awaited_, SIGCHLD);
  pthread_sigmask(SIG_BLOCK, &awaited_, &previous_);
}

SignalWait::~SignalWait() { pthread_sigmask(SIG_SETMASK, &previous_, nullptr); }

bool SignalWait::stop_requested_within(std::chrono::milliseconds time) const {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(time);
  const timespec timeout{seconds.count(), std::chrono::nanoseconds(time - seconds).count()};
  const int signal = sigtimedwait(&awaited_, nullptr, &timeout);
  return signal > 0 && signal != SIGCHLD;
}

}  // namespace prcage
