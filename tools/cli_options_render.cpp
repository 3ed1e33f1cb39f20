// The options of prcage render.
#include <cctype>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "tools/cli_command_options.h"
#include "tools/cli_option_groups.h"
#include "tools/scale_bar.h"

namespace prcage {
namespace {

void add_picture(CLI::App& app, RenderCommand& command) {
  RenderOptions& options = command.options;
  add_text(app, "-o,--output", command.output, "OUTPUT", "PNG picture to write (required); - is standard output")
      .required();
  add_count(app, "--width", options.width, {16, 16384}, "Pixels of the whole picture across, 16 to 16384 [1800]");
  add_count(app, "--height", options.height, {16, 16384}, "Pixels of it from top to bottom, 16 to 16384 [640]");
  add_count(app, "--samples", options.samples, {1, 16}, "Samples of a pixel along each axis, 1 to 16 [4]");
  add_off_flag(app, "--single", options.panels, "One picture, cage over input");
  const AddedOption distance =
      add_flag(app, "--distance", command.distance,
               "Colour the cage by its distance to the input, with a scale: instead of the cage alone, or of --single");
  add_ratio(app, "--distance-max", options.distance_max, 1,
            "With --distance: where the scale ends, relative to the diagonal [the largest]")
      .needs(distance);
  add_off_flag(app, "--facets", options.smooth, "Draw the facets of the input instead of smooth shading");
  add_off_flag(app, "--no-shadow", options.shadow, "No shadow on the ground");
}

void add_camera(CLI::App& app, RenderOptions& options) {
  add_degrees(app, "--azimuth", options.azimuth, 360, "Where the camera is: 0 the +z side, 90 the +x side [30]");
  add_degrees(app, "--elevation", options.elevation, 90, "Height of the camera: 90 is straight above, -90 below [18]");
  add_flag(app, "--z-up", options.z_up, "The z axis is up instead of y; azimuth 0 is then the -y side");
}

// A name that promises another format than PNG is a slip, and may be that of a mesh that is still needed.
void check_picture_name(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension.empty() || extension == ".png") return;
  refuse("--output",
         fmt::format("'{}' is not the name of a PNG picture: end it in .png, or leave out the extension", path));
}

}  // namespace

void add_render(CLI::App& app, std::optional<Command>& chosen) {
  const auto command = std::make_shared<RenderCommand>();
  add_argument(app, "INPUT", command->input, "Mesh to draw; - is standard input").required();
  add_argument(app, "CAGE", command->cage, "Its cage: draws input, cage over input and cage, side by side");
  add_picture(app, *command);
  add_camera(app, command->options);
  add_threads(app, command->options.threads);
  when_parsed(app, [command, &chosen] {
    check_picture_name(command->output);
    if (command->distance && command->cage.empty()) refuse("--distance", "is that of a cage: name one after the input");
    if (command->distance && command->options.width < least_width_with_scale)
      refuse("--width", fmt::format("with --distance at least {}", least_width_with_scale));
    refuse_stdin_twice(command->input, command->cage, "CAGE");
    chosen = *command;
  });
}

}  // namespace prcage
