#include "tools/cli_files.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include <fmt/core.h>
#include <unistd.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace prcage {
namespace {

std::uint64_t content_hash(const Mesh& mesh) {
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), &XXH3_freeState);
  if (!state) throw std::bad_alloc();
  XXH3_64bits_reset(state.get());
  XXH3_64bits_update(state.get(), mesh.positions.data(), mesh.positions.size() * sizeof(mesh.positions[0]));
  XXH3_64bits_update(state.get(), mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]));
  return XXH3_64bits_digest(state.get());
}

// A face on fewer than three vertices covers nothing: the faces beside it meet where it was.
std::size_t remove_collapsed_faces(Mesh& mesh) {
  return std::erase_if(mesh.triangles, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

ExitCode print_text(const std::string& text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (written) return ExitCode::ok;
  print_error(fmt::format("cannot write standard output: {}", std::strerror(errno)));
  return ExitCode::cannot_write;
}

ExitCode outcome(const WriteResult& written) {
  if (written.ok) return ExitCode::ok;
  print_error(written.error);
  return ExitCode::cannot_write;
}

}  // namespace

InputMesh read_input(const std::string& path, bool weld) {
  const Timer timer;
  InputMesh input;
  input.path = path;
  input.file = read_mesh(path);
  if (!input.file.ok) {
    print_error(input.file.error);
    return input;
  }
  input.file_vertices = input.file.mesh.positions.size();
  input.file_faces = input.file.mesh.triangles.size();
  input.content_hash = content_hash(input.file.mesh);
  if (weld) input.welded_vertices = weld_equal_positions(input.file.mesh);
  if (weld || input.file.welded_corners > 0) input.collapsed_faces = remove_collapsed_faces(input.file.mesh);
  input.seconds = timer.seconds();
  return input;
}

std::string input_name(const std::string& path) { return path == "-" ? "standard input" : path; }
std::string output_name(const std::string& path) { return path == "-" ? "standard output" : path; }

void print_error(const std::string& message) { fmt::print(stderr, "prcage: error: {}\n", message); }

void print_error(const std::filesystem::filesystem_error& error) {
  print_error(fmt::format("{}: {}", error.path1().string(), error.code().message()));
}

ExitCode write_text(const std::string& path, const std::string& text) {
  return path == "-" ? print_text(text) : outcome(write_file(path, text.data(), text.size()));
}

ExitCode write_output(const std::string& path, MeshFormat format, const Mesh& mesh, const std::string& comment) {
  return outcome(write_mesh(path, format, mesh, comment));
}

bool writable(const std::string& path) {
  if (path == "-") return true;
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  const std::string directory = parent.empty() ? "." : parent.string();
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    print_error(fmt::format("cannot write {}: it is a directory", path));
    return false;
  }
  // "/." makes a parent that is a plain file an error too.
  if (::access((directory + "/.").c_str(), W_OK) == 0) return true;
  print_error(fmt::format("cannot write {}: {}: {}", path, directory, std::strerror(errno)));
  return false;
}

std::string level_path(const std::string& output, std::size_t faces) {
  std::filesystem::path path(output);
  const std::string extension = path.extension();
  return path.replace_extension(fmt::format("{}{}", faces, extension));
}

}  // namespace prcage
