// What the program tells other programs: JSON whose keys are the names of the members of the public interface. The
// schema number rises when a key is renamed or removed, not when one is added.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/prcage.h"
#include "tools/cli_files.h"
#include "tools/cli_options.h"
#include "tools/report_measures.h"
#include "tools/wrap/alpha_wrap.h"

namespace prcage {

// What is known of a run of `prcage cage` at its end, also of one that failed early.
struct RunRecord {
  std::string status;  // to_string(Status), or cannot_read, cannot_write
  std::string message;
  ExitCode exit_code = ExitCode::internal_error;
  bool cage_written = false;  // of levels: all of those that were asked for
  std::size_t levels_written = 0;
  double write_seconds = 0;
  double total_seconds = 0;
  std::optional<Wrap> wrap;  // tried
};

// `input` may be null, `results` empty: then nothing is known of them. Several results are levels.
std::string run_json(const CageCommand& command, const InputMesh* input, const std::vector<Result>& results,
                     const RunRecord& record);

// The same of runs of `prcage simplify` and `prcage lowpoly`; the "cage" of the statistics is the mesh made.
std::string surface_run_json(const SimplifyCommand& command, const InputMesh* input, const SimplifyResult* result,
                             const RunRecord& record);
std::string surface_run_json(const LowPolyCommand& command, const InputMesh* input, const SimplifyResult* result,
                             const RunRecord& record);

std::string validation_json(const InputMesh& input, const Validation& validation);
std::string certificate_json(const InputMesh& input, const InputMesh& cage, const Certificate& certificate);
std::string evaluation_json(const EvalCommand& command, const InputMesh& input, const InputMesh& cage,
                            const CageMeasures& measures, double seconds);
std::string info_json(const InputMesh& input, const MeshMeasures& measures);

}  // namespace prcage
