#include "tools/cli_options.h"

#include <charconv>
#include <cmath>
#include <iostream>
#include <string_view>
#include <vector>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

namespace prcage {
namespace {

constexpr const char* libraries_text =
    "Licence: Apache-2.0. Nothing that it links requires the GPL. Libraries:\n"
    "  CGAL kernel (LGPL-3.0-or-later), GMP and MPFR (LGPL-3.0-or-later), Embree (Apache-2.0), oneTBB (Apache-2.0),\n"
    "  OpenVDB (MPL-2.0), Eigen (MPL-2.0), Boost (BSL-1.0), xsimd (BSD-3-Clause), {fmt} (MIT), CLI11 (BSD-3-Clause),\n"
    "  JSON for Modern C++ (MIT), xxHash (BSD-2-Clause), zlib (Zlib), libpng (libpng-2.0)";

std::string version_text() { return fmt::format("prcage {}\n{}", version(), libraries_text); }

bool parse_decimal(std::string_view text, double& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && stop == end;
}

// --------------------------------------------------------------------------------- options of several commands

CLI::Option* add_ratio(CLI::App& app, const std::string& name, double& value, const std::string& help) {
  const auto parse = [name, &value](const std::string& text) {
    if (!parse_ratio(text, value)) {
      throw CLI::ValidationError(name, "'" + text + "' is not a positive number such as 0.025 or 1/40");
    }
  };
  return app.add_option_function<std::string>(name, parse, help)->type_name("NUMBER");
}

// Whole decimal number of at least `least`. The parser's own conversion takes -1 as a huge unsigned number and 010 as
// an octal one.
template <typename Integer>
CLI::Option* add_count(CLI::App& app, const std::string& name, Integer& value, Integer least, const std::string& help) {
  const auto parse = [name, &value, least](const std::string& text) {
    Integer parsed{};
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, parsed);
    if (error != std::errc{} || stop != end || parsed < least) {
      throw CLI::ValidationError(name, fmt::format("'{}' is not a whole number of at least {}", text, least));
    }
    value = parsed;
  };
  return app.add_option_function<std::string>(name, parse, help)->type_name("N");
}

void add_format(CLI::App& app, std::optional<MeshFormat>& format) {
  const auto parse = [&format](const std::string& name) {
    if (!parse_mesh_format(name, format.emplace())) {
      throw CLI::ValidationError("--format", "no such format '" + name + "'");
    }
  };
  app.add_option_function<std::string>("--format", parse, "Format to write; by default from the extension of FILE")
      ->type_name("ply|ply-ascii|obj|stl|stl-ascii|off");
}

void add_threads(CLI::App& app, int& threads) {
  add_count(app, "--threads", threads, 0, "Threads; 0: as many as the machine has [0]. The result is the same");
}

void add_weld(CLI::App& app, bool& weld) {
  app.add_flag("--weld", weld, "Merge vertices of the input at equal positions (STL is always welded)");
}

// The format to write `path` in: as asked for, or as its extension says.
MeshFormat output_format(const std::string& path, const std::optional<MeshFormat>& asked) {
  MeshFormat format{};
  if (asked) return *asked;
  if (mesh_format_of_path(path, format)) return format;
  const std::string what = path == "-" ? "standard output has no extension"
                                       : "the extension of '" + path + "' is none of .ply, .obj, .stl, .off";
  throw CLI::ValidationError("--output", what + ": say --format");
}

// ----------------------------------------------------------------------------------------------- the commands

std::vector<double> parse_schedule(const std::string& text) {
  std::vector<double> schedule;
  for (const std::string& step : CLI::detail::split(text, ',')) {
    double beta = 0;
    if (!parse_ratio(step, beta) || beta > 1 || (!schedule.empty() && beta <= schedule.back())) {
      throw CLI::ValidationError("--schedule", "'" + text + "' is not a rising list of numbers in (0, 1]");
    }
    schedule.push_back(beta);
  }
  if (schedule.empty() || schedule.back() != 1) throw CLI::ValidationError("--schedule", "the last step must be 1");
  return schedule;
}

TauMode parse_tau_mode(const std::string& mode) {
  if (mode == "strict") return TauMode::strict;
  if (mode == "paper") return TauMode::paper;
  throw CLI::ValidationError("--tau-mode", "'" + mode + "' is neither strict nor paper");
}

void add_tau(CLI::App& app, Options& options) {
  CLI::Option* tau = add_ratio(app, "--tau", options.tau,
                               "Thickness of the band around the input that the cage may use,\n"
                               "relative to the diagonal of its bounding box, at most 1 [1/40]");
  CLI::Option* absolute = add_ratio(app, "--tau-abs", options.tau_absolute, "The same in the unit of the input");
  tau->excludes(absolute);
  app.add_option_function<std::string>(
         "--tau-mode", [&options](const std::string& mode) { options.tau_mode = parse_tau_mode(mode); },
         "strict: every point of the cage is proved within tau [default];\n"
         "paper: only the centroids of the faces are tested")
      ->type_name("strict|paper");
}

void add_schedule(CLI::App& app, Options& options) {
  CLI::Option* cycles = add_count(app, "--cycles", options.cycles, 1, "Uniform steps in which tau is released [10]");
  app.add_option_function<std::string>(
         "--schedule", [&options](const std::string& text) { options.schedule = parse_schedule(text); },
         "The steps themselves: rising fractions of tau that end at 1, e.g. 1/8,1/4,1/2,1")
      ->type_name("B1,B2,...")
      ->excludes(cycles);
}

void add_cage(CLI::App& app, CageCommand& command, std::optional<MeshFormat>& format, bool& no_flips) {
  app.add_option("INPUT", command.input, "Closed triangle mesh (PLY, OBJ, STL, OFF); - reads standard input")
      ->required()
      ->type_name("");
  app.add_option("-o,--output", command.output, "Cage to write; - writes standard output (needs --format)")
      ->required()
      ->type_name("FILE");
  add_tau(app, command.options);
  add_schedule(app, command.options);
  add_count(app, "--faces", command.options.face_budget, std::size_t{0},
            "Stop at N faces (or one below, where parity demands); 0: as few as tau allows [0]");
  app.add_flag("--no-flips", no_flips, "Do not flip edges between the cycles");
  add_ratio(app, "--sigma", command.options.sigma, "First displacement off the input, relative to the diagonal [1e-5]");
  add_threads(app, command.options.threads);
  add_count(app, "--seed", command.options.seed, std::uint64_t{0}, "Breaks ties between edges of equal cost [0]");
  app.add_flag("--flip", command.options.accept_inside_out, "Turn an inside-out input round instead of refusing it");
  add_weld(app, command.weld);
  app.add_option("--stats", command.stats, "JSON statistics to write, also when the run fails")->type_name("FILE");
  add_format(app, format);
  app.add_flag("--quiet", command.quiet, "No progress bar and no summary; errors are still printed");
  app.callback([&command, &format, &no_flips] {
    command.format = output_format(command.output, format);
    command.options.flips = !no_flips;
    if (command.output == "-" && command.stats == "-") {
      throw CLI::ValidationError("--stats", "the cage and the statistics cannot both go to standard output");
    }
  });
}

void add_check(CLI::App& app, CheckCommand& command) {
  app.add_option("INPUT", command.input, "Mesh to validate; - reads standard input")->required()->type_name("");
  app.add_option("--cage", command.cage, "Certify this cage against INPUT instead")->type_name("FILE");
  app.add_flag("--json", command.json, "Report as JSON");
  add_weld(app, command.weld);
  add_threads(app, command.threads);
  app.callback([&command] {
    if (command.input == "-" && command.cage == "-") {
      throw CLI::ValidationError("--cage", "the mesh and the cage cannot both come from standard input");
    }
  });
}

void add_info(CLI::App& app, InfoCommand& command) {
  app.add_option("FILE", command.file, "Mesh file; - reads standard input")->required()->type_name("");
  app.add_flag("--json", command.json, "Report as JSON");
}

void add_make(CLI::App& app, MakeCommand& command, std::optional<MeshFormat>& format) {
  app.add_option("SHAPE", command.shape, "Name of a built-in shape (see --list)")->type_name("");
  app.add_flag("--list", command.list, "Name the shapes");
  add_count(app, "--faces", command.faces, std::size_t{1}, "Faces of the mesh, roughly");
  add_count(app, "--seed", command.seed, std::uint64_t{0}, "Varies the shape [0]");
  app.add_option("-o,--output", command.output, "Mesh to write; - writes standard output (needs --format)")
      ->type_name("FILE");
  add_format(app, format);
  app.callback([&command, &format] {
    if (command.list) return;
    if (command.shape.empty()) throw CLI::RequiredError("SHAPE");
    if (command.faces == 0) throw CLI::RequiredError("--faces");
    if (command.output.empty()) throw CLI::RequiredError("--output");
    command.format = output_format(command.output, format);
  });
}

// Flags that turn off what is on by default.
struct RenderSwitches {
  bool single = false;
  bool facets = false;
  bool no_shadow = false;
};

void add_camera(CLI::App& app, RenderOptions& options) {
  app.add_option("--azimuth", options.azimuth, "Where the camera is: 0 the +z side, 90 the +x side [30]")
      ->type_name("DEGREES");
  app.add_option("--elevation", options.elevation, "90 is straight above [18]")
      ->check(CLI::Range(-90.0, 90.0))
      ->type_name("DEGREES");
  app.add_flag("--z-up", options.z_up, "The z axis is up instead of y; azimuth 0 is then the -y side");
}

void add_render(CLI::App& app, RenderCommand& command, RenderSwitches& switches) {
  app.add_option("INPUT", command.input, "Mesh to draw; - reads standard input")->required()->type_name("");
  app.add_option("CAGE", command.cage, "Its cage: draws input, cage over input and cage, side by side")->type_name("");
  app.add_option("-o,--output", command.output, "PNG picture to write; - writes standard output")
      ->required()
      ->type_name("FILE");
  app.add_option("--width", command.options.width, "Pixels of the whole picture [1800]")
      ->check(CLI::Range(16, 16384))
      ->type_name("N");
  app.add_option("--height", command.options.height, "[640]")->check(CLI::Range(16, 16384))->type_name("N");
  add_camera(app, command.options);
  app.add_flag("--single", switches.single, "One picture, cage over input");
  app.add_flag("--facets", switches.facets, "Draw the facets of the input instead of smooth shading");
  app.add_flag("--no-shadow", switches.no_shadow, "No shadow on the ground");
  app.add_option("--samples", command.options.samples, "Samples of a pixel along each axis [4]")
      ->check(CLI::Range(1, 16))
      ->type_name("N");
  add_threads(app, command.options.threads);
  app.callback([&command, &switches] {
    command.options.panels = !switches.single;
    command.options.smooth = !switches.facets;
    command.options.shadow = !switches.no_shadow;
    if (command.input == "-" && command.cage == "-") {
      throw CLI::ValidationError("CAGE", "the mesh and the cage cannot both come from standard input");
    }
  });
}

// What the parser fills in. The command that was named is the one to run.
struct Parsed {
  CageCommand cage;
  CheckCommand check;
  InfoCommand info;
  MakeCommand make;
  RenderCommand render;
  RenderSwitches render_switches;
  std::optional<MeshFormat> cage_format;
  std::optional<MeshFormat> make_format;
  bool no_flips = false;
  std::string help_topic;
};

void add_commands(CLI::App& app, Parsed& parsed) {
  add_cage(*app.add_subcommand("cage", "Make a certified cage of few faces around a dense mesh"), parsed.cage,
           parsed.cage_format, parsed.no_flips);
  add_check(*app.add_subcommand("check", "Validate a mesh, or certify a cage against a mesh"), parsed.check);
  add_info(*app.add_subcommand("info", "Describe a mesh file"), parsed.info);
  add_make(*app.add_subcommand("make", "Write a built-in shape"), parsed.make, parsed.make_format);
  add_render(*app.add_subcommand("render", "Draw a mesh, and its cage, as a PNG picture"), parsed.render,
             parsed.render_switches);
  app.add_subcommand("help", "Describe a command")
      ->add_option("COMMAND", parsed.help_topic, "Name of the command")
      ->type_name("");
  for (CLI::App* command : app.get_subcommands({})) command->footer(exit_codes_help);
  app.require_subcommand(0, 1);  // none is refused below: the parser would complain of it before a misspelt one
  app.footer(exit_codes_help);
  app.set_version_flag("--version", &version_text, "Print the version and the licences, and exit");
}

// "help" asked for by name; the option --help is the parser's.
void print_help(const CLI::App& app, const std::string& topic) {
  if (topic.empty()) throw CLI::CallForHelp();
  const auto commands = app.get_subcommands([&](const CLI::App* command) { return command->get_name() == topic; });
  if (commands.empty()) throw CLI::ValidationError("help", "no such command '" + topic + "'");
  std::cout << commands.front()->help("prcage");
}

std::optional<Command> chosen(const CLI::App& app, const Parsed& parsed) {
  if (app.got_subcommand("cage")) return parsed.cage;
  if (app.got_subcommand("check")) return parsed.check;
  if (app.got_subcommand("info")) return parsed.info;
  if (app.got_subcommand("make")) return parsed.make;
  if (app.got_subcommand("render")) return parsed.render;
  return std::nullopt;
}

std::string usage_error(const CLI::App* app, const CLI::Error& error) {
  const auto commands = app->get_subcommands();
  const std::string command = commands.empty() ? "" : " " + commands.front()->get_name();
  return fmt::format("prcage: error: {}\nTry 'prcage{} --help'.\n", error.what(), command);
}

}  // namespace

bool parse_ratio(const std::string& text, double& value) {
  const std::size_t slash = text.find('/');
  double numerator = 0;
  double denominator = 1;
  if (!parse_decimal(std::string_view(text).substr(0, slash), numerator)) return false;
  if (slash != std::string::npos && !parse_decimal(std::string_view(text).substr(slash + 1), denominator)) return false;
  const double ratio = numerator / denominator;
  if (!(std::isfinite(denominator) && std::isfinite(ratio) && numerator > 0 && ratio > 0)) return false;
  value = ratio;
  return true;
}

CommandLine parse_command_line(int argc, const char* const* argv) {
  CLI::App app("Certified tight bounding cages of triangle meshes", "prcage");
  Parsed parsed;
  add_commands(app, parsed);
  app.failure_message(&usage_error);
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) throw CLI::RequiredError("A command");
    if (app.got_subcommand("help")) print_help(app, parsed.help_topic);
  } catch (const CLI::ParseError& error) {
    return {std::nullopt, app.exit(error) == 0 ? ExitCode::ok : ExitCode::usage};
  }
  return {chosen(app, parsed), ExitCode::ok};
}

}  // namespace prcage
