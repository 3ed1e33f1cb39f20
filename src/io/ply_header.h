// The header of a PLY file: which elements with which properties follow, and in which encoding.
// Internal to src/io. Format: G. Turk, "The PLY polygon file format", 1994, with the type names in use since.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace prcage {

enum class PlyEncoding { ascii, little_endian, big_endian };
enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t size_of(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type{};
  bool is_list = false;
  PlyType count_type{};  // of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  static constexpr std::size_t none = ~std::size_t{0};
  std::size_t find(std::string_view property) const;  // its number, or none
  bool has_lists() const;

  // Bytes of one record in a binary file if all its lists are empty.
  std::size_t least_bytes() const;
};

struct PlyHeader {
  std::string error;  // with the line; empty if the header is good
  PlyEncoding encoding{};
  std::vector<PlyElement> elements;  // in the order of the file
  std::size_t body = 0;              // offset of what follows the header
};

// `bytes` begins with "ply".
PlyHeader parse_ply_header(std::string_view bytes);

}  // namespace prcage
