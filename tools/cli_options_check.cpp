// The options of prcage check, eval and info, which look at meshes and make none.
#include <limits>
#include <memory>
#include <optional>

#include "tools/cli_command_options.h"
#include "tools/cli_option_groups.h"

namespace prcage {

void add_check(CLI::App& app, std::optional<Command>& chosen) {
  const auto command = std::make_shared<CheckCommand>();
  add_argument(app, "INPUT", command->input, "Mesh to validate; - is standard input").required();
  const AddedOption cage =
      add_text(app, "--cage", command->cage, "FILE", "Certify this cage against INPUT instead; - is standard input");
  add_text(app, "--wrap", command->wrap, "FILE",
           "The wrap of INPUT that was caged: the cage must enclose every face of\n"
           "INPUT, whatever these form, and have the topology of the wrap")
      .needs(cage);
  add_flag(app, "--json", command->json, "Report as JSON");
  add_weld(app, command->weld);
  add_threads(app, command->threads);
  when_parsed(app, [command, &chosen] {
    refuse_stdin_twice(command->input, command->cage, "--cage");
    if (command->wrap == "-") refuse("--wrap", "the wrap cannot come from standard input");
    chosen = *command;
  });
}

void add_eval(CLI::App& app, std::optional<Command>& chosen) {
  const auto command = std::make_shared<EvalCommand>();
  MeasureOptions& options = command->options;
  add_argument(app, "INPUT", command->input, "Mesh that the cage is of; - is standard input").required();
  add_argument(app, "CAGE", command->cage, "Cage to measure; - is standard input").required();
  const AddedOption tau = add_ratio(app, "--tau", options.tau, 1,
                                    "Measure by how much the cage exceeds this thickness, too,\n"
                                    "relative to the diagonal of the input's bounding box, at most 1");
  add_ratio(app, "--tau-abs", options.tau_absolute, std::numeric_limits<double>::infinity(),
            "The same in the unit of the input, instead of --tau")
      .excludes(tau);
  add_count(app, "--samples", options.samples, {1, 1000000000}, "Points on each surface, 1 to 1000000000 [100000]");
  add_count(app, "--seed", options.seed, {}, "Varies the points [0]; the same seed gives the same result");
  add_count(app, "--views", options.views, {0, 1000}, "Views in which the silhouettes are compared, 0 to 1000 [24]");
  add_text(app, "--json", command->json, "FILE", "JSON report to write; - is standard output, instead of the table");
  add_weld(app, command->weld);
  add_threads(app, options.threads);
  when_parsed(app, [command, &chosen] {
    refuse_stdin_twice(command->input, command->cage, "CAGE");
    chosen = *command;
  });
}

void add_info(CLI::App& app, std::optional<Command>& chosen) {
  const auto command = std::make_shared<InfoCommand>();
  add_argument(app, "FILE", command->file, "Mesh file; - is standard input").required();
  add_flag(app, "--json", command->json, "Report as JSON");
  when_parsed(app, [command, &chosen] { chosen = *command; });
}

}  // namespace prcage
