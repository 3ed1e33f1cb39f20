// prcage bind: the weights that bind a mesh to a cage.
#include <fmt/core.h>

#include "io/weights_file.h"
#include "tools/cli_commands.h"
#include "tools/cli_files.h"

namespace prcage {
namespace {

void print_summary(const BindCommand& command, const CageWeights& weights, double seconds) {
  fmt::print(stderr, "{} -> {}: {} vertices, {} of {} weights each\n", input_name(command.input),
             output_name(command.output), weights.vertices, weights.keep, weights.cage_vertices);
  fmt::print(stderr, "  time           {:.2f} s\n", seconds);
  if (!weights.dense()) {
    fmt::print(stderr, "  left out       at most {:.3g} of a vertex's weights, mean {:.3g}\n", weights.largest_loss,
               weights.mean_loss);
  }
  fmt::print(stderr, "  error at rest  at most {:.3g} of the diagonal, mean {:.3g}\n", weights.largest_rest_error,
             weights.mean_rest_error);
}

}  // namespace

ExitCode run(const BindCommand& command) {
  if (!writable(command.output)) return ExitCode::cannot_write;
  const InputMesh input = read_input(command.input, false);
  if (!input.file.ok) return ExitCode::cannot_read;
  const InputMesh cage = read_input(command.cage, false);
  if (!cage.file.ok) return ExitCode::cannot_read;
  const Timer timer;
  const CageWeights weights = bind(input.file.mesh, cage.file.mesh, command.options);
  const double seconds = timer.seconds();
  if (weights.status != Status::ok) {
    print_error(fmt::format("{} to {}: {}", input_name(input.path), input_name(cage.path), weights.message));
    return ExitCode::invalid_mesh;
  }
  const WriteResult written = write_weights(command.output, weights);
  if (!written.ok) {
    print_error(written.error);
    return ExitCode::cannot_write;
  }
  if (!command.quiet) print_summary(command, weights, seconds);
  return ExitCode::ok;
}

}  // namespace prcage
