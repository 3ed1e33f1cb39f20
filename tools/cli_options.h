// The command line, understood: one plain struct per command, filled and checked before anything is done.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "core/prcage.h"
#include "io/mesh_file.h"
#include "tools/exit_codes.h"
#include "tools/render.h"

namespace prcage {

struct CageCommand {
  std::string input;
  std::string output;
  MeshFormat format{};  // of the output
  std::string stats;    // file of the JSON statistics; empty: none
  bool weld = false;
  bool quiet = false;
  Options options;
};

struct CheckCommand {
  std::string input;
  std::string cage;  // empty: validate the input only
  bool json = false;
  bool weld = false;
  int threads = 0;
};

struct InfoCommand {
  std::string file;
  bool json = false;
};

struct MakeCommand {
  bool list = false;
  std::string shape;
  std::size_t faces = 0;
  std::uint64_t seed = 0;
  std::string output;
  MeshFormat format{};
};

struct RenderCommand {
  std::string input;
  std::string cage;  // empty: a picture of the input alone
  std::string output;
  RenderOptions options;
};

using Command = std::variant<CageCommand, CheckCommand, InfoCommand, MakeCommand, RenderCommand>;

// Either a command to run, or none and the code to exit with: help, version or the usage error have been printed.
struct CommandLine {
  std::optional<Command> command;
  ExitCode exit_code = ExitCode::ok;
};

CommandLine parse_command_line(int argc, const char* const* argv);

// Positive finite number: a decimal ("0.025", "2.5e-2") or a fraction ("1/40"), the nearest double to it. False if
// `text` is anything else.
bool parse_ratio(const std::string& text, double& value);

}  // namespace prcage
