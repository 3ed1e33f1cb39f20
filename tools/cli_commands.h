// What the commands do. Each prints its own errors on stderr and returns the code to exit with; std::bad_alloc and
// exceptions of libraries are for main() to catch.
#pragma once

#include "tools/cli_options.h"

namespace prcage {

ExitCode run(const CageCommand& command);
ExitCode run(const CheckCommand& command);
ExitCode run(const EvalCommand& command);
ExitCode run(const InfoCommand& command);
ExitCode run(const MakeCommand& command);
ExitCode run(const RenderCommand& command);
ExitCode run(const BindCommand& command);
ExitCode run(const PoseCommand& command);
ExitCode run(const DeformCommand& command);
ExitCode run(const BatchCommand& command);
ExitCode run(const MergeCommand& command);
ExitCode run(const ReportCommand& command);
ExitCode run(const SimplifyCommand& command);
ExitCode run(const LowPolyCommand& command);

// Of a run of the library that ended so.
ExitCode exit_code_of(Status status);

}  // namespace prcage
