// What the readers and writers of the single formats share. Internal to src/io.
//
// A reader gets the whole file in memory and fills in a MeshFile. If the file is bad it returns false and leaves
// in MeshFile::error where and what is wrong; the name of the file is put in front of it by the caller. Sizes that
// a header announces are believed only as far as the file is long enough for them, so a damaged header allocates
// no more than a small multiple of the file's size.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "io/mesh_file.h"
#include "io/output_file.h"
#include "io/text_cursor.h"

namespace prcage {

// Reads a mesh file that is in memory. Errors lack the name of the file.
MeshFile parse_mesh(std::string_view bytes);

// Is it this format? The beginning of the file decides, for binary STL also its size.
bool looks_like_ply(std::string_view bytes);
bool looks_like_off(std::string_view bytes);
bool looks_like_obj(std::string_view bytes);
bool looks_like_stl_binary(std::string_view bytes);
bool looks_like_stl_ascii(std::string_view bytes);

bool read_ply(std::string_view bytes, MeshFile& file);
bool read_off(std::string_view bytes, MeshFile& file);
bool read_obj(std::string_view bytes, MeshFile& file);
bool read_stl_binary(std::string_view bytes, MeshFile& file);
bool read_stl_ascii(std::string_view bytes, MeshFile& file);

// The triangles of the mesh must be in range. The comment is one line, possibly empty.
void write_ply(OutputFile& out, const Mesh& mesh, bool binary, const std::string& comment);
void write_off(OutputFile& out, const Mesh& mesh, const std::string& comment);
void write_obj(OutputFile& out, const Mesh& mesh, const std::string& comment);
void write_stl_binary(OutputFile& out, const Mesh& mesh);
void write_stl_ascii(OutputFile& out, const Mesh& mesh);

// If the file is a damaged binary STL: what its size should be. Empty otherwise.
std::string stl_size_mismatch(std::string_view bytes);

// So that 32-bit indices name all vertices and one value is left to mean none.
constexpr std::uint64_t max_vertices = 0xffffffffu;

// Sets the error; false, so that readers can return it.
inline bool fail(MeshFile& file, std::string error) {
  file.error = std::move(error);
  return false;
}

inline bool fail(MeshFile& file, const TextCursor& cursor, const std::string& error) {
  return fail(file, "line " + std::to_string(cursor.line()) + ": " + error);
}

// "line 7: vertex 3: expected a number, found 'abc'"
bool fail_expected(MeshFile& file, const TextCursor& cursor, const std::string& element, std::size_t number,
                   const char* expected);

// Reads the x, y and z of a text line into `position`, between blanks.
bool read_position(TextCursor& cursor, MeshFile& file, std::size_t number, std::array<double, 3>& position);

// Can this number of a file be stored as the index of a vertex? (It may still be out of the mesh's range.)
inline bool is_index(std::int64_t value) { return value >= 0 && value <= std::int64_t{0xffffffff}; }

// Cuts a polygon whose corners arrive one by one into the fan around its first corner.
class Fan {
 public:
  explicit Fan(MeshFile& file) : file_(file) {}

  void add(std::uint32_t vertex) {
    if (corners_ >= 2) file_.mesh.triangles.push_back({first_, previous_, vertex});
    if (corners_ == 0) first_ = vertex;
    previous_ = vertex;
    ++corners_;
  }

  // Ends the polygon; the next corner begins another one.
  void finish() {
    file_.polygons += corners_ > 3;
    file_.skipped_elements += corners_ < 3;
    corners_ = 0;
  }

 private:
  MeshFile& file_;
  std::size_t corners_ = 0;
  std::uint32_t first_ = 0;
  std::uint32_t previous_ = 0;
};

}  // namespace prcage
