// STL, binary and ascii. Both hold a soup of triangles: corners with equal coordinates are welded to one vertex.
//
// Binary: 80 bytes of anything, the number of triangles, then 50 bytes a triangle (normal, corners, two bytes of
// attributes). Many binary files begin with "solid" like ascii ones, so the size decides, not the first word.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "io/formats.h"

namespace prcage {
namespace {

using Position = std::array<double, 3>;

constexpr std::size_t header_bytes = 80;
constexpr std::size_t first_triangle = header_bytes + 4;
constexpr std::size_t triangle_bytes = 50;
constexpr std::size_t normal_bytes = 12;

std::uint32_t load_little(const char* source) {
  std::uint32_t bits;
  std::memcpy(&bits, source, sizeof bits);
  return std::endian::native == std::endian::big ? __builtin_bswap32(bits) : bits;
}

void store_little(char* target, std::uint32_t bits) {
  if (std::endian::native == std::endian::big) bits = __builtin_bswap32(bits);
  std::memcpy(target, &bits, sizeof bits);
}

std::uint64_t announced_size(std::string_view bytes) {
  return first_triangle + triangle_bytes * std::uint64_t{load_little(bytes.data() + header_bytes)};
}

// Takes over the corners of the soup in the mesh, three a triangle.
bool weld(MeshFile& file) {
  if (file.mesh.positions.size() > max_vertices) return fail(file, "more corners than 32-bit indices can name");
  file.welded_corners = weld_equal_positions(file.mesh);
  return true;
}

// ---------------------------------------------------------------------------------------------------------- ascii

// Whether a word of the file is this keyword, in any case.
bool is_keyword(std::string_view word, std::string_view lower) {
  const auto same = [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; };
  return std::equal(word.begin(), word.end(), lower.begin(), lower.end(), same);
}

class StlTextReader {
 public:
  StlTextReader(std::string_view bytes, MeshFile& file) : cursor_(bytes), file_(file) {}

  bool read() {
    bool open = false;  // within a solid
    for (cursor_.skip_space(); !cursor_.at_end(); cursor_.skip_space()) {
      const std::string_view word = cursor_.peek_word();
      if (is_keyword(word, open ? "endsolid" : "solid")) {
        open = !open;
        cursor_.skip_to_line_end();  // behind it is the name
      } else if (!open) {
        return fail_expected(file_, cursor_, "facet", facets_, "'solid'");
      } else if (!read_facet()) {
        return false;
      }
    }
    return (!open || fail_expected(file_, cursor_, "facet", facets_, "'facet' or 'endsolid'")) && weld(file_);
  }

 private:
  bool expect(std::string_view keyword) {
    cursor_.skip_space();
    if (!is_keyword(cursor_.peek_word(), keyword)) {
      return fail_expected(file_, cursor_, "facet", facets_, quoted(keyword).c_str());
    }
    cursor_.read_word();
    return true;
  }

  bool read_facet() {
    if (!expect("facet") || !expect("normal")) return false;
    for (int i = 0; i < 3; ++i) {  // some programs write normals that are no numbers
      cursor_.skip_space();
      cursor_.read_word();
    }
    if (!expect("outer") || !expect("loop") || !read_loop()) return false;
    if (!expect("endloop") || !expect("endfacet")) return false;
    ++facets_;
    return true;
  }

  // At least three corners; the format wants exactly three, larger loops are cut like the polygons of other formats.
  bool read_loop() {
    Fan fan(file_);
    std::size_t corners = 0;
    for (cursor_.skip_space(); corners < 3 || is_keyword(cursor_.peek_word(), "vertex"); cursor_.skip_space()) {
      if (!expect("vertex")) return false;
      fan.add(static_cast<std::uint32_t>(file_.mesh.positions.size()));
      Position position;
      if (!read_position(cursor_, file_, corners++, position)) return false;
      file_.mesh.positions.push_back(position);
    }
    fan.finish();
    return true;
  }

  TextCursor cursor_;
  MeshFile& file_;
  std::size_t facets_ = 0;
};

// --------------------------------------------------------------------------------------------------------- writers

// Unit normal of the triangle; zero, as the format wants it, if the triangle has no area. Scaled by the largest
// edge component first, so that neither tiny nor huge triangles leave the range of the doubles.
Position normal_of(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  const Position& o = mesh.positions[triangle[0]];
  std::array<Position, 2> edges;
  double largest = 0;
  for (std::size_t e = 0; e < 2; ++e) {
    for (std::size_t i = 0; i < 3; ++i) {
      edges[e][i] = mesh.positions[triangle[e + 1]][i] - o[i];
      largest = std::max(largest, std::abs(edges[e][i]));
    }
  }
  for (Position& edge : edges) {
    for (double& component : edge) component /= largest;
  }
  const auto& [a, b] = edges;
  Position n{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  const double length = std::hypot(n[0], n[1], n[2]);
  if (!(length > 0)) return {};  // NaN if an edge is longer than the doubles
  for (double& component : n) component /= length;
  return n;
}

char* store_floats(char* target, const Position& p) {
  for (const double x : p) {
    store_little(target, std::bit_cast<std::uint32_t>(static_cast<float>(x)));
    target += sizeof(float);
  }
  return target;
}

}  // namespace

bool looks_like_stl_binary(std::string_view bytes) {
  return bytes.size() >= first_triangle && announced_size(bytes) == bytes.size();
}

bool looks_like_stl_ascii(std::string_view bytes) {
  TextCursor cursor(bytes);
  cursor.skip_space();
  return is_keyword(cursor.peek_word(), "solid");
}

std::string stl_size_mismatch(std::string_view bytes) {
  const bool text = bytes.find('\0') == std::string_view::npos;
  if (text || bytes.size() < first_triangle) return {};
  return "if it is binary STL, it announces " + std::to_string(load_little(bytes.data() + header_bytes)) +
         " triangles, which take " + std::to_string(announced_size(bytes)) + " bytes, but it has " +
         std::to_string(bytes.size());
}

bool read_stl_binary(std::string_view bytes, MeshFile& file) {
  const std::size_t count = (bytes.size() - first_triangle) / triangle_bytes;
  file.format = MeshFormat::stl_binary;
  file.float_positions = true;
  file.mesh.positions.reserve(3 * count);
  file.mesh.triangles.reserve(count);
  const char* record = bytes.data() + first_triangle;
  for (std::size_t i = 0; i < count; ++i, record += triangle_bytes) {
    const char* source = record + normal_bytes;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Position p;
      for (double& x : p) {
        x = std::bit_cast<float>(load_little(source));
        source += sizeof(float);
      }
      file.mesh.positions.push_back(p);
    }
    const auto first = static_cast<std::uint32_t>(3 * i);
    file.mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return weld(file);
}

bool read_stl_ascii(std::string_view bytes, MeshFile& file) {
  file.format = MeshFormat::stl_ascii;
  return StlTextReader(bytes, file).read();
}

void write_stl_binary(OutputFile& out, const Mesh& mesh) {
  std::array<char, first_triangle> header{};
  constexpr std::string_view title = "binary STL, made by prcage";
  std::copy(title.begin(), title.end(), header.begin());
  store_little(header.data() + header_bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  out.write(header.data(), header.size());
  for (const auto& triangle : mesh.triangles) {
    char* const record = out.reserve(triangle_bytes);
    char* target = store_floats(record, normal_of(mesh, triangle));
    for (const std::uint32_t corner : triangle) target = store_floats(target, mesh.positions[corner]);
    target[0] = target[1] = 0;
    out.advance(triangle_bytes);
  }
}

void write_stl_ascii(OutputFile& out, const Mesh& mesh) {
  out.write("solid prcage\n");
  for (const auto& triangle : mesh.triangles) {
    out.write_line("facet normal ", normal_of(mesh, triangle));
    out.write("outer loop\n");
    for (const std::uint32_t corner : triangle) out.write_line("vertex ", mesh.positions[corner]);
    out.write("endloop\nendfacet\n");
  }
  out.write("endsolid prcage\n");
}

}  // namespace prcage
