// prcage pose: bends and twists a cage, or any mesh.
#include <fmt/core.h>

#include "tools/cli_commands.h"
#include "tools/cli_files.h"
#include "tools/pose.h"

namespace prcage {

ExitCode run(const PoseCommand& command) {
  if (!writable(command.output)) return ExitCode::cannot_write;
  InputMesh input = read_input(command.input, false);
  if (!input.file.ok) return ExitCode::cannot_read;
  const Mesh mesh = posed(std::move(input.file.mesh), command.options);
  const std::string comment =
      fmt::format("prcage pose --bend {} --twist {}", command.options.bend, command.options.twist);
  return write_output(command.output, command.format, mesh, comment);
}

}  // namespace prcage
