// Mesh files: PLY (ascii, binary of both byte orders, float and double), OBJ, STL (ascii and binary), OFF.
//
// A file is recognised by its content, never by its name; the format to write is chosen by the caller (usually
// from the extension of the output). Positions survive without loss: doubles are read and written as doubles,
// text is written with the fewest digits that read back to the same double. Polygons are cut into fans, STL
// corners with equal coordinates are welded, elements and properties other than positions and faces are skipped.
// Functions report failure by return value; only std::bad_alloc leaves them. Thread-safe on distinct files.
#pragma once

#include <cstddef>
#include <string>

#include "core/prcage.h"

namespace prcage {

enum class MeshFormat { ply_binary, ply_ascii, obj, stl_binary, stl_ascii, off };

// Stable lower-case name: "ply", "ply-ascii", "obj", "stl", "stl-ascii", "off".
const char* to_string(MeshFormat format);

// From such a name. False if there is no such format.
bool parse_mesh_format(const std::string& name, MeshFormat& format);

// From the extension of a path (.ply .obj .stl .off, any case): binary where the format has a binary form.
bool mesh_format_of_path(const std::string& path, MeshFormat& format);

// Does the format hold positions as 32-bit floats? (binary STL)
bool stores_floats(MeshFormat format);

struct MeshFile {
  bool ok = false;
  std::string error;  // if not ok: file, line or byte offset, element, what is wrong and what to do; one line.
                      // Lines count from 1; bytes, vertices and faces from 0 as everywhere here

  Mesh mesh;
  MeshFormat format = MeshFormat::ply_binary;
  bool float_positions = false;      // the file held 32-bit floats (binary PLY and STL; text is read as double)
  std::size_t polygons = 0;          // faces of the file with more than three corners, cut into fans
  std::size_t skipped_elements = 0;  // lines, points, ... that are no faces
  std::size_t welded_corners = 0;    // STL: corners merged into a vertex at the same position
};

// Reads a mesh. "-" reads standard input. The mesh may be invalid in every way that validate() reports (an index
// out of range included); what is not a mesh file at all, is truncated or malformed is an error.
MeshFile read_mesh(const std::string& path);

struct WriteResult {
  bool ok = false;
  std::string error;  // names the file and the system's reason
};

// Writes beside `path` and renames, so that the file is there as a whole or not at all, also when the disk is full
// or the process is killed. "-" writes standard output; devices and pipes are written directly; symbolic links are
// followed. Comment: one line kept in formats that have comments. A mesh with a vertex index out of range is refused.
WriteResult write_mesh(const std::string& path, MeshFormat format, const Mesh& mesh, const std::string& comment = {});

// Same guarantee for any bytes (statistics, pictures).
WriteResult write_file(const std::string& path, const void* data, std::size_t size);

// Merges vertices with bitwise equal positions (-0 equals +0), keeping the order of first occurrence, and renumbers
// the triangles; indices out of range are left alone. Returns the number of vertices removed. Linear time; at most
// 2^32 - 1 vertices.
std::size_t weld_equal_positions(Mesh& mesh);

}  // namespace prcage
