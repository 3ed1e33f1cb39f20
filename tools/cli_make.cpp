// prcage make: writes a built-in shape, or names the shapes.
#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "tools/cli_commands.h"
#include "tools/cli_files.h"
#include "tools/shapes.h"

namespace prcage {
namespace {

std::string shapes_text() {
  std::string text;
  for (const ShapeInfo& shape : shape_table()) text += fmt::format("{:<18} {}\n", shape.name, shape.description);
  return text;
}

bool known(const std::string& name) {
  const auto shapes = shape_table();
  return std::any_of(shapes.begin(), shapes.end(), [&name](const ShapeInfo& shape) { return name == shape.name; });
}

}  // namespace

ExitCode run(const MakeCommand& command) {
  if (command.list) return write_text("-", shapes_text());
  if (known(command.shape) && !writable(command.output)) return ExitCode::cannot_write;
  std::string error;
  const Mesh mesh = make_shape(command.shape, command.faces, command.seed, error);
  if (mesh.triangles.empty()) {
    print_error(error);
    return ExitCode::usage;
  }
  const std::string comment =
      fmt::format("prcage make {} --faces {} --seed {}", command.shape, command.faces, command.seed);
  return write_output(command.output, command.format, mesh, comment);
}

}  // namespace prcage
