// prcage render: a picture of a mesh, or of a mesh and its cage.
#include <optional>
#include <string>

#include <fmt/core.h>

#include "tools/cli_commands.h"
#include "tools/cli_files.h"
#include "tools/report_measures.h"

namespace prcage {
namespace {

// False, and said so, if the mesh has no face or one that cannot be drawn.
bool drawable(const InputMesh& input) {
  const std::size_t faces = input.file.mesh.triangles.size();
  const std::size_t usable = count_usable_faces(input.file.mesh);
  if (faces > 0 && usable == faces) return true;
  print_error(fmt::format("{}: cannot be drawn: {} of its {} faces are usable; `prcage check` says what is wrong",
                          input_name(input.path), usable, faces));
  return false;
}

}  // namespace

ExitCode run(const RenderCommand& command) {
  if (!writable(command.output)) return ExitCode::cannot_write;
  const InputMesh input = read_input(command.input, false);
  if (!input.file.ok) return ExitCode::cannot_read;
  std::optional<InputMesh> cage;
  if (!command.cage.empty()) cage = read_input(command.cage, false);
  if (cage && !cage->file.ok) return ExitCode::cannot_read;
  if (!drawable(input) || (cage && !drawable(*cage))) return ExitCode::invalid_mesh;

  std::string error;
  const Mesh* cage_mesh = cage ? &cage->file.mesh : nullptr;
  if (render_png(input.file.mesh, cage_mesh, command.options, command.output, error)) return ExitCode::ok;
  print_error(error);  // the meshes are known to be drawable: it is the file
  return ExitCode::cannot_write;
}

}  // namespace prcage
