// Plain reads into one block. Not mmap: a file that shrinks meanwhile would kill the process by SIGBUS.
#include "io/file_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

namespace prcage {

FileBytes::FileBytes(const std::string& path) {
  if (path == "-") {
    read_all(STDIN_FILENO);
    return;
  }
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY);
  if (descriptor < 0) {
    error_ = "cannot open: " + std::generic_category().message(errno);
    return;
  }
  // The destructor of this little guard closes the file also if memory runs out.
  struct Closer {
    int descriptor;
    ~Closer() { close(descriptor); }
  } closer{descriptor};
  read_all(descriptor);
}

void FileBytes::read_all(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) == 0 && S_ISDIR(status.st_mode)) {
    error_ = "is a directory, not a mesh file";
    return;
  }
  // One byte more than the file holds, so that the read that finds its end needs no more room.
  constexpr std::size_t first_block = 1 << 16;
  grow(S_ISREG(status.st_mode) && status.st_size > 0 ? static_cast<std::size_t>(status.st_size) + 1 : first_block);
  while (true) {
    if (size_ == capacity_) grow(2 * capacity_);
    const ssize_t count = read(descriptor, data_.get() + size_, capacity_ - size_);
    if (count == 0) return;
    if (count > 0) {
      size_ += static_cast<std::size_t>(count);
    } else if (errno != EINTR) {
      error_ = "cannot read: " + std::generic_category().message(errno);
      return;
    }
  }
}

void FileBytes::grow(std::size_t capacity) {
  auto larger = std::make_unique_for_overwrite<char[]>(capacity);
  if (size_ > 0) std::memcpy(larger.get(), data_.get(), size_);
  data_ = std::move(larger);
  capacity_ = capacity;
}

}  // namespace prcage
