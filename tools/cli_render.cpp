// prcage render: a picture of a mesh, or of a mesh and its cage.
#include <algorithm>
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

// Where the colours end if nobody says so. False, and said so, if the cage cannot be measured.
bool find_largest_distance(const InputMesh& input, const InputMesh& cage, RenderOptions& options) {
  MeasureOptions measure;
  measure.threads = options.threads;
  measure.views = 0;
  const CageMeasures measures = measure_cage(input.file.mesh, cage.file.mesh, measure);
  constexpr double least = 1e-9;  // where cage and input are one, there still is a scale
  options.distance_max = std::max(measures.cage_to_input.hausdorff, least);
  if (measures.status != Status::ok) print_error(fmt::format("{}: {}", input_name(cage.path), measures.message));
  return measures.status == Status::ok;
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

  RenderOptions options = command.options;
  if (command.distance && options.distance_max == 0 && !find_largest_distance(input, *cage, options))
    return ExitCode::invalid_mesh;

  std::string error;
  const Mesh* cage_mesh = cage ? &cage->file.mesh : nullptr;
  if (render_png(input.file.mesh, cage_mesh, options, command.output, error)) return ExitCode::ok;
  print_error(error);  // the meshes are known to be drawable: it is the file
  return ExitCode::cannot_write;
}

}  // namespace prcage
