// The options of prcage make.
#include <memory>
#include <optional>

#include "tools/cli_command_options.h"
#include "tools/cli_option_groups.h"

namespace prcage {

void add_make(CLI::App& app, std::optional<Command>& chosen) {
  struct Parsed {
    MakeCommand command;
    std::optional<MeshFormat> format;
  };
  const auto parsed = std::make_shared<Parsed>();
  MakeCommand& command = parsed->command;
  add_argument(app, "SHAPE", command.shape, "Name of a built-in shape (see --list)");
  add_flag(app, "--list", command.list, "Name the shapes; takes no other argument");
  add_count(app, "--faces", command.faces, {1},
            "Faces of the mesh (required), met within a few percent from 1000 on;\n"
            "the gyroid within 20 percent");
  add_count(app, "--seed", command.seed, {}, "Varies the shape [0]; the same seed gives the same mesh");
  add_mesh_output(app, command.output);
  add_format(app, parsed->format);
  when_parsed(app, [&app, parsed, &command, &chosen] {
    if (command.list) {
      if (number_given(app) > 1) refuse("--list", "takes no other argument");
    } else {
      if (command.shape.empty()) refuse_missing("SHAPE");
      if (command.faces == 0) refuse_missing("--faces");
      if (command.output.empty()) refuse_missing("--output");
      command.format = output_format(command.output, parsed->format);
    }
    chosen = command;
  });
}

}  // namespace prcage
