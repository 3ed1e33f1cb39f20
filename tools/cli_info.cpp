// prcage info: describes a mesh file, valid or not.
#include "tools/cli_commands.h"
#include "tools/cli_files.h"
#include "tools/report.h"
#include "tools/report_json.h"

namespace prcage {

ExitCode run(const InfoCommand& command) {
  const InputMesh input = read_input(command.file, false);
  if (!input.file.ok) return ExitCode::cannot_read;
  const MeshMeasures measures = measure(input.file.mesh);
  return write_text("-", command.json ? info_json(input, measures) : info_text(input, measures));
}

}  // namespace prcage
