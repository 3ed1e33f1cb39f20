// The options of prcage simplify and lowpoly, which make surfaces that are near the input on both of its sides.
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

#include "tools/cli_command_options.h"
#include "tools/cli_option_groups.h"

namespace prcage {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();

// The options of both that do not decide on the tolerances.
template <class AnyCommand>
void add_surface_settings(CLI::App& app, AnyCommand& command, std::optional<MeshFormat>& format) {
  add_edge_flips(app, command.options.flips);
  add_input_settings(app, command);
  add_run_settings(app, command, command.options.threads, format);
}

void finish_surface(MeshCommand& command, const std::optional<MeshFormat>& format) {
  command.format = output_format(command.output, format);
  refuse_stdout_twice(command, "mesh");
}

void add_tolerances(CLI::App& app, SimplifyOptions& options, double& tau) {
  const AddedOption both = add_ratio(app, "--tau", tau, unbounded,
                                     "How far the surface may be from the input, on both sides, relative to\n"
                                     "the diagonal of its bounding box, at most 1 [1/100]");
  add_ratio(app, "--tau-inner", options.tau_inner, unbounded, "The same inside of the input only [1/100]")
      .excludes(both);
  add_ratio(app, "--tau-outer", options.tau_outer, unbounded, "The same outside of the input only [1/100]")
      .excludes(both);
  add_flag(app, "--absolute", options.absolute, "The tolerances are in the unit of the input");
  add_parsed(app, "--tau-mode", options.tau_mode, &parse_tau_mode, "strict|paper",
             "strict: every point of the surface is proved to be within them [strict]\n"
             "paper: only the centroids of the faces are tested");
}

void add_schedule(CLI::App& app, SimplifyOptions& options) {
  const AddedOption cycles = add_count(app, "--cycles", options.cycles, {1, 10000},
                                       "Uniform steps in which the tolerances are released, 1 to 10000 [10]");
  add_parsed(app, "--schedule", options.schedule, &parse_schedule, "X1,X2,...",
             "The steps themselves, instead of --cycles: rising fractions that end at 1")
      .excludes(cycles);
}

void choose_tolerances(SimplifyOptions& options, double tau, bool one_way) {
  if (tau > 0) options.tau_inner = options.tau_outer = tau;
  if (!options.absolute && std::max(options.tau_inner, options.tau_outer) > 1)
    refuse("--tau", "is out of range: at most 1, unless --absolute is given");
  options.bound = one_way ? Bound::cage : Bound::both;
}

}  // namespace

void add_simplify(CLI::App& app, std::optional<Command>& chosen) {
  struct Parsed {
    SimplifyCommand command;
    std::optional<MeshFormat> format;
    double tau = 0;
    bool one_way = false;
  };
  const auto parsed = std::make_shared<Parsed>();
  SimplifyCommand& command = parsed->command;
  add_mesh_files(app, command, "Mesh");
  add_count(app, "--faces", command.options.face_budget, {},
            "Stop at N faces (or one below, where parity demands);\n0: as few as the tolerances allow [0]");
  add_tolerances(app, command.options, parsed->tau);
  add_flag(app, "--one-way", parsed->one_way,
           "Bound the distance of the surface to the input only, not that of\n"
           "samples of the input to the surface; no edges are flipped");
  add_schedule(app, command.options);
  add_surface_settings(app, command, parsed->format);
  when_parsed(app, [parsed, &command, &chosen] {
    finish_surface(command, parsed->format);
    choose_tolerances(command.options, parsed->tau, parsed->one_way);
    chosen = command;
  });
}

void add_low_poly(CLI::App& app, std::optional<Command>& chosen) {
  struct Parsed {
    LowPolyCommand command;
    std::optional<MeshFormat> format;
  };
  const auto parsed = std::make_shared<Parsed>();
  LowPolyCommand& command = parsed->command;
  add_mesh_files(app, command, "Mesh");
  add_count(app, "--faces", command.options.faces, {1},
            "Faces of the mesh (required), or one below, where parity demands")
      .required();
  add_parsed(app, "--quality", command.options.quality, &parse_quality, "fast|default|best",
             "How finely the tolerances grow [default]");
  add_ratio(app, "--inner-share", command.options.inner_share, 1,
            "The tolerance inside of the input over that outside of it, at most 1 [1/2]");
  add_flag(app, "--no-wrap", command.no_wrap,
           "Equal tolerances on both sides; hollows are not filled up to an\n"
           "alpha wrap of the input");
  add_surface_settings(app, command, parsed->format);
  when_parsed(app, [parsed, &command, &chosen] {
    finish_surface(command, parsed->format);
    chosen = command;
  });
}

}  // namespace prcage
