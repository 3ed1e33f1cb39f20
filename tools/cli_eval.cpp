// prcage eval: measures a cage as the paper does. The report is the data and goes to standard output.
#include <fmt/core.h>

#include "tools/cli_commands.h"
#include "tools/cli_files.h"
#include "tools/report.h"
#include "tools/report_json.h"

namespace prcage {
namespace {

// A report that cannot be printed is worse than what it says.
ExitCode write_reports(const EvalCommand& command, const InputMesh& input, const InputMesh& cage,
                       const CageMeasures& measures, double seconds) {
  if (!command.json.empty()) {
    const ExitCode written = write_text(command.json, evaluation_json(command, input, cage, measures, seconds));
    if (written != ExitCode::ok) return written;
  }
  if (command.json != "-") {
    const ExitCode printed = write_text("-", evaluation_text(input, cage, measures));
    if (printed != ExitCode::ok) return printed;
  }
  return measures.certificate.valid() ? ExitCode::ok : ExitCode::no_cage;
}

}  // namespace

ExitCode run(const EvalCommand& command) {
  if (!command.json.empty() && !writable(command.json)) return ExitCode::cannot_write;
  const InputMesh input = read_input(command.input, command.weld);
  if (!input.file.ok) return ExitCode::cannot_read;
  const InputMesh cage = read_input(command.cage, false);
  if (!cage.file.ok) return ExitCode::cannot_read;
  const Timer timer;
  const CageMeasures measures = measure_cage(input.file.mesh, cage.file.mesh, command.options);
  if (measures.status == Status::ok) return write_reports(command, input, cage, measures, timer.seconds());
  print_error(fmt::format("{} around {}: {}; `prcage check` of each says more", input_name(cage.path),
                          input_name(input.path), measures.message));
  return measures.status == Status::invalid_input ? ExitCode::invalid_mesh : ExitCode::usage;
}

}  // namespace prcage
