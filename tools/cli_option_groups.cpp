#include "tools/cli_option_groups.h"

#include <limits>

namespace prcage {
namespace {

void add_tau(CLI::App& app, Options& options) {
  const AddedOption tau = add_ratio(app, "--tau", options.tau, 1,
                                    "Thickness of the band around the input that the cage may use,\n"
                                    "relative to the diagonal of its bounding box, at most 1 [1/40]");
  const AddedOption absolute =
      add_ratio(app, "--tau-abs", options.tau_absolute, std::numeric_limits<double>::infinity(),
                "The same in the unit of the input, instead of --tau");
  tau.excludes(absolute);
  add_parsed(app, "--tau-mode", options.tau_mode, &parse_tau_mode, "strict|paper",
             "strict: every point of the cage is proved within tau [strict]\n"
             "paper: only the centroids of the faces are tested");
}

void add_schedule(CLI::App& app, Options& options) {
  const AddedOption cycles =
      add_count(app, "--cycles", options.cycles, {1, 10000}, "Uniform steps in which tau is released, 1 to 10000 [10]");
  add_parsed(app, "--schedule", options.schedule, &parse_schedule, "X1,X2,...",
             "The steps themselves, instead of --cycles: rising fractions of tau\n"
             "that end at 1, e.g. 1/8,1/4,1/2,1")
      .excludes(cycles);
}

Bound parse_bound(const std::string& text) {
  if (text == "cage") return Bound::cage;
  if (text == "both") return Bound::both;
  refuse("--bound", fmt::format("'{}' is neither cage nor both", text));
}

}  // namespace

AddedOption add_format(CLI::App& app, std::optional<MeshFormat>& format) {
  const auto parse = [&format](const std::string& name) {
    if (!parse_mesh_format(name, format.emplace())) refuse("--format", fmt::format("no such format '{}'", name));
  };
  return add_parsed(app, "--format", parse, "NAME",
                    "Format to write: ply, ply-ascii, obj, stl, stl-ascii, off\n"
                    "[by the extension of the output]");
}

AddedOption add_threads(CLI::App& app, int& threads) {
  return add_count(app, "--threads", threads, {0, 4096},
                   "Threads; 0: as many as the machine has [0];\nthe result does not depend on it");
}

AddedOption add_weld(CLI::App& app, bool& weld) {
  return add_flag(app, "--weld", weld, "Merge vertices of the input at equal positions (STL is always welded)");
}

AddedOption add_edge_flips(CLI::App& app, bool& flips) {
  return add_off_flag(app, "--no-edge-flips", flips,
                      "Leave out the edge flips that improve triangles between the cycles");
}

AddedOption add_mesh_output(CLI::App& app, std::string& path, const std::string& what) {
  return add_text(app, "-o,--output", path, "OUTPUT",
                  fmt::format("{} to write (required); - is standard output, needs --format", what));
}

void add_mesh_files(CLI::App& app, MeshCommand& command, const std::string& made) {
  add_argument(app, "INPUT", command.input, "Closed triangle mesh (PLY, OBJ, STL, OFF); - is standard input")
      .required();
  add_mesh_output(app, command.output, made).required();
}

void add_run_settings(CLI::App& app, MeshCommand& command, int& threads, std::optional<MeshFormat>& format) {
  add_threads(app, threads);
  add_text(app, "--stats", command.stats, "FILE",
           "JSON statistics to write, also when the run fails;\n- is standard output");
  add_format(app, format);
  add_flag(app, "--quiet", command.quiet, "No progress bar and no summary; errors are still printed");
}

AddedOption add_cage_settings(CLI::App& app, CageCommand& command) {
  Options& options = command.options;
  add_tau(app, options);
  add_schedule(app, options);
  const AddedOption faces = add_count(app, "--faces", options.face_budget, {},
                                      "Stop at N faces (or one below, where parity demands), without --tau at the\n"
                                      "smallest thickness that allows them; 0: as few as tau allows [0]");
  add_parsed(app, "--quality", options.quality, &parse_quality, "fast|default|best",
             "What tightness may cost: finer steps of the thickness, and how often\n"
             "vertices are moved back inward [default]");
  add_parsed(app, "--bound", options.bound, &parse_bound, "cage|both",
             "cage: tau bounds the distance of the cage to the input [with --tau]\n"
             "both: that of samples of the input to the cage, too [without --tau]");
  add_edge_flips(app, options.flips);
  add_ratio(app, "--sigma", options.sigma, 0.01,
            "First displacement off the input, relative to the diagonal,\nat most 0.01 [1e-5]");
  add_input_settings(app, command);
  return faces;
}

void find_thickness_if_free(const CLI::App& app, Options& options, bool levels) {
  for (const char* name : {"--tau", "--tau-abs", "--cycles", "--schedule"})
    if (given(app, name)) return;
  if (options.face_budget == 0 && !levels) return;
  options.tau = 0;
  if (!given(app, "--bound")) options.bound = Bound::both;
}

std::vector<double> parse_schedule(const std::string& text) {
  std::vector<double> schedule;
  bool rises = true;
  for (const std::string& step : split_at_commas(text)) {
    double beta = 0;
    rises = rises && parse_ratio(step, beta) && (schedule.empty() || beta > schedule.back());
    schedule.push_back(beta);
  }
  if (rises && schedule.back() == 1) return schedule;
  refuse("--schedule", fmt::format("'{}' is not a rising list of numbers above 0 that ends at 1", text));
}

TauMode parse_tau_mode(const std::string& text) {
  if (text == "strict") return TauMode::strict;
  if (text == "paper") return TauMode::paper;
  refuse("--tau-mode", fmt::format("'{}' is neither strict nor paper", text));
}

Quality parse_quality(const std::string& text) {
  for (const Quality quality : {Quality::fast, Quality::standard, Quality::best})
    if (text == to_string(quality)) return quality;
  refuse("--quality", fmt::format("'{}' is none of fast, default and best", text));
}

MeshFormat format_of_extension(const std::string& option, const std::string& path, const std::string& remedy) {
  MeshFormat format{};
  if (mesh_format_of_path(path, format)) return format;
  const std::string what = path == "-" ? std::string("standard output has no extension")
                                       : fmt::format("the extension of '{}' is none of .ply, .obj, .stl, .off", path);
  refuse(option, what + remedy);
}

MeshFormat output_format(const std::string& path, const std::optional<MeshFormat>& asked) {
  return asked ? *asked : format_of_extension("--output", path, ": say --format");
}

void refuse_stdin_twice(const std::string& input, const std::string& cage, const std::string& option) {
  if (input == "-" && cage == "-") refuse(option, "the mesh and the cage cannot both come from standard input");
}

void refuse_stdout_twice(const MeshCommand& command, const std::string& made) {
  if (command.output != "-" || command.stats != "-") return;
  refuse("--stats", fmt::format("the {} and the statistics cannot both go to standard output", made));
}

}  // namespace prcage
