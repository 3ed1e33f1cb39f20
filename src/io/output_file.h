// A file that appears as a whole or not at all.
//
// Bytes go to a temporary file in the directory of the target, which is flushed to the disk and renamed over the
// target by commit(). Until then, and after every failure, the target is what it was and the temporary file is
// removed. Devices and pipes cannot be replaced by renaming: they and open descriptors ("-", /dev/stdout,
// /dev/fd/3) are written directly. Symbolic links are followed, not replaced.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>

#include "io/mesh_file.h"

namespace prcage {

class OutputFile {
 public:
  explicit OutputFile(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // Room for `size` bytes, at most max_reserve, to be filled in and then passed on by advance(). Never fails: after
  // an error of the system the bytes go nowhere, and commit() reports the first error.
  char* reserve(std::size_t size) {
    if (capacity - used_ < size) flush();
    return buffer_.get() + used_;
  }
  void advance(std::size_t size) { used_ += size; }

  void write(const void* data, std::size_t size);
  void write(std::string_view text) { write(text.data(), text.size()); }

  // Text. The double is the shortest that reads back to the same value; "nan" and "inf" if it is not finite.
  void write_char(char c);
  void write_number(double value);
  void write_number(std::uint64_t value);
  void write_number(std::uint32_t value) { write_number(std::uint64_t{value}); }

  // The prefix and three numbers with spaces between them make a line.
  template <class T>
  void write_line(std::string_view prefix, const std::array<T, 3>& numbers) {
    write(prefix);
    for (std::size_t i = 0; i < 3; ++i) {
      write_number(numbers[i]);
      write_char(i < 2 ? ' ' : '\n');
    }
  }

  // Puts the file in place. To be called once, after everything was written.
  WriteResult commit();

  static constexpr std::size_t max_reserve = 4096;

 private:
  void open_target();
  void open_temporary();
  void flush();
  void write_out(const char* data, std::size_t size);
  void fail(const char* action);
  void close_descriptor();

  static constexpr std::size_t capacity = 1 << 20;

  std::string path_;       // as the caller gave it, for messages
  std::string target_;     // path_ without symbolic links
  std::string temporary_;  // empty if the target is written directly
  std::string error_;
  int descriptor_ = -1;
  bool owns_descriptor_ = true;
  std::size_t used_ = 0;
  std::unique_ptr<char[]> buffer_;
};

}  // namespace prcage
