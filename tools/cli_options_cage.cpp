// The options of prcage cage, beside those that batch has, too.
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/schedule.h"
#include "tools/cli_command_options.h"
#include "tools/cli_option_groups.h"

namespace prcage {
namespace {

// The two ways to a wrap: one for input that is not legal, one for handles that the cage shall not have.
struct WrapOptions {
  bool wrap = false;
  std::string output;
  WrapSettings settings;
  double topology_alpha = 0;  // 0: not given
};

void add_wrap(CLI::App& app, WrapOptions& options) {
  const AddedOption wrap = add_flag(app, "--wrap", options.wrap,
                                    "Accept any triangles (open, intersecting, ...): cage an alpha wrap\n"
                                    "of the input; the cage is certified to enclose every face of it");
  add_ratio(app, "--wrap-alpha", options.settings.alpha, 1,
            "With --wrap: radius, relative to the diagonal, of the ball that\n"
            "openings must let through to stay open [1/20 where the input has\n"
            "a boundary, else 1/100]")
      .needs(wrap);
  add_ratio(app, "--wrap-offset", options.settings.offset, 1,
            "With --wrap: distance of the wrap, relative to the diagonal [1/600]")
      .needs(wrap);
  add_ratio(app, "--simplify-topology", options.topology_alpha, 1,
            "Close tunnels and handles that a ball of this radius, relative to\n"
            "the diagonal, cannot pass: cage a wrap at a distance of 1/3000")
      .excludes(wrap);
  add_text(app, "--wrap-output", options.output, "FILE", "Also write the wrap, in the format that the extension says");
}

void choose_wrap(const WrapOptions& options, CageCommand& command) {
  const bool topology = options.topology_alpha > 0;
  if (!options.wrap && !topology) {
    if (options.output.empty()) return;
    refuse("--wrap-output", "there is no wrap without --wrap or --simplify-topology");
  }
  if (!has_alpha_wrap()) refuse(topology ? "--simplify-topology" : "--wrap", missing_alpha_wrap);
  command.wrap = topology ? WrapSettings{options.topology_alpha, topology_offset} : options.settings;
  command.wrap_output = options.output;
  if (!options.output.empty()) command.wrap_format = format_of_extension("--wrap-output", options.output, "");
}

std::vector<std::size_t> parse_levels(const std::string& text) {
  std::vector<std::size_t> levels;
  for (const std::string& number : split_at_commas(text)) {
    if (!parse_whole(number, levels.emplace_back())) levels.back() = 0;
  }
  const std::string error = levels_error(levels);
  if (error.empty()) return levels;
  refuse("--levels", fmt::format("'{}' is no list of levels: {}", text, error));
}

}  // namespace

void add_cage(CLI::App& app, std::optional<Command>& chosen) {
  struct Parsed {
    CageCommand command;
    std::optional<MeshFormat> format;
    WrapOptions wrap;
  };
  const auto parsed = std::make_shared<Parsed>();
  CageCommand& command = parsed->command;
  add_mesh_files(app, command, "Cage");
  const AddedOption faces = add_cage_settings(app, command);
  add_parsed(app, "--levels", command.levels, &parse_levels, "N1,N2,...",
             "Nested cages of so many faces, e.g. 5000,1000,200, each strictly\n"
             "around the one before; OUTPUT cage.ply is then cage.5000.ply, ...")
      .excludes(faces);
  add_ratio(app, "--deadline", command.deadline, 1e9,
            "Seconds from the start after which the valid cage reached so far\n"
            "is certified and written, like after Ctrl-C [none]")
      .of_kind("SECONDS");
  add_wrap(app, parsed->wrap);
  add_run_settings(app, command, command.options.threads, parsed->format);
  when_parsed(app, [&app, parsed, &command, &chosen] {
    find_thickness_if_free(app, command.options, !command.levels.empty());
    command.format = output_format(command.output, parsed->format);
    choose_wrap(parsed->wrap, command);
    if (command.output == "-" && !command.levels.empty())
      refuse("--levels", "standard output cannot hold several cages: name a file with --output");
    refuse_stdout_twice(command, "cage");
    chosen = command;
  });
}

}  // namespace prcage
