// prcage check: validates a mesh as an input, or certifies a cage against a mesh. The report is the data and goes to
// standard output.
#include <fmt/core.h>

#include "tools/cli_commands.h"
#include "tools/cli_files.h"
#include "tools/report.h"
#include "tools/report_json.h"

namespace prcage {
namespace {

// A report that cannot be printed is worse than what it says.
ExitCode report(const std::string& text, ExitCode verdict) {
  const ExitCode printed = write_text("-", text);
  return printed == ExitCode::ok ? verdict : printed;
}

std::string validation_text(const InputMesh& input, const Validation& validation) {
  return fmt::format("{}\n{}", validation_headline(input, validation), validation_details(input, validation));
}

ExitCode check_input(const CheckCommand& command, const InputMesh& input) {
  const Validation validation = validate(input.file.mesh, command.threads);
  return report(command.json ? validation_json(input, validation) : validation_text(input, validation),
                validation.valid() ? ExitCode::ok : ExitCode::invalid_mesh);
}

// Where the trouble is, if one of the two meshes is not even valid by itself.
std::string defects_text(const InputMesh& input, int threads) {
  const Validation validation = validate(input.file.mesh, threads);
  return validation.valid() ? "" : validation_text(input, validation);
}

std::string pair_text(const CheckCommand& command, const InputMesh& input, const InputMesh& cage,
                      const Certificate& certificate) {
  const std::string text = pair_headline(input, cage) + certificate_text(certificate, !command.wrap.empty());
  if (certificate.valid()) return text;
  if (!command.wrap.empty()) return text + defects_text(cage, command.threads);
  return text + defects_text(cage, command.threads) + defects_text(input, command.threads);
}

ExitCode check_pair(const CheckCommand& command, const InputMesh& input) {
  const InputMesh cage = read_input(command.cage, false);
  if (!cage.file.ok) return ExitCode::cannot_read;
  Certificate certificate;
  if (command.wrap.empty()) {
    certificate = certify(input.file.mesh, cage.file.mesh, command.threads);
  } else {
    const InputMesh wrap = read_input(command.wrap, false);
    if (!wrap.file.ok) return ExitCode::cannot_read;
    certificate = certify_around(input.file.mesh, wrap.file.mesh, cage.file.mesh, command.threads);
  }
  return report(
      command.json ? certificate_json(input, cage, certificate) : pair_text(command, input, cage, certificate),
      certificate.valid() ? ExitCode::ok : ExitCode::no_cage);
}

}  // namespace

ExitCode run(const CheckCommand& command) {
  const InputMesh input = read_input(command.input, command.weld);
  if (!input.file.ok) return ExitCode::cannot_read;
  return command.cage.empty() ? check_input(command, input) : check_pair(command, input);
}

}  // namespace prcage
