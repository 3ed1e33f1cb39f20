// The bytes of a whole file, from a path or from standard input. Internal to src/io.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace prcage {

class FileBytes {
 public:
  // "-" is standard input. Pipes and devices are read to their end.
  explicit FileBytes(const std::string& path);

  bool ok() const { return error_.empty(); }
  const std::string& error() const { return error_; }  // the system's reason, without the path
  std::string_view bytes() const { return {data_.get(), size_}; }

 private:
  void read_all(int descriptor);
  void grow(std::size_t capacity);

  std::unique_ptr<char[]> data_;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
  std::string error_;
};

}  // namespace prcage
