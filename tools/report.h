// What the program tells people: plain text, whole lines, no colours. The functions only build the text; the
// commands decide where it goes.
#pragma once

#include <string>

#include "core/prcage.h"
#include "tools/cli_files.h"
#include "tools/cli_options.h"
#include "tools/report_measures.h"

namespace prcage {

// One sentence: is this a valid input, and if not, how many kinds of defects it has. Names the file.
std::string validation_headline(const InputMesh& input, const Validation& validation);

// The lines below it: each defect with its count, examples and remedy; or the counts of a valid mesh.
std::string validation_details(const InputMesh& input, const Validation& validation);

// One line: which mesh is looked at as the cage of which.
std::string pair_headline(const InputMesh& input, const InputMesh& cage);

// Line by line what was proved and what was not.
std::string certificate_text(const Certificate& certificate);

// What a cage is worth: the paper's conditions and measures. Those of `measures` must have been computed.
std::string evaluation_text(const InputMesh& input, const InputMesh& cage, const CageMeasures& measures);

// Summary of a run that has a cage.
std::string run_text(const CageCommand& command, const InputMesh& input, const Result& result, double seconds);

std::string info_text(const InputMesh& input, const MeshMeasures& measures);

}  // namespace prcage
