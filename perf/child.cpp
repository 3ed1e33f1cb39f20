#include "perf/child.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>
#include <system_error>

namespace prcage::perf {
namespace {

[[noreturn]] void throw_errno(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

std::string read_all(int file) {
  std::string text;
  char buffer[1 << 12];
  while (true) {
    const ssize_t got = read(file, buffer, sizeof(buffer));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw_errno("read from the child");
    if (got == 0) return text;
    text.append(buffer, static_cast<std::size_t>(got));
  }
}

bool write_all(int file, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t written = write(file, text.data() + done, text.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    done += static_cast<std::size_t>(written);
  }
  return true;
}

std::uint64_t peak_memory_bytes() {
  rusage self{}, children{};
  getrusage(RUSAGE_SELF, &self);
  getrusage(RUSAGE_CHILDREN, &children);
  return static_cast<std::uint64_t>(std::max(self.ru_maxrss, children.ru_maxrss)) * 1024;
}

// Leaves without the destructors and exit handlers that belong to the parent.
[[noreturn]] void child_main(const std::function<Json()>& f, int out) {
  bool ok = false;
  try {
    Json answer = f();
    answer["peak_memory_bytes"] = peak_memory_bytes();
    ok = write_all(out, answer.dump());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "measurement failed: %s\n", error.what());
  }
  _exit(ok ? 0 : 1);
}

}  // namespace

Json run_in_child(const std::function<Json()>& f) {
  int ends[2];
  if (pipe(ends) != 0) throw_errno("pipe");
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) throw_errno("fork");
  if (child == 0) {
    close(ends[0]);
    child_main(f, ends[1]);
  }
  close(ends[1]);
  const std::string answer = read_all(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) throw_errno("waitpid");
  if (WIFSIGNALED(status)) throw std::runtime_error("measurement killed by signal " + std::to_string(WTERMSIG(status)));
  if (WEXITSTATUS(status) != 0) throw std::runtime_error("measurement failed");
  return Json::parse(answer);
}

}  // namespace prcage::perf
