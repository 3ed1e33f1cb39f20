// What each command takes on the command line. The ranges are those of the library, refused here before a large file
// is read.
#pragma once

#include <optional>

#include "tools/cli_options.h"

namespace CLI {
class App;
}

namespace prcage {

// Each gives its options to `app`. If that is the command that is named, `chosen` holds it once it has been parsed.
void add_cage(CLI::App& app, std::optional<Command>& chosen);
void add_check(CLI::App& app, std::optional<Command>& chosen);
void add_eval(CLI::App& app, std::optional<Command>& chosen);
void add_info(CLI::App& app, std::optional<Command>& chosen);
void add_make(CLI::App& app, std::optional<Command>& chosen);
void add_render(CLI::App& app, std::optional<Command>& chosen);
void add_bind(CLI::App& app, std::optional<Command>& chosen);
void add_pose(CLI::App& app, std::optional<Command>& chosen);
void add_deform(CLI::App& app, std::optional<Command>& chosen);
void add_batch(CLI::App& app, std::optional<Command>& chosen);
void add_merge(CLI::App& app, std::optional<Command>& chosen);
void add_report(CLI::App& app, std::optional<Command>& chosen);
void add_simplify(CLI::App& app, std::optional<Command>& chosen);
void add_low_poly(CLI::App& app, std::optional<Command>& chosen);

}  // namespace prcage
