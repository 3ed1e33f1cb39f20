// The file is read in one pass, array by array into place, because it may be larger than half of the memory.
#include "io/weights_file.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <system_error>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "io/output_file.h"

namespace prcage {
namespace {

static_assert(std::endian::native == std::endian::little, "files of weights are little-endian and copied as they are");

constexpr std::array<char, 8> magic{'P', 'R', 'C', 'A', 'G', 'E', '-', 'W'};
constexpr std::uint32_t format_version = 1;

struct Header {
  std::array<char, 8> letters = magic;
  std::uint32_t version = format_version;
  std::uint32_t weight_bytes = sizeof(double);
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  std::uint64_t cage_vertices = 0;
  std::uint64_t cage_faces = 0;
  std::uint64_t keep = 0;
  std::array<double, 4> errors{};  // largest and mean loss, largest and mean rest error

  bool dense() const { return keep == cage_vertices; }
};
static_assert(sizeof(Header) == 88, "the layout of the file");

// Of everything before the checksum; none if it is more than memory can hold.
std::optional<std::uint64_t> announced_size(const Header& header) {
  std::uint64_t numbers = 0, triangles = 0, weights = 0, size = 0;
  const std::uint64_t bytes = header.weight_bytes + (header.dense() ? 0 : sizeof(std::uint32_t));
  const bool overflow = __builtin_mul_overflow(header.vertices, header.keep, &numbers) ||
                        __builtin_mul_overflow(numbers, bytes, &weights) ||
                        __builtin_mul_overflow(header.triangles, sizeof(std::uint32_t[3]), &triangles) ||
                        __builtin_add_overflow(weights, triangles, &size) ||
                        __builtin_add_overflow(size, sizeof(Header), &size);
  if (overflow || size > std::numeric_limits<std::ptrdiff_t>::max() / 2) return std::nullopt;
  return size;
}

class Checksum {
 public:
  Checksum() : state_(XXH3_createState(), &XXH3_freeState) {
    if (!state_) throw std::bad_alloc();
    XXH3_64bits_reset(state_.get());
  }
  void add(const void* data, std::size_t size) { XXH3_64bits_update(state_.get(), data, size); }
  std::uint64_t value() const { return XXH3_64bits_digest(state_.get()); }

 private:
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

// ------------------------------------------------------------------------------------------------------- writing

class Writer {
 public:
  explicit Writer(const std::string& path) : file_(path) {}

  template <class T>
  void write(std::span<const T> numbers) {
    checksum_.add(numbers.data(), numbers.size_bytes());
    file_.write(numbers.data(), numbers.size_bytes());
  }

  WriteResult commit() {
    const std::uint64_t sum = checksum_.value();
    file_.write(&sum, sizeof sum);
    return file_.commit();
  }

 private:
  OutputFile file_;
  Checksum checksum_;
};

Header header_of(const CageWeights& weights) {
  Header header;
  header.weight_bytes = weights.float_values.empty() ? sizeof(double) : sizeof(float);
  header.vertices = weights.vertices;
  header.triangles = weights.triangles.size();
  header.cage_vertices = weights.cage_vertices;
  header.cage_faces = weights.cage_faces;
  header.keep = weights.keep;
  header.errors = {weights.largest_loss, weights.mean_loss, weights.largest_rest_error, weights.mean_rest_error};
  return header;
}

// ------------------------------------------------------------------------------------------------------- reading

constexpr const char* remedy = "; make it again with prcage bind";

class Reader {
 public:
  Reader(const std::string& path, WeightsFile& file) : file_(file), stream_(open(path), &close) {}

  bool run() {
    if (!stream_) return fail("cannot open: " + system_error());
    if (!read_header() || !check_size()) return false;
    CageWeights& weights = file_.weights;
    const std::size_t numbers = weights.vertices * weights.keep;
    if (!read("the triangles", weights.triangles, header_.triangles) || !check_triangles()) return false;
    if (!header_.dense() && (!read("the columns", weights.columns, numbers) || !check_columns())) return false;
    const bool floats = header_.weight_bytes == sizeof(float);
    const bool values = floats
                            ? read("the weights", weights.float_values, numbers) && check_values(weights.float_values)
                            : read("the weights", weights.values, numbers) && check_values(weights.values);
    return values && check_sum();
  }

 private:
  using Stream = std::FILE;

  static Stream* open(const std::string& path) { return path == "-" ? stdin : std::fopen(path.c_str(), "rb"); }
  static int close(Stream* stream) { return stream == stdin ? 0 : std::fclose(stream); }
  static std::string system_error() { return std::generic_category().message(errno); }

  bool fail(std::string error) {
    file_.error = std::move(error);
    return false;
  }
  bool fail_at(std::uint64_t byte, const std::string& error) {
    return fail("byte " + std::to_string(byte) + ": " + error + remedy);
  }

  // False, and the reason said, if the file ends before.
  bool read_bytes(const char* what, void* to, std::size_t size) {
    const std::size_t got = std::fread(to, 1, size, stream_.get());
    position_ += got;
    if (got == size) return true;
    if (std::ferror(stream_.get()) != 0)
      return fail("byte " + std::to_string(position_) + ": cannot read: " + system_error());
    return fail_at(position_, std::string("the file ends within ") + what + ": it is truncated");
  }

  bool read_header() {
    if (!read_bytes("the letters PRCAGE-W", header_.letters.data(), magic.size())) return false;
    if (header_.letters != magic) {
      return fail("no file of weights: it does not begin with the letters PRCAGE-W; prcage bind makes such files");
    }
    if (!read_bytes("the header", reinterpret_cast<char*>(&header_) + magic.size(), sizeof header_ - magic.size()))
      return false;
    checksum_.add(&header_, sizeof header_);
    if (header_.version != format_version) {
      return fail_at(8, "version " + std::to_string(header_.version) + " of the format, not " +
                            std::to_string(format_version) + ": another prcage wrote it");
    }
    return check_header();
  }

  bool check_header() {
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    if (header_.weight_bytes != sizeof(float) && header_.weight_bytes != sizeof(double))
      return fail_at(12, "weights of " + std::to_string(header_.weight_bytes) + " bytes: only 4 and 8 are known");
    if (header_.vertices == 0 || header_.vertices > most) return fail_count(16, header_.vertices, "vertices");
    if (header_.triangles > most) return fail_count(24, header_.triangles, "triangles");
    if (header_.cage_vertices == 0 || header_.cage_vertices > most)
      return fail_count(32, header_.cage_vertices, "vertices of the cage");
    if (header_.cage_faces == 0 || header_.cage_faces > most)
      return fail_count(40, header_.cage_faces, "faces of the cage");
    if (header_.keep == 0 || header_.keep > header_.cage_vertices)
      return fail_count(48, header_.keep, "weights of each vertex");
    return true;
  }
  bool fail_count(std::uint64_t byte, std::uint64_t count, const char* what) {
    return fail_at(byte, "the header announces " + std::to_string(count) + " " + what + ", which cannot be");
  }

  // Of a file, not of a pipe: that ends where it ends.
  bool check_size() {
    const std::optional<std::uint64_t> size = announced_size(header_);
    if (!size) return fail_at(16, "the header announces more numbers than can be");
    size_ = *size + sizeof(std::uint64_t);
    struct stat status {};
    regular_ = fstat(fileno(stream_.get()), &status) == 0 && S_ISREG(status.st_mode);
    const auto actual = static_cast<std::uint64_t>(status.st_size);
    if (regular_ && actual != size_) {
      return fail_at(std::min(actual, size_), "the header announces " + std::to_string(size_) +
                                                  " bytes, but the file has " + std::to_string(actual) +
                                                  (actual < size_ ? ": it is truncated" : ": something follows"));
    }
    CageWeights& weights = file_.weights;
    weights.vertices = header_.vertices;
    weights.cage_vertices = header_.cage_vertices;
    weights.cage_faces = header_.cage_faces;
    weights.keep = header_.keep;
    weights.largest_loss = header_.errors[0];
    weights.mean_loss = header_.errors[1];
    weights.largest_rest_error = header_.errors[2];
    weights.mean_rest_error = header_.errors[3];
    return true;
  }

  // Without a known size of the file, memory grows with what arrives.
  template <class T>
  bool read(const char* what, std::vector<T>& numbers, std::uint64_t count) {
    constexpr std::size_t first_block = std::size_t{1} << 16;
    start_ = position_;
    while (numbers.size() < count) {
      const std::size_t had = numbers.size();
      const std::size_t block = regular_ ? count : std::max(had, first_block);
      numbers.resize(std::min<std::uint64_t>(count, had + block));
      const std::size_t bytes = (numbers.size() - had) * sizeof(T);
      if (!read_bytes(what, numbers.data() + had, bytes)) return false;
      checksum_.add(numbers.data() + had, bytes);
    }
    return true;
  }

  bool check_triangles() {
    const auto& triangles = file_.weights.triangles;
    for (std::size_t f = 0; f < triangles.size(); ++f) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (triangles[f][k] < header_.vertices) continue;
        return fail_at(start_ + 12 * f + 4 * k, "triangle " + std::to_string(f) + " names vertex " +
                                                    std::to_string(triangles[f][k]) + " of " +
                                                    std::to_string(header_.vertices) + ": the file is damaged");
      }
    }
    return true;
  }

  bool check_columns() {
    const auto& columns = file_.weights.columns;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const bool ascends = i % header_.keep == 0 || columns[i] > columns[i - 1];
      if (ascends && columns[i] < header_.cage_vertices) continue;
      return fail_at(start_ + 4 * i, weight_name(i) + ": vertex " + std::to_string(columns[i]) +
                                         " of the cage is not there or not in order: the file is damaged");
    }
    return true;
  }

  template <class T>
  bool check_values(const std::vector<T>& values) {
    const auto bad = std::find_if_not(values.begin(), values.end(), [](T w) { return std::isfinite(w); });
    if (bad == values.end()) return true;
    const auto i = static_cast<std::size_t>(bad - values.begin());
    return fail_at(start_ + sizeof(T) * i, weight_name(i) + " is not finite: the file is damaged");
  }

  std::string weight_name(std::size_t i) const {
    return "weight " + std::to_string(i % header_.keep) + " of vertex " + std::to_string(i / header_.keep);
  }

  bool check_sum() {
    std::uint64_t sum = 0;
    const std::uint64_t at = position_;
    if (!read_bytes("the checksum", &sum, sizeof sum)) return false;
    if (sum != checksum_.value()) return fail_at(at, "the checksum is not that of the file: it is damaged");
    if (std::fgetc(stream_.get()) != EOF) return fail_at(position_, "something follows the checksum");
    return true;
  }

  WeightsFile& file_;
  std::unique_ptr<Stream, int (*)(Stream*)> stream_;
  Header header_;
  Checksum checksum_;
  std::uint64_t position_ = 0;  // in the file
  std::uint64_t start_ = 0;     // of the array that was read last
  std::uint64_t size_ = 0;
  bool regular_ = false;
};

}  // namespace

WeightsFile read_weights(const std::string& path) {
  WeightsFile file;
  file.ok = Reader(path, file).run();
  if (file.ok) {
    file.weights.status = Status::ok;
  } else {
    file.weights = {};
    file.error = (path == "-" ? "standard input" : path) + ": " + file.error;
  }
  return file;
}

WriteResult write_weights(const std::string& path, const CageWeights& weights) {
  Writer writer(path);
  const Header header = header_of(weights);
  writer.write(std::span<const Header>(&header, 1));
  writer.write(std::span(weights.triangles));
  writer.write(std::span(weights.columns));
  writer.write(std::span(weights.values));
  writer.write(std::span(weights.float_values));
  return writer.commit();
}

}  // namespace prcage
