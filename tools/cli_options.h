// The command line, understood: one plain struct per command, filled and checked before anything is done.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/prcage.h"
#include "io/mesh_file.h"
#include "tools/batch_inputs.h"
#include "tools/exit_codes.h"
#include "tools/pose.h"
#include "tools/render.h"
#include "tools/wrap/alpha_wrap.h"

namespace prcage {

// What commands have in common that make a mesh of another one.
struct MeshCommand {
  std::string input;
  std::string output;
  MeshFormat format{};  // of the output
  std::string stats;    // file of the JSON statistics; empty: none
  bool weld = false;
  bool quiet = false;
};

struct CageCommand : MeshCommand {
  std::optional<WrapSettings> wrap;  // to cage an alpha wrap of the input
  std::string wrap_output;           // file of that wrap; empty: none
  MeshFormat wrap_format{};
  double deadline = 0;              // seconds from the start; 0: none
  std::vector<std::size_t> levels;  // faces of nested cages; empty: one cage
  Options options;
};

struct SimplifyCommand : MeshCommand {
  SimplifyOptions options;
};

struct LowPolyCommand : MeshCommand {
  LowPolyOptions options;
  bool no_wrap = false;  // symmetric tolerances, no wrap that hollows are filled up to
};

struct CheckCommand {
  std::string input;
  std::string cage;  // empty: validate the input only
  std::string wrap;  // empty: the cage is one of the input itself
  bool json = false;
  bool weld = false;
  int threads = 0;
};

struct EvalCommand {
  std::string input;
  std::string cage;
  std::string json;  // file of the JSON report; empty: none
  bool weld = false;
  MeasureOptions options;
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

struct BindCommand {
  std::string input;
  std::string cage;
  std::string output;
  bool quiet = false;
  BindOptions options;
};

struct PoseCommand {
  std::string input;
  std::string output;
  MeshFormat format{};
  PoseOptions options;
};

// Either the weights, or the input and its cage.
struct DeformCommand {
  std::string weights;
  std::string input;
  std::string cage;
  std::string deformed_cage;
  std::string output;
  MeshFormat format{};
  int threads = 0;
};

struct BatchCommand {
  std::string input;   // directory, or file with a list of meshes
  std::string output;  // directory of cages and table
  CageCommand cage;    // how each is made; without paths
  Shard shard;
  int jobs = 0;        // meshes at a time; 0: as suits the cores
  double timeout = 0;  // seconds of each process; 0: none
  std::uint64_t memory_limit_mb = 0;
  bool resume = false;
  bool retry_failed = false;
  bool no_eval = false;
  bool progress = false;  // a line for each mesh
  bool quiet = false;
};

struct MergeCommand {
  std::vector<std::string> tables;
  std::string output;
  bool mix_settings = false;
};

struct ReportCommand {
  std::string table;
  std::string output;
  std::string title;        // empty: the name of the table
  std::size_t models = 24;  // shown in 3D
};

struct RenderCommand {
  std::string input;
  std::string cage;  // empty: a picture of the input alone
  std::string output;
  bool distance = false;  // colour by distance; without options.distance_max up to the largest there is
  RenderOptions options;
};

using Command = std::variant<CageCommand, CheckCommand, EvalCommand, InfoCommand, MakeCommand, RenderCommand,
                             BindCommand, PoseCommand, DeformCommand, BatchCommand, MergeCommand, ReportCommand,
                             SimplifyCommand, LowPolyCommand>;

// Either a command to run, or none and the code to exit with: help, version or the usage error have been printed.
struct CommandLine {
  std::optional<Command> command;
  ExitCode exit_code = ExitCode::ok;
};

CommandLine parse_command_line(int argc, const char* const* argv);

}  // namespace prcage
