#include "tools/cli_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <iostream>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "core/schedule.h"
#include "tools/cli_help.h"
#include "tools/scale_bar.h"

namespace prcage {
namespace {

constexpr const char* licence_text = "Licence: Apache-2.0. Nothing that it links requires the GPL. Libraries:\n";
constexpr const char* licence_with_wrap_text =
    "Licence: Apache-2.0; GPL-3.0-or-later as a whole, because of the alpha wrap that is built in. Libraries:\n"
    "  CGAL Alpha_wrap_3 and what it uses of CGAL (GPL-3.0-or-later),\n";
constexpr const char* libraries_text =
    "  CGAL kernel (LGPL-3.0-or-later), GMP and MPFR (LGPL-3.0-or-later), Embree (Apache-2.0), oneTBB (Apache-2.0),\n"
    "  OpenVDB (MPL-2.0), Eigen (MPL-2.0), Boost (BSL-1.0), xsimd (BSD-3-Clause), {fmt} (MIT), CLI11 (BSD-3-Clause),\n"
    "  JSON for Modern C++ (MIT), xxHash (BSD-2-Clause), SQLite (public domain), zlib (Zlib), libpng (libpng-2.0),\n"
    "  meshoptimizer (MIT), stb (MIT); in the page of a report: three.js (MIT), Tabulator (MIT), Observable Plot and "
    "D3 (ISC)";

std::string version_text() {
  return fmt::format("prcage {}\n{}{}", version(), has_alpha_wrap() ? licence_with_wrap_text : licence_text,
                     libraries_text);
}

bool parse_decimal(std::string_view text, double& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && stop == end;
}

// --------------------------------------------------------------------------------- options of several commands

// A positive number of at most `most`.
CLI::Option* add_ratio(CLI::App& app, const std::string& name, double& value, double most, const std::string& help) {
  const auto parse = [name, &value, most](const std::string& text) {
    double parsed = 0;
    if (!parse_ratio(text, parsed)) {
      throw CLI::ValidationError(name, fmt::format("'{}' is not a positive number such as 0.025 or 1/40", text));
    }
    if (parsed > most) {
      throw CLI::ValidationError(name, fmt::format("'{}' is out of range: above 0, at most {}", text, most));
    }
    value = parsed;
  };
  return app.add_option_function<std::string>(name, parse, help)->type_name("X");
}

template <typename Integer>
struct CountRange {
  Integer least = 0;
  Integer most = std::numeric_limits<Integer>::max();

  std::string text() const {
    const bool bounded = most < std::numeric_limits<Integer>::max();
    return bounded ? fmt::format("from {} to {}", least, most) : fmt::format("of at least {}", least);
  }
};

// Whole decimal number. The parser's own conversion takes -1 as a huge unsigned number and 010 as an octal one.
template <typename Integer>
bool parse_whole(std::string_view text, Integer& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && stop == end;
}

template <typename Integer>
CLI::Option* add_count(CLI::App& app, const std::string& name, Integer& value, CountRange<Integer> range,
                       const std::string& help) {
  const auto parse = [name, &value, range](const std::string& text) {
    Integer parsed{};
    if (!parse_whole(text, parsed) || parsed < range.least || parsed > range.most) {
      throw CLI::ValidationError(name, fmt::format("'{}' is not a whole number {}", text, range.text()));
    }
    value = parsed;
  };
  return app.add_option_function<std::string>(name, parse, help)->type_name("N");
}

void add_degrees(CLI::App& app, const std::string& name, double& value, double most, const std::string& help) {
  const auto parse = [name, &value, most](const std::string& text) {
    double parsed = 0;
    if (!parse_decimal(text, parsed) || !(std::abs(parsed) <= most)) {
      throw CLI::ValidationError(name, fmt::format("'{}' is not a number from {} to {}", text, -most, most));
    }
    value = parsed;
  };
  app.add_option_function<std::string>(name, parse, help)->type_name("DEGREES");
}

CLI::Option* add_format(CLI::App& app, std::optional<MeshFormat>& format) {
  const auto parse = [&format](const std::string& name) {
    if (!parse_mesh_format(name, format.emplace())) {
      throw CLI::ValidationError("--format", fmt::format("no such format '{}'", name));
    }
  };
  return app
      .add_option_function<std::string>("--format", parse,
                                        "Format to write: ply, ply-ascii, obj, stl, stl-ascii, off\n"
                                        "[by the extension of the output]")
      ->type_name("NAME");
}

void add_threads(CLI::App& app, int& threads) {
  add_count(app, "--threads", threads, {0, 4096},
            "Threads; 0: as many as the machine has [0];\nthe result does not depend on it");
}

// The parser would accept "--quiet=maybe" and pass over the value.
CLI::Option* add_flag(CLI::App& app, const std::string& name, bool& value, const std::string& help) {
  return app.add_flag(name, value, help)->disable_flag_override();
}

void add_weld(CLI::App& app, bool& weld) {
  add_flag(app, "--weld", weld, "Merge vertices of the input at equal positions (STL is always welded)");
}

MeshFormat format_of_extension(const std::string& option, const std::string& path, const std::string& remedy) {
  MeshFormat format{};
  if (mesh_format_of_path(path, format)) return format;
  const std::string what = path == "-" ? std::string("standard output has no extension")
                                       : fmt::format("the extension of '{}' is none of .ply, .obj, .stl, .off", path);
  throw CLI::ValidationError(option, what + remedy);
}

// The format to write `path` in: as asked for, or as its extension says.
MeshFormat output_format(const std::string& path, const std::optional<MeshFormat>& asked) {
  return asked ? *asked : format_of_extension("--output", path, ": say --format");
}

// ----------------------------------------------------------------------------------------------- the commands
//
// The ranges are those of the library, refused here before a large file is read.

std::vector<double> parse_schedule(const std::string& text) {
  std::vector<double> schedule;
  bool rises = true;
  const std::string steps = fmt::format("{},", text);  // every step ends in a comma, an empty last one, too
  for (const std::string& step : CLI::detail::split(steps, ',')) {
    double beta = 0;
    rises = rises && parse_ratio(step, beta) && (schedule.empty() || beta > schedule.back());
    schedule.push_back(beta);
  }
  if (rises && !schedule.empty() && schedule.back() == 1) return schedule;
  throw CLI::ValidationError("--schedule",
                             fmt::format("'{}' is not a rising list of numbers above 0 that ends at 1", text));
}

TauMode parse_tau_mode(const std::string& mode) {
  if (mode == "strict") return TauMode::strict;
  if (mode == "paper") return TauMode::paper;
  throw CLI::ValidationError("--tau-mode", fmt::format("'{}' is neither strict nor paper", mode));
}

void add_tau(CLI::App& app, Options& options) {
  CLI::Option* tau = add_ratio(app, "--tau", options.tau, 1,
                               "Thickness of the band around the input that the cage may use,\n"
                               "relative to the diagonal of its bounding box, at most 1 [1/40]");
  CLI::Option* absolute = add_ratio(app, "--tau-abs", options.tau_absolute, std::numeric_limits<double>::infinity(),
                                    "The same in the unit of the input, instead of --tau");
  tau->excludes(absolute);
  app.add_option_function<std::string>(
         "--tau-mode", [&options](const std::string& mode) { options.tau_mode = parse_tau_mode(mode); },
         "strict: every point of the cage is proved within tau [strict]\n"
         "paper: only the centroids of the faces are tested")
      ->type_name("strict|paper");
}

Quality parse_quality(const std::string& text) {
  for (const Quality quality : {Quality::fast, Quality::standard, Quality::best})
    if (text == to_string(quality)) return quality;
  throw CLI::ValidationError("--quality", fmt::format("'{}' is none of fast, default and best", text));
}

void add_quality(CLI::App& app, Options& options) {
  app.add_option_function<std::string>(
         "--quality", [&options](const std::string& text) { options.quality = parse_quality(text); },
         "What tightness may cost: finer steps of the thickness, and how often\n"
         "vertices are moved back inward [default]")
      ->type_name("fast|default|best");
}

Bound parse_bound(const std::string& text) {
  if (text == "cage") return Bound::cage;
  if (text == "both") return Bound::both;
  throw CLI::ValidationError("--bound", fmt::format("'{}' is neither cage nor both", text));
}

void add_bound(CLI::App& app, Options& options) {
  app.add_option_function<std::string>(
         "--bound", [&options](const std::string& text) { options.bound = parse_bound(text); },
         "cage: tau bounds the distance of the cage to the input [with --tau]\n"
         "both: that of samples of the input to the cage, too [without --tau]")
      ->type_name("cage|both");
}

// Without a thickness or a schedule of it, a number of faces asks for the smallest thickness that reaches it.
void find_thickness_if_free(const CLI::App& app, Options& options, bool levels = false) {
  for (const char* name : {"--tau", "--tau-abs", "--cycles", "--schedule"})
    if (app.count(name) != 0) return;
  if (options.face_budget == 0 && !levels) return;
  options.tau = 0;
  if (app.count("--bound") == 0) options.bound = Bound::both;
}

void add_schedule(CLI::App& app, Options& options) {
  CLI::Option* cycles =
      add_count(app, "--cycles", options.cycles, {1, 10000}, "Uniform steps in which tau is released, 1 to 10000 [10]");
  app.add_option_function<std::string>(
         "--schedule", [&options](const std::string& text) { options.schedule = parse_schedule(text); },
         "The steps themselves, instead of --cycles: rising fractions of tau\n"
         "that end at 1, e.g. 1/8,1/4,1/2,1")
      ->type_name("X1,X2,...")
      ->excludes(cycles);
}

// The two ways to a wrap: one for input that is not legal, one for handles that the cage shall not have.
struct WrapOptions {
  bool wrap = false;
  std::string output;
  WrapSettings settings;
  double topology_alpha = 0;  // 0: not given
};

void add_wrap(CLI::App& app, WrapOptions& options) {
  CLI::Option* wrap = app.add_flag("--wrap", options.wrap,
                                   "Accept any triangles (open, intersecting, ...): cage an alpha wrap\n"
                                   "of the input; the cage is certified to enclose every face of it");
  wrap->disable_flag_override();
  add_ratio(app, "--wrap-alpha", options.settings.alpha, 1,
            "With --wrap: radius, relative to the diagonal, of the ball that\n"
            "openings must let through to stay open [1/20 where the input has\n"
            "a boundary, else 1/100]")
      ->needs(wrap);
  add_ratio(app, "--wrap-offset", options.settings.offset, 1,
            "With --wrap: distance of the wrap, relative to the diagonal [1/600]")
      ->needs(wrap);
  add_ratio(app, "--simplify-topology", options.topology_alpha, 1,
            "Close tunnels and handles that a ball of this radius, relative to\n"
            "the diagonal, cannot pass: cage a wrap at a distance of 1/3000")
      ->excludes(wrap);
  app.add_option("--wrap-output", options.output, "Also write the wrap, in the format that the extension says")
      ->type_name("FILE");
}

void choose_wrap(const WrapOptions& options, CageCommand& command) {
  const bool topology = options.topology_alpha > 0;
  if (!options.wrap && !topology) {
    if (options.output.empty()) return;
    throw CLI::ValidationError("--wrap-output", "there is no wrap without --wrap or --simplify-topology");
  }
  if (!has_alpha_wrap()) throw CLI::ValidationError(topology ? "--simplify-topology" : "--wrap", missing_alpha_wrap);
  command.wrap = topology ? WrapSettings{options.topology_alpha, topology_offset} : options.settings;
  command.wrap_output = options.output;
  if (!options.output.empty()) command.wrap_format = format_of_extension("--wrap-output", options.output, "");
}

// What all commands have that make a mesh of another one.
void add_mesh_files(CLI::App& app, MeshCommand& command, const char* made) {
  app.add_option("INPUT", command.input, "Closed triangle mesh (PLY, OBJ, STL, OFF); - is standard input")
      ->required()
      ->type_name("");
  app.add_option("-o,--output", command.output,
                 fmt::format("{} to write (required); - is standard output, needs --format", made))
      ->required()
      ->type_name("OUTPUT");
}

template <class AnyCommand>
void add_input_settings(CLI::App& app, AnyCommand& command) {
  add_count(app, "--seed", command.options.seed, {},
            "Breaks ties between edges of equal cost [0];\nthe same seed gives the same result");
  add_flag(app, "--flip", command.options.accept_inside_out,
           "Accept an inside-out input, whose faces look inward: turn it\nround instead of refusing it");
  add_weld(app, command.weld);
}

void add_run_settings(CLI::App& app, MeshCommand& command, int& threads, std::optional<MeshFormat>& format) {
  add_threads(app, threads);
  app.add_option("--stats", command.stats, "JSON statistics to write, also when the run fails;\n- is standard output")
      ->type_name("FILE");
  add_format(app, format);
  add_flag(app, "--quiet", command.quiet, "No progress bar and no summary; errors are still printed");
}

// What decides on the cage, however many of them are made.
void add_cage_settings(CLI::App& app, CageCommand& command, bool& no_edge_flips) {
  add_tau(app, command.options);
  add_schedule(app, command.options);
  add_count(app, "--faces", command.options.face_budget, {},
            "Stop at N faces (or one below, where parity demands), without --tau at the\n"
            "smallest thickness that allows them; 0: as few as tau allows [0]");
  add_quality(app, command.options);
  add_bound(app, command.options);
  add_flag(app, "--no-edge-flips", no_edge_flips, "Leave out the edge flips that improve triangles between the cycles");
  add_ratio(app, "--sigma", command.options.sigma, 0.01,
            "First displacement off the input, relative to the diagonal,\nat most 0.01 [1e-5]");
  add_input_settings(app, command);
}

std::vector<std::size_t> parse_levels(const std::string& text) {
  std::vector<std::size_t> levels;
  const std::string numbers = fmt::format("{},", text);  // every number ends in a comma, an empty last one, too
  for (const std::string& number : CLI::detail::split(numbers, ',')) {
    if (!parse_whole(number, levels.emplace_back())) levels.back() = 0;
  }
  const std::string error = levels_error(levels);
  if (error.empty()) return levels;
  throw CLI::ValidationError("--levels", fmt::format("'{}' is no list of levels: {}", text, error));
}

void add_levels(CLI::App& app, CageCommand& command) {
  app.add_option_function<std::string>(
         "--levels", [&command](const std::string& text) { command.levels = parse_levels(text); },
         "Nested cages of so many faces, e.g. 5000,1000,200, each strictly\n"
         "around the one before; OUTPUT cage.ply is then cage.5000.ply, ...")
      ->type_name("N1,N2,...")
      ->excludes("--faces");
}

void add_deadline(CLI::App& app, CageCommand& command) {
  add_ratio(app, "--deadline", command.deadline, 1e9,
            "Seconds from the start after which the valid cage reached so far\n"
            "is certified and written, like after Ctrl-C [none]")
      ->type_name("SECONDS");
}

void add_cage(CLI::App& app, CageCommand& command, std::optional<MeshFormat>& format, bool& no_edge_flips,
              WrapOptions& wrap) {
  add_mesh_files(app, command, "Cage");
  add_cage_settings(app, command, no_edge_flips);
  add_levels(app, command);
  add_deadline(app, command);
  add_wrap(app, wrap);
  add_run_settings(app, command, command.options.threads, format);
  app.callback([&app, &command, &format, &no_edge_flips, &wrap] {
    find_thickness_if_free(app, command.options, !command.levels.empty());
    command.format = output_format(command.output, format);
    choose_wrap(wrap, command);
    command.options.flips = !no_edge_flips;
    if (command.output == "-" && !command.levels.empty()) {
      throw CLI::ValidationError("--levels", "standard output cannot hold several cages: name a file with --output");
    }
    if (command.output == "-" && command.stats == "-") {
      throw CLI::ValidationError("--stats", "the cage and the statistics cannot both go to standard output");
    }
  });
}

// The options of simplify and lowpoly that do not decide on the tolerances.
template <class AnyCommand>
void add_surface_settings(CLI::App& app, AnyCommand& command, std::optional<MeshFormat>& format, bool& no_edge_flips) {
  add_flag(app, "--no-edge-flips", no_edge_flips, "Leave out the edge flips that improve triangles between the cycles");
  add_input_settings(app, command);
  add_run_settings(app, command, command.options.threads, format);
}

template <class AnyCommand>
void finish_surface(AnyCommand& command, const std::optional<MeshFormat>& format, bool no_edge_flips) {
  command.format = output_format(command.output, format);
  command.options.flips = !no_edge_flips;
  if (command.output == "-" && command.stats == "-")
    throw CLI::ValidationError("--stats", "the mesh and the statistics cannot both go to standard output");
}

void add_tolerances(CLI::App& app, SimplifyOptions& options, double& tau) {
  CLI::Option* both = add_ratio(app, "--tau", tau, std::numeric_limits<double>::infinity(),
                                "How far the surface may be from the input, on both sides, relative to\n"
                                "the diagonal of its bounding box, at most 1 [1/100]");
  add_ratio(app, "--tau-inner", options.tau_inner, std::numeric_limits<double>::infinity(),
            "The same inside of the input only [1/100]")
      ->excludes(both);
  add_ratio(app, "--tau-outer", options.tau_outer, std::numeric_limits<double>::infinity(),
            "The same outside of the input only [1/100]")
      ->excludes(both);
  add_flag(app, "--absolute", options.absolute, "The tolerances are in the unit of the input");
  app.add_option_function<std::string>(
         "--tau-mode", [&options](const std::string& mode) { options.tau_mode = parse_tau_mode(mode); },
         "strict: every point of the surface is proved to be within them [strict]\n"
         "paper: only the centroids of the faces are tested")
      ->type_name("strict|paper");
}

void add_simplify_cycles(CLI::App& app, SimplifyOptions& options) {
  CLI::Option* cycles = add_count(app, "--cycles", options.cycles, {1, 10000},
                                  "Uniform steps in which the tolerances are released, 1 to 10000 [10]");
  app.add_option_function<std::string>(
         "--schedule", [&options](const std::string& text) { options.schedule = parse_schedule(text); },
         "The steps themselves, instead of --cycles: rising fractions that end at 1")
      ->type_name("X1,X2,...")
      ->excludes(cycles);
}

struct SimplifySwitches {
  double tau = 0;
  bool no_edge_flips = false;
  bool one_way = false;
};

void finish_simplify(SimplifyCommand& command, const std::optional<MeshFormat>& format,
                     const SimplifySwitches& switches) {
  finish_surface(command, format, switches.no_edge_flips);
  SimplifyOptions& options = command.options;
  if (switches.tau > 0) options.tau_inner = options.tau_outer = switches.tau;
  if (!options.absolute && std::max(options.tau_inner, options.tau_outer) > 1)
    throw CLI::ValidationError("--tau", "is out of range: at most 1, unless --absolute is given");
  options.bound = switches.one_way ? Bound::cage : Bound::both;
}

void add_simplify(CLI::App& app, SimplifyCommand& command, std::optional<MeshFormat>& format,
                  SimplifySwitches& switches) {
  add_mesh_files(app, command, "Mesh");
  add_count(app, "--faces", command.options.face_budget, {},
            "Stop at N faces (or one below, where parity demands);\n0: as few as the tolerances allow [0]");
  add_tolerances(app, command.options, switches.tau);
  add_flag(app, "--one-way", switches.one_way,
           "Bound the distance of the surface to the input only, not that of\n"
           "samples of the input to the surface; no edges are flipped");
  add_simplify_cycles(app, command.options);
  add_surface_settings(app, command, format, switches.no_edge_flips);
  app.callback([&command, &format, &switches] { finish_simplify(command, format, switches); });
}

void add_low_poly(CLI::App& app, LowPolyCommand& command, std::optional<MeshFormat>& format, bool& no_edge_flips) {
  add_mesh_files(app, command, "Mesh");
  add_count(app, "--faces", command.options.faces, {1},
            "Faces of the mesh (required), or one below, where parity demands")
      ->required();
  app.add_option_function<std::string>(
         "--quality", [&command](const std::string& text) { command.options.quality = parse_quality(text); },
         "How finely the tolerances grow [default]")
      ->type_name("fast|default|best");
  add_ratio(app, "--inner-share", command.options.inner_share, 1,
            "The tolerance inside of the input over that outside of it, at most 1 [1/2]");
  add_flag(app, "--no-wrap", command.no_wrap,
           "Equal tolerances on both sides; hollows are not filled up to an\n"
           "alpha wrap of the input");
  add_surface_settings(app, command, format, no_edge_flips);
  app.callback([&command, &format, &no_edge_flips] { finish_surface(command, format, no_edge_flips); });
}

void add_check(CLI::App& app, CheckCommand& command) {
  app.add_option("INPUT", command.input, "Mesh to validate; - is standard input")->required()->type_name("");
  CLI::Option* cage =
      app.add_option("--cage", command.cage, "Certify this cage against INPUT instead; - is standard input");
  cage->type_name("FILE");
  app.add_option("--wrap", command.wrap,
                 "The wrap of INPUT that was caged: the cage must enclose every face of\n"
                 "INPUT, whatever these form, and have the topology of the wrap")
      ->type_name("FILE")
      ->needs(cage);
  add_flag(app, "--json", command.json, "Report as JSON");
  add_weld(app, command.weld);
  add_threads(app, command.threads);
  app.callback([&command] {
    if (command.input == "-" && command.cage == "-") {
      throw CLI::ValidationError("--cage", "the mesh and the cage cannot both come from standard input");
    }
    if (command.wrap == "-") throw CLI::ValidationError("--wrap", "the wrap cannot come from standard input");
  });
}

void add_violation(CLI::App& app, MeasureOptions& options) {
  CLI::Option* tau = add_ratio(app, "--tau", options.tau, 1,
                               "Measure by how much the cage exceeds this thickness, too,\n"
                               "relative to the diagonal of the input's bounding box, at most 1");
  CLI::Option* absolute = add_ratio(app, "--tau-abs", options.tau_absolute, std::numeric_limits<double>::infinity(),
                                    "The same in the unit of the input, instead of --tau");
  tau->excludes(absolute);
}

void add_eval(CLI::App& app, EvalCommand& command) {
  app.add_option("INPUT", command.input, "Mesh that the cage is of; - is standard input")->required()->type_name("");
  app.add_option("CAGE", command.cage, "Cage to measure; - is standard input")->required()->type_name("");
  add_violation(app, command.options);
  add_count(app, "--samples", command.options.samples, {1, 1000000000},
            "Points on each surface, 1 to 1000000000 [100000]");
  add_count(app, "--seed", command.options.seed, {}, "Varies the points [0]; the same seed gives the same result");
  add_count(app, "--views", command.options.views, {0, 1000},
            "Views in which the silhouettes are compared, 0 to 1000 [24]");
  app.add_option("--json", command.json, "JSON report to write; - is standard output, instead of the table")
      ->type_name("FILE");
  add_weld(app, command.weld);
  add_threads(app, command.options.threads);
  app.callback([&command] {
    if (command.input == "-" && command.cage == "-") {
      throw CLI::ValidationError("CAGE", "the mesh and the cage cannot both come from standard input");
    }
  });
}

void add_info(CLI::App& app, InfoCommand& command) {
  app.add_option("FILE", command.file, "Mesh file; - is standard input")->required()->type_name("");
  add_flag(app, "--json", command.json, "Report as JSON");
}

void add_make(CLI::App& app, MakeCommand& command, std::optional<MeshFormat>& format) {
  app.add_option("SHAPE", command.shape, "Name of a built-in shape (see --list)")->type_name("");
  add_flag(app, "--list", command.list, "Name the shapes; takes no other argument");
  add_count(app, "--faces", command.faces, {1},
            "Faces of the mesh (required), met within a few percent from 1000 on;\n"
            "the gyroid within 20 percent");
  add_count(app, "--seed", command.seed, {}, "Varies the shape [0]; the same seed gives the same mesh");
  app.add_option("-o,--output", command.output, "Mesh to write (required); - is standard output, needs --format")
      ->type_name("OUTPUT");
  add_format(app, format);
  app.callback([&app, &command, &format] {
    if (command.list) {
      if (app.parse_order().size() > 1) throw CLI::ValidationError("--list", "takes no other argument");
      return;
    }
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
  add_degrees(app, "--azimuth", options.azimuth, 360, "Where the camera is: 0 the +z side, 90 the +x side [30]");
  add_degrees(app, "--elevation", options.elevation, 90, "Height of the camera: 90 is straight above, -90 below [18]");
  add_flag(app, "--z-up", options.z_up, "The z axis is up instead of y; azimuth 0 is then the -y side");
}

void add_picture(CLI::App& app, RenderCommand& command, RenderSwitches& switches) {
  app.add_option("-o,--output", command.output, "PNG picture to write (required); - is standard output")
      ->required()
      ->type_name("OUTPUT");
  add_count(app, "--width", command.options.width, {16, 16384},
            "Pixels of the whole picture across, 16 to 16384 [1800]");
  add_count(app, "--height", command.options.height, {16, 16384}, "Pixels of it from top to bottom, 16 to 16384 [640]");
  add_count(app, "--samples", command.options.samples, {1, 16}, "Samples of a pixel along each axis, 1 to 16 [4]");
  add_flag(app, "--single", switches.single, "One picture, cage over input");
  CLI::Option* const distance =
      add_flag(app, "--distance", command.distance,
               "Colour the cage by its distance to the input, with a scale: instead of the cage alone, or of --single");
  add_ratio(app, "--distance-max", command.options.distance_max, 1,
            "With --distance: where the scale ends, relative to the diagonal [the largest]")
      ->needs(distance);
  add_flag(app, "--facets", switches.facets, "Draw the facets of the input instead of smooth shading");
  add_flag(app, "--no-shadow", switches.no_shadow, "No shadow on the ground");
}

// A name that promises another format than PNG is a slip, and may be that of a mesh that is still needed.
void check_picture_name(const std::string& path) {
  const std::string extension = CLI::detail::to_lower(std::filesystem::path(path).extension().string());
  if (extension.empty() || extension == ".png") return;
  throw CLI::ValidationError(
      "--output",
      fmt::format("'{}' is not the name of a PNG picture: end it in .png, or leave out the extension", path));
}

void add_render(CLI::App& app, RenderCommand& command, RenderSwitches& switches) {
  app.add_option("INPUT", command.input, "Mesh to draw; - is standard input")->required()->type_name("");
  app.add_option("CAGE", command.cage, "Its cage: draws input, cage over input and cage, side by side")->type_name("");
  add_picture(app, command, switches);
  add_camera(app, command.options);
  add_threads(app, command.options.threads);
  app.callback([&command, &switches] {
    command.options.panels = !switches.single;
    command.options.smooth = !switches.facets;
    command.options.shadow = !switches.no_shadow;
    check_picture_name(command.output);
    if (command.distance && command.cage.empty()) {
      throw CLI::ValidationError("--distance", "is that of a cage: name one after the input");
    }
    if (command.distance && command.options.width < least_width_with_scale) {
      throw CLI::ValidationError("--width", fmt::format("with --distance at least {}", least_width_with_scale));
    }
    if (command.input == "-" && command.cage == "-") {
      throw CLI::ValidationError("CAGE", "the mesh and the cage cannot both come from standard input");
    }
  });
}

void add_bind(CLI::App& app, BindCommand& command, bool& floats) {
  app.add_option("INPUT", command.input, "Mesh to bind; - is standard input")->required()->type_name("");
  app.add_option("CAGE", command.cage, "Closed cage to bind it to; - is standard input")->required()->type_name("");
  app.add_option("-o,--output", command.output, "File of weights to write (required); - is standard output")
      ->required()
      ->type_name("WEIGHTS");
  add_count(app, "--keep", command.options.keep, {1},
            "Keep the N largest weights of each vertex, scaled up to the sum 1;\nwhat that costs is reported [all]");
  add_flag(app, "--float", floats, "Store the weights as floats: half the size, errors of 1e-7");
  add_threads(app, command.options.threads);
  add_flag(app, "--quiet", command.quiet, "No summary; errors are still printed");
  app.callback([&command, &floats] {
    command.options.precision = floats ? Precision::float32 : Precision::float64;
    if (command.input == "-" && command.cage == "-") {
      throw CLI::ValidationError("CAGE", "the mesh and the cage cannot both come from standard input");
    }
  });
}

std::size_t parse_axis(const std::string& text) {
  for (const std::size_t axis : {0u, 1u, 2u})
    if (text == std::string(1, "xyz"[axis])) return axis;
  throw CLI::ValidationError("--axis", fmt::format("'{}' is none of x, y and z", text));
}

void add_pose(CLI::App& app, PoseCommand& command, std::optional<MeshFormat>& format) {
  app.add_option("CAGE", command.input, "Cage, or any mesh; - is standard input")->required()->type_name("");
  app.add_option("-o,--output", command.output, "Mesh to write (required); - is standard output, needs --format")
      ->required()
      ->type_name("OUTPUT");
  add_degrees(app, "--bend", command.options.bend, 3600, "Bend it by so much from end to end");
  add_degrees(app, "--twist", command.options.twist, 3600, "Twist it by so much from end to end; before --bend");
  app.add_option_function<std::string>(
         "--axis", [&command](const std::string& text) { command.options.axis = parse_axis(text); },
         "The axis from end to end [that of the longest side of the\nbounding box]")
      ->type_name("x|y|z");
  add_format(app, format);
  app.callback([&app, &command, &format] {
    if (app.count("--bend") + app.count("--twist") == 0) throw CLI::RequiredError("--bend or --twist");
    command.format = output_format(command.output, format);
  });
}

void add_deform(CLI::App& app, DeformCommand& command, std::vector<std::string>& files,
                std::optional<MeshFormat>& format) {
  app.add_option("FILES", files,
                 "WEIGHTS of prcage bind, or INPUT and the CAGE to bind it to;\n"
                 "then DEFORMED_CAGE, which has the same vertices in the same order.\n"
                 "One of them may be -, standard input")
      ->type_name("");
  app.add_option("-o,--output", command.output, "Mesh to write (required); - is standard output, needs --format")
      ->required()
      ->type_name("OUTPUT");
  add_format(app, format);
  add_threads(app, command.threads);
  app.callback([&command, &files, &format] {
    if (files.size() < 2) throw CLI::RequiredError(files.empty() ? "WEIGHTS" : "DEFORMED_CAGE");
    if (files.size() > 3) throw CLI::ValidationError(fmt::format("unexpected argument '{}'", files[3]));
    if (std::count(files.begin(), files.end(), "-") > 1)
      throw CLI::ValidationError("FILES", "only one of them can come from standard input");
    command.deformed_cage = files.back();
    if (files.size() == 2) {
      command.weights = files[0];
    } else {
      command.input = files[0];
      command.cage = files[1];
    }
    command.format = output_format(command.output, format);
  });
}

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  const bool slash = index.ec == std::errc{} && index.ptr != end && *index.ptr == '/';
  const auto count = slash ? std::from_chars(index.ptr + 1, end, shard.count) : index;
  const bool whole = slash && count.ec == std::errc{} && count.ptr == end;
  if (whole && shard.index >= 1 && shard.index <= shard.count) return shard;
  throw CLI::ValidationError("--shard", fmt::format("'{}' is not I/N, part I of N, I from 1 to N", text));
}

// How a batch goes about its work; none of it decides on a cage.
void add_batch_work(CLI::App& app, BatchCommand& command) {
  add_count(app, "--jobs", command.jobs, {0, 4096}, "Meshes at a time; 0: as many as have a core for each thread [0]");
  add_count(app, "--threads", command.cage.options.threads, {0, 4096},
            "Threads for each mesh; 0: cores divided by jobs [0]");
  add_ratio(app, "--timeout", command.timeout, 1e9, "Seconds for each process, then it is given up [none]");
  add_count(app, "--memory-limit", command.memory_limit_mb, {1, 1 << 30},
            "Megabytes of address space for each process [none]");
  app.add_option_function<std::string>(
         "--shard", [&command](const std::string& text) { command.shard = parse_shard(text); },
         "Only part I of N, with a table of its own; see prcage merge")
      ->type_name("I/N");
}

void add_batch(CLI::App& app, BatchCommand& command, std::optional<MeshFormat>& format, bool& no_edge_flips) {
  app.add_option("INPUT", command.input, "Directory with meshes at any depth, or a text file with\na path on each line")
      ->required()
      ->type_name("");
  app.add_option("-o,--output", command.output, "Directory for the cages and their table (required)")
      ->required()
      ->type_name("DIR");
  add_cage_settings(app, command.cage, no_edge_flips);
  add_format(app, format)->description("Format of the cages: ply, ply-ascii, obj, stl, stl-ascii, off [ply]");
  add_batch_work(app, command);
  add_flag(app, "--no-eval", command.no_eval, "Do not measure the cages: no distances, normals, angles in the table");
  CLI::Option* resume =
      add_flag(app, "--resume", command.resume, "Go on with a batch that was ended: only what is not in the table");
  add_flag(app, "--retry-failed", command.retry_failed, "With --resume: again those without a cage, too")
      ->needs(resume);
  CLI::Option* progress =
      add_flag(app, "--progress", command.progress, "A line for each mesh instead of a progress bar, as for a log");
  add_flag(app, "--quiet", command.quiet, "No progress, no failures, no summary; errors are still printed")
      ->excludes(progress);
  app.callback([&app, &command, &format, &no_edge_flips] {
    find_thickness_if_free(app, command.cage.options);
    command.cage.format = format.value_or(MeshFormat::ply_binary);
    command.cage.options.flips = !no_edge_flips;
  });
}

void add_merge(CLI::App& app, MergeCommand& command) {
  app.add_option("TABLES", command.tables, "Tables of prcage batch")->required()->type_name("");
  app.add_option("-o,--output", command.output, "Table to write (required); must not be there yet")
      ->required()
      ->type_name("TABLE");
  add_flag(app, "--mix-settings", command.mix_settings, "Accept tables that were made with different settings");
}

void add_report(CLI::App& app, ReportCommand& command) {
  app.add_option("TABLE", command.table, "Table of prcage batch or merge; it is only read")->required()->type_name("");
  app.add_option("-o,--output", command.output, "HTML page to write (required); - is standard output")
      ->required()
      ->type_name("OUTPUT");
  app.add_option("--title", command.title, "Title of the page [the name of the table]")->type_name("TITLE");
  add_count(app, "--models", command.models, {0, 10000},
            "Models to show in 3D, the worst first, up to 10000 [24];\neach takes less than a megabyte of the page");
}

// What the parser fills in. The command that was named is the one to run.
struct Parsed {
  CageCommand cage;
  CheckCommand check;
  EvalCommand eval;
  InfoCommand info;
  MakeCommand make;
  RenderCommand render;
  RenderSwitches render_switches;
  BindCommand bind;
  bool bind_floats = false;
  PoseCommand pose;
  DeformCommand deform;
  std::vector<std::string> deform_files;
  BatchCommand batch;
  MergeCommand merge;
  ReportCommand report;
  std::optional<MeshFormat> pose_format;
  std::optional<MeshFormat> deform_format;
  SimplifyCommand simplify;
  SimplifySwitches simplify_switches;
  std::optional<MeshFormat> simplify_format;
  LowPolyCommand low_poly;
  std::optional<MeshFormat> low_poly_format;
  std::optional<MeshFormat> batch_format;
  std::optional<MeshFormat> cage_format;
  std::optional<MeshFormat> make_format;
  bool no_edge_flips = false;
  WrapOptions wrap;
  std::string help_topic;
};

constexpr const char* example_help =
    "COMMAND is required; 'prcage COMMAND --help' describes it.\n\n"
    "Example:\n"
    "  prcage make knot --faces 20000 -o knot.ply\n"
    "  prcage cage knot.ply -o knot-cage.ply\n"
    "  prcage check knot.ply --cage knot-cage.ply\n\n";

// `codes`: those that the command can return beside those of every command.
CLI::App& add_command(CLI::App& app, const std::string& name, const std::string& what, std::vector<std::string> usages,
                      std::initializer_list<ExitCode> codes) {
  std::vector<ExitCode> all{ExitCode::ok, ExitCode::internal_error, ExitCode::usage};
  all.insert(all.end(), codes);
  CLI::App* command = app.add_subcommand(name, what)->group("Commands");
  set_help(*command, std::move(usages), exit_codes_help(all));
  return *command;
}

void add_commands(CLI::App& app, Parsed& parsed) {
  using enum ExitCode;
  add_cage(
      add_command(
          app, "cage", "Make a certified cage of few faces around a dense mesh", {"INPUT -o OUTPUT [OPTIONS]"},
          {cannot_read, invalid_mesh, face_budget_not_reached, no_cage, cannot_write, deadline_reached, interrupted}),
      parsed.cage, parsed.cage_format, parsed.no_edge_flips, parsed.wrap);
  add_check(add_command(app, "check", "Validate a mesh, or certify a cage against a mesh",
                        {"INPUT [OPTIONS]", "INPUT --cage FILE [OPTIONS]"},
                        {cannot_read, invalid_mesh, no_cage, cannot_write}),
            parsed.check);
  add_eval(add_command(app, "eval", "Measure a cage: distances, normals, thickness, sizes, angles",
                       {"INPUT CAGE [OPTIONS]"}, {cannot_read, invalid_mesh, no_cage, cannot_write}),
           parsed.eval);
  add_info(add_command(app, "info", "Describe a mesh file", {"FILE [OPTIONS]"}, {cannot_read, cannot_write}),
           parsed.info);
  add_make(add_command(app, "make", "Write a built-in shape", {"SHAPE --faces N -o OUTPUT [OPTIONS]", "--list"},
                       {cannot_write}),
           parsed.make, parsed.make_format);
  add_render(add_command(app, "render", "Draw a mesh, and its cage, as a PNG picture",
                         {"INPUT [CAGE] -o OUTPUT [OPTIONS]"}, {cannot_read, invalid_mesh, cannot_write}),
             parsed.render, parsed.render_switches);
  add_bind(add_command(app, "bind", "Bind a mesh to a cage by mean value coordinates",
                       {"INPUT CAGE -o WEIGHTS [OPTIONS]"}, {cannot_read, invalid_mesh, cannot_write}),
           parsed.bind, parsed.bind_floats);
  add_pose(add_command(app, "pose", "Bend or twist a cage",
                       {"CAGE --bend DEGREES -o OUTPUT [OPTIONS]", "CAGE --twist DEGREES -o OUTPUT [OPTIONS]"},
                       {cannot_read, cannot_write}),
           parsed.pose, parsed.pose_format);
  add_deform(add_command(app, "deform", "Deform a mesh by its deformed cage",
                         {"WEIGHTS DEFORMED_CAGE -o OUTPUT [OPTIONS]", "INPUT CAGE DEFORMED_CAGE -o OUTPUT [OPTIONS]"},
                         {cannot_read, invalid_mesh, cannot_write}),
             parsed.deform, parsed.deform_files, parsed.deform_format);
  add_batch(add_command(app, "batch", "Make the cages of a whole directory, each in a process of its own",
                        {"INPUT -o DIR [OPTIONS]"},
                        {cannot_read, face_budget_not_reached, cannot_write, some_failed, interrupted}),
            parsed.batch, parsed.batch_format, parsed.no_edge_flips);
  add_merge(add_command(app, "merge", "Unite the tables of the shards of a batch", {"TABLES... -o TABLE [OPTIONS]"},
                        {cannot_read, cannot_write}),
            parsed.merge);
  add_report(add_command(app, "report", "Make a page to look at from the table of a batch",
                         {"TABLE -o OUTPUT [OPTIONS]"}, {cannot_read, cannot_write}),
             parsed.report);
  add_simplify(add_command(app, "simplify", "Simplify a mesh within a tolerance on each side of it",
                           {"INPUT -o OUTPUT [OPTIONS]"},
                           {cannot_read, invalid_mesh, face_budget_not_reached, no_cage, cannot_write, interrupted}),
               parsed.simplify, parsed.simplify_format, parsed.simplify_switches);
  add_low_poly(add_command(app, "lowpoly", "Make a mesh of very few faces that keeps the outlines",
                           {"INPUT -o OUTPUT --faces N [OPTIONS]"},
                           {cannot_read, invalid_mesh, face_budget_not_reached, no_cage, cannot_write, interrupted}),
               parsed.low_poly, parsed.low_poly_format, parsed.no_edge_flips);
  add_command(app, "help", "Describe a command", {"[COMMAND]"}, {})
      .add_option("COMMAND", parsed.help_topic, "Name of the command")
      ->type_name("");
  app.require_subcommand(0, 1);  // none is refused below: the parser would complain of it before a misspelt one
  set_help(app, {"COMMAND [ARGUMENTS] [OPTIONS]"}, example_help + exit_codes_help(all_exit_codes));
  app.set_version_flag("--version", &version_text, "Print the version and the licences, and exit");
}

// "help" asked for by name; the option --help is the parser's.
void print_help(const CLI::App& app, const std::string& topic) {
  if (topic.empty()) throw CLI::CallForHelp();
  const auto commands = app.get_subcommands([&](const CLI::App* command) { return command->get_name() == topic; });
  if (commands.empty()) throw CLI::ValidationError(unknown_command(app, topic));
  std::cout << commands.front()->help("prcage");
}

std::optional<Command> chosen(const CLI::App& app, const Parsed& parsed) {
  if (app.got_subcommand("cage")) return parsed.cage;
  if (app.got_subcommand("check")) return parsed.check;
  if (app.got_subcommand("eval")) return parsed.eval;
  if (app.got_subcommand("info")) return parsed.info;
  if (app.got_subcommand("make")) return parsed.make;
  if (app.got_subcommand("render")) return parsed.render;
  if (app.got_subcommand("bind")) return parsed.bind;
  if (app.got_subcommand("pose")) return parsed.pose;
  if (app.got_subcommand("deform")) return parsed.deform;
  if (app.got_subcommand("batch")) return parsed.batch;
  if (app.got_subcommand("merge")) return parsed.merge;
  if (app.got_subcommand("report")) return parsed.report;
  if (app.got_subcommand("simplify")) return parsed.simplify;
  if (app.got_subcommand("lowpoly")) return parsed.low_poly;
  return std::nullopt;
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
