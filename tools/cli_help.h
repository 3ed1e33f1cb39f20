// What people read of the command line itself: help texts and usage errors, in plain words instead of the parser's.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/exit_codes.h"

namespace CLI {
class App;
class Error;
}  // namespace CLI

namespace prcage {

// Gives the program or a command its help text. Each usage is what follows the name of the program and command.
void set_help(CLI::App& app, std::vector<std::string> usages, const std::string& footer);

// The table of some exit codes and their meanings.
std::string exit_codes_help(std::span<const ExitCode> codes);

// What is printed for --version: the licences depend on what is built in.
std::string version_text();

// Says that there is no command of this name, and which there are.
std::string unknown_command(const CLI::App& app, const std::string& name);

// All that is printed when the command line cannot be understood.
std::string usage_error(const CLI::App* app, const CLI::Error& error);

}  // namespace prcage
