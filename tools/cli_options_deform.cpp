// The options of prcage bind, pose and deform, which move a mesh by its cage.
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/cli_command_options.h"
#include "tools/cli_option_groups.h"

namespace prcage {
namespace {

std::size_t parse_axis(const std::string& text) {
  for (const std::size_t axis : {0u, 1u, 2u})
    if (text == std::string(1, "xyz"[axis])) return axis;
  refuse("--axis", fmt::format("'{}' is none of x, y and z", text));
}

// Two files or three; what the first one is depends on that.
void take_files(const std::vector<std::string>& files, DeformCommand& command) {
  if (files.size() < 2) refuse_missing(files.empty() ? "WEIGHTS" : "DEFORMED_CAGE");
  if (files.size() > 3) refuse(fmt::format("unexpected argument '{}'", files[3]));
  if (std::count(files.begin(), files.end(), "-") > 1) refuse("FILES", "only one of them can come from standard input");
  command.deformed_cage = files.back();
  if (files.size() == 2) {
    command.weights = files[0];
  } else {
    command.input = files[0];
    command.cage = files[1];
  }
}

}  // namespace

void add_bind(CLI::App& app, std::optional<Command>& chosen) {
  struct Parsed {
    BindCommand command;
    bool floats = false;
  };
  const auto parsed = std::make_shared<Parsed>();
  BindCommand& command = parsed->command;
  add_argument(app, "INPUT", command.input, "Mesh to bind; - is standard input").required();
  add_argument(app, "CAGE", command.cage, "Closed cage to bind it to; - is standard input").required();
  add_text(app, "-o,--output", command.output, "WEIGHTS", "File of weights to write (required); - is standard output")
      .required();
  add_count(app, "--keep", command.options.keep, {1},
            "Keep the N largest weights of each vertex, scaled up to the sum 1;\nwhat that costs is reported [all]");
  add_flag(app, "--float", parsed->floats, "Store the weights as floats: half the size, errors of 1e-7");
  add_threads(app, command.options.threads);
  add_flag(app, "--quiet", command.quiet, "No summary; errors are still printed");
  when_parsed(app, [parsed, &command, &chosen] {
    command.options.precision = parsed->floats ? Precision::float32 : Precision::float64;
    refuse_stdin_twice(command.input, command.cage, "CAGE");
    chosen = command;
  });
}

void add_pose(CLI::App& app, std::optional<Command>& chosen) {
  struct Parsed {
    PoseCommand command;
    std::optional<MeshFormat> format;
  };
  const auto parsed = std::make_shared<Parsed>();
  PoseCommand& command = parsed->command;
  add_argument(app, "CAGE", command.input, "Cage, or any mesh; - is standard input").required();
  add_mesh_output(app, command.output).required();
  add_degrees(app, "--bend", command.options.bend, 3600, "Bend it by so much from end to end");
  add_degrees(app, "--twist", command.options.twist, 3600, "Twist it by so much from end to end; before --bend");
  const auto set_axis = [&command](const std::string& text) { command.options.axis = parse_axis(text); };
  add_parsed(app, "--axis", set_axis, "x|y|z",
             "The axis from end to end [that of the longest side of the\nbounding box]");
  add_format(app, parsed->format);
  when_parsed(app, [&app, parsed, &command, &chosen] {
    if (!given(app, "--bend") && !given(app, "--twist")) refuse_missing("--bend or --twist");
    command.format = output_format(command.output, parsed->format);
    chosen = command;
  });
}

void add_deform(CLI::App& app, std::optional<Command>& chosen) {
  struct Parsed {
    DeformCommand command;
    std::vector<std::string> files;
    std::optional<MeshFormat> format;
  };
  const auto parsed = std::make_shared<Parsed>();
  DeformCommand& command = parsed->command;
  add_arguments(app, "FILES", parsed->files,
                "WEIGHTS of prcage bind, or INPUT and the CAGE to bind it to;\n"
                "then DEFORMED_CAGE, which has the same vertices in the same order.\n"
                "One of them may be -, standard input");
  add_mesh_output(app, command.output).required();
  add_format(app, parsed->format);
  add_threads(app, command.threads);
  when_parsed(app, [parsed, &command, &chosen] {
    take_files(parsed->files, command);
    command.format = output_format(command.output, parsed->format);
    chosen = command;
  });
}

}  // namespace prcage
