// PLY, ascii and binary of both byte orders: the reader of the body behind the header, and the writer.
//
// A body is a sequence of elements, each a number of records of the same properties. Binary records of a fixed size
// are converted column by column in blocks; faces in the layout that nearly every program writes (a byte for the
// number of corners, 32-bit indices, nothing else) have a short cut; everything else is walked property by property.
#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstring>
#include <type_traits>

#include "io/formats.h"
#include "io/ply_header.h"

namespace prcage {
namespace {

using Axes = std::array<std::size_t, 3>;  // numbers of the properties x, y, z

// ------------------------------------------------------------------------------------- what the header must have

std::string element_name(const PlyElement& element) { return "element " + quoted(element.name); }

// For messages about one record.
std::string record_name(const PlyElement& element) {
  return element.name == "vertex" || element.name == "face" ? element.name : element_name(element);
}

bool find_axes(const PlyElement& element, MeshFile& file, Axes& axes) {
  constexpr std::array<const char*, 3> names{"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    axes[axis] = element.find(names[axis]);
    if (axes[axis] == PlyElement::none || element.properties[axes[axis]].is_list) {
      return fail(file, element_name(element) + " has no number '" + names[axis] + "' among its properties");
    }
  }
  return true;
}

bool find_corner_list(const PlyElement& element, MeshFile& file, std::size_t& list) {
  for (const char* name : {"vertex_indices", "vertex_index"}) {
    list = element.find(name);
    if (list != PlyElement::none && element.properties[list].is_list) return true;
  }
  return fail(file, element_name(element) + " has no list 'vertex_indices' among its properties");
}

bool check_elements(const PlyHeader& header, MeshFile& file) {
  bool has_vertices = false;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      has_vertices = true;
      if (element.count > max_vertices) return fail(file, "more vertices than 32-bit indices can name");
    }
    if (element.name == "tristrips" && element.count > 0) {
      return fail(file, "triangle strips are not supported: export the mesh with an element 'face' instead");
    }
  }
  return has_vertices || fail(file, "the header declares no element 'vertex'");
}

bool fail_too_short(MeshFile& file, const PlyElement& element, std::size_t remaining) {
  return fail(file, element_name(element) + ": the header announces " + std::to_string(element.count) +
                        " of them, but only " + std::to_string(remaining) +
                        " bytes follow: the file is truncated or its header damaged");
}

// ------------------------------------------------------------------------------------------------------- numbers

std::uint8_t swap_bytes(std::uint8_t x) { return x; }
std::uint16_t swap_bytes(std::uint16_t x) { return __builtin_bswap16(x); }
std::uint32_t swap_bytes(std::uint32_t x) { return __builtin_bswap32(x); }
std::uint64_t swap_bytes(std::uint64_t x) { return __builtin_bswap64(x); }

template <std::size_t size>
struct BitsOfSize;
template <>
struct BitsOfSize<1> : std::type_identity<std::uint8_t> {};
template <>
struct BitsOfSize<2> : std::type_identity<std::uint16_t> {};
template <>
struct BitsOfSize<4> : std::type_identity<std::uint32_t> {};
template <>
struct BitsOfSize<8> : std::type_identity<std::uint64_t> {};

template <class T, bool swapped>
T load(const char* source) {
  typename BitsOfSize<sizeof(T)>::type bits;
  std::memcpy(&bits, source, sizeof bits);
  return std::bit_cast<T>(swapped ? swap_bytes(bits) : bits);
}

// Calls f with a value of the C++ type that a PLY type stands for.
template <class F>
auto with_type(PlyType type, F&& f) {
  switch (type) {
    case PlyType::int8:
      return f(std::int8_t{});
    case PlyType::uint8:
      return f(std::uint8_t{});
    case PlyType::int16:
      return f(std::int16_t{});
    case PlyType::uint16:
      return f(std::uint16_t{});
    case PlyType::int32:
      return f(std::int32_t{});
    case PlyType::uint32:
      return f(std::uint32_t{});
    case PlyType::float32:
      return f(float{});
    case PlyType::float64:
      break;
  }
  return f(double{});
}

// Every PLY type fits a double without loss.
template <bool swapped>
double load_number(PlyType type, const char* source) {
  return with_type(type, [&]<class T>(T) { return static_cast<double>(load<T, swapped>(source)); });
}

bool to_index(double value, std::uint32_t& index) {
  if (!(value >= 0 && value <= 0xffffffff) || value != std::floor(value)) return false;
  index = static_cast<std::uint32_t>(value);
  return true;
}

// --------------------------------------------------------------------------------------------------- binary body

template <bool swapped>
class BinaryBody {
 public:
  BinaryBody(std::string_view bytes, std::size_t offset, MeshFile& file)
      : begin_(bytes.data()), position_(bytes.data() + offset), end_(bytes.data() + bytes.size()), file_(file) {}

  bool read_vertices(const PlyElement& element) {
    Axes axes;
    if (!find_axes(element, file_, axes) || !check_size(element)) return false;
    file_.float_positions = std::all_of(
        axes.begin(), axes.end(), [&](std::size_t axis) { return element.properties[axis].type == PlyType::float32; });
    file_.mesh.positions.resize(element.count);
    return element.has_lists() ? walk_vertices(element, axes) : convert_vertices(element, axes);
  }

  bool read_faces(const PlyElement& element) {
    std::size_t list;
    if (!find_corner_list(element, file_, list) || !check_size(element)) return false;
    file_.mesh.triangles.reserve(std::min<std::size_t>(element.count, remaining() / triangle_bytes));
    const PlyProperty& corners = element.properties[list];
    const bool usual = element.properties.size() == 1 && size_of(corners.count_type) == 1 &&
                       (corners.type == PlyType::int32 || corners.type == PlyType::uint32);
    // As unsigned numbers, negative indices are those above this one.
    const std::uint32_t largest = corners.type == PlyType::int32 ? 0x7fffffffu : 0xffffffffu;
    for (std::size_t i = 0; i < element.count; ++i) {
      if (usual && read_triangle(largest)) continue;
      if (!read_polygon(element, list, i)) return false;
    }
    return true;
  }

  bool skip(const PlyElement& element) {
    if (!check_size(element)) return false;
    file_.skipped_elements += element.count;
    if (!element.has_lists()) {
      position_ += element.count * element.least_bytes();
      return true;
    }
    Values values;
    for (std::size_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.properties) {
        if (!next(property, element, i, values)) return false;
      }
    }
    return true;
  }

 private:
  struct Values {
    const char* data = nullptr;
    std::size_t count = 0;
  };

  static constexpr std::size_t triangle_bytes = 13;

  std::size_t remaining() const { return static_cast<std::size_t>(end_ - position_); }

  bool check_size(const PlyElement& element) {
    const std::size_t least = element.least_bytes();
    return least == 0 || element.count <= remaining() / least || fail_too_short(file_, element, remaining());
  }

  bool fail_at(const PlyElement& element, std::size_t number, const std::string& what) {
    return fail(file_, "byte " + std::to_string(position_ - begin_) + ": " + record_name(element) + " " +
                           std::to_string(number) + " of " + std::to_string(element.count) + ": " + what);
  }

  // Takes the value or the list of a property of record `number`.
  bool next(const PlyProperty& property, const PlyElement& element, std::size_t number, Values& values) {
    double count = 1;
    const std::size_t count_size = property.is_list ? size_of(property.count_type) : 0;
    if (remaining() < count_size) return fail_at(element, number, "the file ends here: it is truncated");
    if (property.is_list) count = load_number<swapped>(property.count_type, position_);
    if (count < 0) return fail_at(element, number, "a list of negative length: the file is damaged");
    const std::size_t item_size = size_of(property.type);
    values.count = static_cast<std::size_t>(count);
    if (values.count > (remaining() - count_size) / item_size) {
      return fail_at(element, number, "the file ends within its values: it is truncated or damaged");
    }
    values.data = position_ + count_size;
    position_ = values.data + values.count * item_size;
    return true;
  }

  // Records of a fixed size, block by block so that the three passes over a block find it in the cache.
  bool convert_vertices(const PlyElement& element, const Axes& axes) {
    constexpr std::size_t block = 1024;
    const std::size_t stride = element.least_bytes();
    std::array<std::size_t, 3> offsets{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t i = 0; i < axes[axis]; ++i) offsets[axis] += size_of(element.properties[i].type);
    }
    auto& positions = file_.mesh.positions;
    for (std::size_t first = 0; first < positions.size(); first += block) {
      const std::size_t last = std::min(first + block, positions.size());
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const char* const column = position_ + first * stride + offsets[axis];
        with_type(element.properties[axes[axis]].type, [&]<class T>(T) {
          for (std::size_t i = first; i < last; ++i) {
            positions[i][axis] = static_cast<double>(load<T, swapped>(column + (i - first) * stride));
          }
        });
      }
    }
    position_ += positions.size() * stride;
    return true;
  }

  bool walk_vertices(const PlyElement& element, const Axes& axes) {
    Values values;
    for (std::size_t i = 0; i < element.count; ++i) {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (!next(property, element, i, values)) return false;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          if (axes[axis] == p) file_.mesh.positions[i][axis] = load_number<swapped>(property.type, values.data);
        }
      }
    }
    return true;
  }

  // The short cut. False, and nothing is consumed, if it is no good triangle: read_polygon() then says why.
  bool read_triangle(std::uint32_t largest) {
    if (remaining() < triangle_bytes || *position_ != 3) return false;
    std::array<std::uint32_t, 3> triangle;
    for (std::size_t i = 0; i < 3; ++i) triangle[i] = load<std::uint32_t, swapped>(position_ + 1 + 4 * i);
    if (std::max({triangle[0], triangle[1], triangle[2]}) > largest) return false;
    file_.mesh.triangles.push_back(triangle);
    position_ += triangle_bytes;
    return true;
  }

  bool read_polygon(const PlyElement& element, std::size_t list, std::size_t number) {
    Values values;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (!next(property, element, number, values)) return false;
      if (p != list) continue;
      Fan fan(file_);
      for (std::size_t i = 0; i < values.count; ++i) {
        std::uint32_t index;
        if (!to_index(load_number<swapped>(property.type, values.data + i * size_of(property.type)), index)) {
          return fail_at(element, number, "a vertex index is negative or no whole number: the file is damaged");
        }
        fan.add(index);
      }
      fan.finish();
    }
    return true;
  }

  const char* begin_;
  const char* position_;
  const char* end_;
  MeshFile& file_;
};

// ---------------------------------------------------------------------------------------------------- ascii body

// One record a line.
class AsciiBody {
 public:
  AsciiBody(std::string_view bytes, std::size_t offset, MeshFile& file) : cursor_(bytes, offset), file_(file) {}

  bool read_vertices(const PlyElement& element) {
    Axes axes;
    if (!find_axes(element, file_, axes) || !check_size(element)) return false;
    file_.mesh.positions.resize(element.count);
    return read_records(element, [&](std::size_t i, std::size_t p) {
      const auto axis = std::find(axes.begin(), axes.end(), p);
      if (axis == axes.end()) return skip_property(element, i, p);
      double& coordinate = file_.mesh.positions[i][static_cast<std::size_t>(axis - axes.begin())];
      return cursor_.read_number(coordinate) || fail_at(element, i, "a coordinate");
    });
  }

  bool read_faces(const PlyElement& element) {
    std::size_t list;
    if (!find_corner_list(element, file_, list) || !check_size(element)) return false;
    constexpr std::size_t least_line = 8;  // "3 0 1 2" and a line end
    file_.mesh.triangles.reserve(std::min<std::size_t>(element.count, cursor_.remaining() / least_line + 1));
    return read_records(element, [&](std::size_t i, std::size_t p) {
      return p == list ? read_corners(element, i, p) : skip_property(element, i, p);
    });
  }

  bool skip(const PlyElement& element) {
    if (!check_size(element)) return false;
    file_.skipped_elements += element.count;
    return read_records(element, [&](std::size_t i, std::size_t p) { return skip_property(element, i, p); });
  }

 private:
  // Each value takes at least a digit and a space; the last space may be missing.
  bool check_size(const PlyElement& element) {
    const std::size_t least = 2 * element.properties.size();
    return least == 0 || element.count <= (cursor_.remaining() + 1) / least ||
           fail_too_short(file_, element, cursor_.remaining());
  }

  bool fail_at(const PlyElement& element, std::size_t number, const char* expected) {
    return fail_expected(file_, cursor_, record_name(element), number, expected);
  }

  // Calls read_property(record, property) for all of them; it starts at the first character of the value.
  template <class ReadProperty>
  bool read_records(const PlyElement& element, ReadProperty&& read_property) {
    if (element.properties.empty()) return true;
    for (std::size_t i = 0; i < element.count; ++i) {
      cursor_.skip_space();
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        if (!read_property(i, p)) return false;
        cursor_.skip_blanks();
      }
      if (!cursor_.at_line_end()) {
        return fail_at(element, i, "the end of the line after the values that the header declares");
      }
    }
    return true;
  }

  bool read_count(const PlyElement& element, std::size_t number, std::int64_t& count) {
    return (cursor_.read_integer(count) && count >= 0) || fail_at(element, number, "the length of a list");
  }

  bool skip_property(const PlyElement& element, std::size_t number, std::size_t p) {
    std::int64_t count = 1;
    if (element.properties[p].is_list && !read_count(element, number, count)) return false;
    for (std::int64_t i = 0; i < count; ++i) {
      cursor_.skip_blanks();
      if (cursor_.read_word().empty()) return fail_at(element, number, "a value");
    }
    return true;
  }

  bool read_corners(const PlyElement& element, std::size_t number, std::size_t p) {
    std::int64_t count = 0;
    if (!read_count(element, number, count)) return false;
    const bool floating = element.properties[p].type >= PlyType::float32;
    Fan fan(file_);
    for (std::int64_t i = 0; i < count; ++i) {
      cursor_.skip_blanks();
      const TextCursor start = cursor_;
      std::uint32_t index;
      if (!(floating ? read_floating_index(index) : read_index(index))) {
        cursor_ = start;
        return fail_at(element, number, "a vertex index from 0 to 4294967295");
      }
      fan.add(index);
    }
    fan.finish();
    return true;
  }

  bool read_index(std::uint32_t& index) {
    std::int64_t value;
    if (!cursor_.read_integer(value) || !is_index(value)) return false;
    index = static_cast<std::uint32_t>(value);
    return true;
  }

  bool read_floating_index(std::uint32_t& index) {
    double value;
    return cursor_.read_number(value) && to_index(value, index);
  }

  TextCursor cursor_;
  MeshFile& file_;
};

template <class Body>
bool read_body(const PlyHeader& header, Body body) {
  for (const PlyElement& element : header.elements) {
    const bool good = element.name == "vertex" ? body.read_vertices(element)
                      : element.name == "face" ? body.read_faces(element)
                                               : body.skip(element);
    if (!good) return false;
  }
  return true;
}

// -------------------------------------------------------------------------------------------------------- writer

void write_header(OutputFile& out, const Mesh& mesh, bool binary, const std::string& comment) {
  const bool wide = mesh.positions.size() > 0x80000000u;
  out.write(binary ? "ply\nformat binary_little_endian 1.0\n" : "ply\nformat ascii 1.0\n");
  if (!comment.empty()) out.write("comment " + comment + "\n");
  out.write("element vertex " + std::to_string(mesh.positions.size()) + "\n");
  out.write("property double x\nproperty double y\nproperty double z\n");
  out.write("element face " + std::to_string(mesh.triangles.size()) + "\n");
  out.write(std::string("property list uchar ") + (wide ? "uint" : "int") + " vertex_indices\nend_header\n");
}

template <class T>
char* store_little(char* target, T value) {
  auto bits = std::bit_cast<typename BitsOfSize<sizeof(T)>::type>(value);
  if constexpr (std::endian::native == std::endian::big) bits = swap_bytes(bits);
  std::memcpy(target, &bits, sizeof bits);
  return target + sizeof bits;
}

void write_binary_body(OutputFile& out, const Mesh& mesh) {
  for (const auto& position : mesh.positions) {
    char* target = out.reserve(sizeof position);
    for (const double coordinate : position) target = store_little(target, coordinate);
    out.advance(sizeof position);
  }
  for (const auto& triangle : mesh.triangles) {
    char* target = out.reserve(1 + sizeof triangle);
    *target++ = 3;
    for (const std::uint32_t corner : triangle) target = store_little(target, corner);
    out.advance(1 + sizeof triangle);
  }
}

void write_ascii_body(OutputFile& out, const Mesh& mesh) {
  for (const auto& p : mesh.positions) out.write_line("", p);
  for (const auto& triangle : mesh.triangles) out.write_line("3 ", triangle);
}

}  // namespace

bool looks_like_ply(std::string_view bytes) {
  return bytes.starts_with("ply") && (bytes.size() == 3 || TextCursor::is_space(bytes[3]));
}

bool read_ply(std::string_view bytes, MeshFile& file) {
  const PlyHeader header = parse_ply_header(bytes);
  if (!header.error.empty()) return fail(file, header.error);
  if (!check_elements(header, file)) return false;
  file.format = header.encoding == PlyEncoding::ascii ? MeshFormat::ply_ascii : MeshFormat::ply_binary;
  if (header.encoding == PlyEncoding::ascii) return read_body(header, AsciiBody(bytes, header.body, file));
  const bool big_file = header.encoding == PlyEncoding::big_endian;
  const bool big_machine = std::endian::native == std::endian::big;
  return big_file == big_machine ? read_body(header, BinaryBody<false>(bytes, header.body, file))
                                 : read_body(header, BinaryBody<true>(bytes, header.body, file));
}

void write_ply(OutputFile& out, const Mesh& mesh, bool binary, const std::string& comment) {
  write_header(out, mesh, binary, comment);
  if (binary) {
    write_binary_body(out, mesh);
  } else {
    write_ascii_body(out, mesh);
  }
}

}  // namespace prcage
