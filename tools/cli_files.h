// Files as the commands use them: errors are printed here, where they are known, on standard error.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

#include "core/prcage.h"
#include "io/mesh_file.h"
#include "tools/exit_codes.h"

namespace prcage {

class Timer {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// A mesh file and what was done to it before it is used. Nothing but the path and the error if !file.ok.
struct InputMesh {
  std::string path;
  MeshFile file;
  std::size_t file_vertices = 0;    // as read
  std::size_t file_faces = 0;       // as read
  std::size_t welded_vertices = 0;  // merged by --weld
  std::size_t collapsed_faces = 0;  // removed: welding, also that of STL corners, left them an edge or a point
  std::uint64_t content_hash = 0;   // XXH3-64 of the positions as doubles, then the vertex indices, before --weld
  double seconds = 0;
};

// If the file cannot be read, that is said.
InputMesh read_input(const std::string& path, bool weld);

// How messages call a path: its own name, or "standard input" and "standard output" for "-".
std::string input_name(const std::string& path);
std::string output_name(const std::string& path);

// "error: ..." on standard error, under the name of the program.
void print_error(const std::string& message);

// The same about what the standard library could not do to a file.
void print_error(const std::filesystem::filesystem_error& error);

// Writes text to a file as a whole or not at all, or to standard output if `path` is "-".
ExitCode write_text(const std::string& path, const std::string& text);

// Writes a mesh under the same guarantee.
ExitCode write_output(const std::string& path, MeshFormat format, const Mesh& mesh, const std::string& comment);

// False, and said so, if it is known beforehand that `path` cannot be written: better before a long run than after.
bool writable(const std::string& path);

// The file of a level: cage.ply and 500 are cage.500.ply.
std::string level_path(const std::string& output, std::size_t faces);

}  // namespace prcage
