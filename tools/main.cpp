// The program prcage: parses the command line and runs the command.
#include <csignal>
#include <exception>
#include <new>

#include <fmt/core.h>

#include "tools/cli_commands.h"

namespace {

prcage::ExitCode run_command_line(int argc, char** argv) {
  const prcage::CommandLine line = prcage::parse_command_line(argc, argv);
  if (!line.command) return line.exit_code;
  return std::visit([](const auto& command) { return prcage::run(command); }, *line.command);
}

}  // namespace

int main(int argc, char** argv) {
  // A reader that goes away is a failed write with a message and an exit code, not a silent death.
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return static_cast<int>(run_command_line(argc, argv));
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "prcage: error: {}\n", prcage::out_of_memory_text);
  } catch (const std::exception& error) {
    fmt::print(stderr, "prcage: internal error: {}\n", error.what());
  }
  return static_cast<int>(prcage::ExitCode::internal_error);
}
