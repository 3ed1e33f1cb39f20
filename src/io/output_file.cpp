// Output by temporary file and rename, with the system's reason for every failure.
#include "io/output_file.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <climits>
#include <system_error>

namespace prcage {
namespace {

// With the slash at its end.
std::string directory_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "./" : path.substr(0, slash + 1);
}

// Where a symbolic link leads, also if nothing is there yet. The path itself if it is no link.
std::string resolve_links(std::string path) {
  constexpr int most_links = 40;  // as the kernel
  for (int i = 0; i < most_links; ++i) {
    std::array<char, PATH_MAX> link;
    const ssize_t size = readlink(path.c_str(), link.data(), link.size());
    if (size < 0) break;
    const std::string next(link.data(), static_cast<std::size_t>(size));
    path = next.starts_with('/') ? next : directory_of(path) + next;
  }
  return path;
}

// The open descriptor that a path stands for, -1 if it is an ordinary path. Opening /dev/stdout anew would start
// at the beginning of a file to which the shell wants to append.
int descriptor_of(const std::string& path) {
  if (path == "-" || path == "/dev/stdout") return STDOUT_FILENO;
  if (path == "/dev/stderr") return STDERR_FILENO;
  for (const std::string_view prefix : {"/dev/fd/", "/proc/self/fd/"}) {
    if (!path.starts_with(prefix)) continue;
    int descriptor = -1;
    const char* const end = path.data() + path.size();
    const auto result = std::from_chars(path.data() + prefix.size(), end, descriptor);
    if (result.ec == std::errc() && result.ptr == end) return descriptor;
  }
  return -1;
}

std::string temporary_name(const std::string& directory, unsigned attempt) {
  const auto now = static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
  return directory + ".prcage-" + std::to_string(getpid()) + "-" + std::to_string(now + attempt) + ".tmp";
}

// Some file systems cannot flush; the rename is then as safe as it gets.
bool synchronize(int descriptor) { return fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP; }

void synchronize_directory(const std::string& directory) {
  const int descriptor = open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

}  // namespace

OutputFile::OutputFile(const std::string& path)
    : path_(path), buffer_(std::make_unique_for_overwrite<char[]>(capacity)) {
  descriptor_ = descriptor_of(path);
  if (descriptor_ >= 0) {
    owns_descriptor_ = false;
  } else {
    open_target();
  }
}

OutputFile::~OutputFile() {
  close_descriptor();
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

void OutputFile::open_target() {
  struct stat status;
  const bool exists = stat(path_.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) {
    errno = EISDIR;
    return fail("cannot write");
  }
  if (exists && !S_ISREG(status.st_mode)) {
    descriptor_ = open(path_.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (descriptor_ < 0) fail("cannot open");
    return;
  }
  // Renaming would replace a file that is protected against writing as well.
  if (exists && access(path_.c_str(), W_OK) != 0) return fail("cannot write");
  target_ = resolve_links(path_);
  open_temporary();
  if (exists && descriptor_ >= 0) fchmod(descriptor_, status.st_mode & 0777);  // a courtesy: may fail
}

void OutputFile::open_temporary() {
  constexpr unsigned attempts = 100;
  for (unsigned i = 0; i < attempts && descriptor_ < 0; ++i) {
    std::string name = temporary_name(directory_of(target_), i);
    descriptor_ = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ >= 0) {
      temporary_ = std::move(name);
    } else if (errno != EEXIST && errno != EINTR) {
      break;
    }
  }
  if (descriptor_ < 0) fail("cannot create a temporary file beside it");
}

void OutputFile::write(const void* data, std::size_t size) {
  const char* const bytes = static_cast<const char*>(data);
  if (capacity - used_ < size) flush();
  if (size > capacity) return write_out(bytes, size);
  if (size > 0) std::memcpy(buffer_.get() + used_, bytes, size);
  used_ += size;
}

void OutputFile::write_char(char c) {
  *reserve(1) = c;
  advance(1);
}

void OutputFile::write_number(double value) {
  constexpr std::size_t longest = 32;  // "-1.7976931348623157e+308" has 24 characters
  char* const text = reserve(longest);
  advance(static_cast<std::size_t>(std::to_chars(text, text + longest, value).ptr - text));
}

void OutputFile::write_number(std::uint64_t value) {
  constexpr std::size_t longest = 20;
  char* const text = reserve(longest);
  advance(static_cast<std::size_t>(std::to_chars(text, text + longest, value).ptr - text));
}

WriteResult OutputFile::commit() {
  flush();
  if (!temporary_.empty()) {
    if (error_.empty() && !synchronize(descriptor_)) fail("cannot flush");
    close_descriptor();
    if (error_.empty()) {
      if (rename(temporary_.c_str(), target_.c_str()) == 0) {
        temporary_.clear();
        synchronize_directory(directory_of(target_));
      } else {
        fail("cannot rename the temporary file");
      }
    }
  }
  close_descriptor();
  return {error_.empty(), error_};
}

void OutputFile::flush() {
  write_out(buffer_.get(), used_);
  used_ = 0;
}

void OutputFile::write_out(const char* data, std::size_t size) {
  while (size > 0 && error_.empty()) {
    const ssize_t written = ::write(descriptor_, data, size);
    if (written >= 0) {
      data += written;
      size -= static_cast<std::size_t>(written);
    } else if (errno == EAGAIN) {  // standard output may be a pipe that somebody made non-blocking
      pollfd ready{descriptor_, POLLOUT, 0};
      poll(&ready, 1, -1);
    } else if (errno != EINTR) {
      fail("cannot write");
    }
  }
}

// Keeps the first error: what follows is its consequence.
void OutputFile::fail(const char* action) {
  if (!error_.empty()) return;
  const std::string name = path_ == "-" ? "standard output" : path_;
  error_ = name + ": " + action + ": " + std::generic_category().message(errno);
}

// Late write errors (quota, network file systems) may be reported by close.
void OutputFile::close_descriptor() {
  if (owns_descriptor_ && descriptor_ >= 0 && close(descriptor_) != 0 && errno != EINTR) fail("cannot write");
  descriptor_ = -1;
}

WriteResult write_file(const std::string& path, const void* data, std::size_t size) {
  OutputFile out(path);
  out.write(data, size);
  return out.commit();
}

}  // namespace prcage
