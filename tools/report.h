// What the program tells people: plain text, whole lines, no colours. The functions only build the text; the
// commands decide where it goes.
#pragma once

#include <string>
#include <vector>

#include "core/prcage.h"
#include "tools/cli_files.h"
#include "tools/cli_options.h"
#include "tools/report_measures.h"
#include "tools/wrap/alpha_wrap.h"

namespace prcage {

// One sentence: is this a valid input, and if not, how many kinds of defects it has. Names the file.
std::string validation_headline(const InputMesh& input, const Validation& validation);

// The lines below it: each defect with its count, examples and remedy; or the counts of a valid mesh.
std::string validation_details(const InputMesh& input, const Validation& validation);

// One line: which mesh is looked at as the cage of which.
std::string pair_headline(const InputMesh& input, const InputMesh& cage);

// The last of the remedies: what can be done with an input that is not to be repaired.
std::string wrap_hint();

// Line by line what was proved and what was not. `of_wrap`: the topology is that of a wrap.
std::string certificate_text(const Certificate& certificate, bool of_wrap = false);

// What a cage is worth: the paper's conditions and measures. Those of `measures` must have been computed.
std::string evaluation_text(const InputMesh& input, const InputMesh& cage, const CageMeasures& measures);

// Summary of a run that has a cage. `wrap` is null if the input itself was caged.
std::string run_text(const CageCommand& command, const InputMesh& input, const Result& result, const Wrap* wrap,
                     double seconds);

// The same of a simplified surface.
std::string certificate_text(const SurfaceCertificate& certificate);
// `wrap` is null if there was none.
std::string surface_run_text(const MeshCommand& command, TauMode mode, const InputMesh& input,
                             const SimplifyResult& result, const Wrap* wrap, double seconds);

// The same of levels, of which the last may have no cage: a line for each.
std::string levels_text(const CageCommand& command, const InputMesh& input, const std::vector<Result>& levels,
                        const Wrap* wrap, double seconds);

std::string info_text(const InputMesh& input, const MeshMeasures& measures);

}  // namespace prcage
