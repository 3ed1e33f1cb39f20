// prcage deform: the mesh when its cage is deformed, from weights that prcage bind wrote or in one step.
#include <optional>

#include <fmt/core.h>

#include "io/weights_file.h"
#include "tools/cli_commands.h"
#include "tools/cli_files.h"

namespace prcage {
namespace {

ExitCode write_deformed(const DeformCommand& command, const InputMesh& pose, const Deformation& deformed) {
  if (deformed.status == Status::ok)
    return write_output(command.output, command.format, deformed.mesh, fmt::format("prcage {} deform", version()));
  print_error(fmt::format("{}: {}", input_name(pose.path), deformed.message));
  return ExitCode::invalid_mesh;
}

ExitCode deform_by_weights(const DeformCommand& command, const InputMesh& pose) {
  const WeightsFile bound = read_weights(command.weights);
  if (!bound.ok) {
    print_error(bound.error);
    return ExitCode::cannot_read;
  }
  return write_deformed(command, pose, deform(bound.weights, pose.file.mesh, command.threads));
}

ExitCode deform_in_one_step(const DeformCommand& command, const InputMesh& pose) {
  const InputMesh input = read_input(command.input, false);
  if (!input.file.ok) return ExitCode::cannot_read;
  const InputMesh cage = read_input(command.cage, false);
  if (!cage.file.ok) return ExitCode::cannot_read;
  return write_deformed(command, pose, deform(input.file.mesh, cage.file.mesh, pose.file.mesh, command.threads));
}

}  // namespace

ExitCode run(const DeformCommand& command) {
  if (!writable(command.output)) return ExitCode::cannot_write;
  const InputMesh pose = read_input(command.deformed_cage, false);
  if (!pose.file.ok) return ExitCode::cannot_read;
  return command.weights.empty() ? deform_in_one_step(command, pose) : deform_by_weights(command, pose);
}

}  // namespace prcage
