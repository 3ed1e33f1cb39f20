// Records the placement problems of real runs for the benchmark of the QP solver: runs of the engine on a few shapes
// are stopped at several sizes of the cage, and the problems of an even sample of its edges are written to a file.
#include <cstdio>
#include <exception>
#include <string>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "perf/qp_file.h"
#include "perf/workload.h"

namespace prcage::perf {
namespace {

struct Command {
  std::string output;
  std::vector<std::string> shapes{"bumpy", "bracket", "gyroid"};
  std::size_t faces = 20000;
  std::size_t sample = 2000;  // problems of each shape and size
};

// Every edge whose collapse the link condition allows, or an even sample of them.
std::vector<std::uint32_t> sampled_edges(const CornerTable& mesh, std::size_t sample) {
  std::vector<std::uint32_t> edges;
  for (std::uint32_t h = 0; h < mesh.corner_vertex.size(); ++h)
    if (represents_edge(mesh, h) && link_condition(mesh, h)) edges.push_back(h);
  if (edges.size() <= sample) return edges;
  std::vector<std::uint32_t> chosen;
  for (std::size_t i = 0; i < sample; ++i) chosen.push_back(edges[i * edges.size() / sample]);
  return chosen;
}

// The problem as solve_placements() hands it to the solver: scaled to unit trace, with the Tikhonov term.
void add_problem(const PlacementBatch& batch, std::size_t i, double regularization, QpProblems& problems) {
  const Symmetric3& form = batch.form[i];
  if (!(form.trace() > 0)) return;
  const double weight = 1 / form.trace();
  const double ridge = regularization / 3;
  problems.add({form.xx * weight + ridge, form.xy * weight, form.xz * weight, form.yy * weight + ridge,
                form.yz * weight, form.zz * weight + ridge},
               batch.linear[i] * weight, {&batch.rows[batch.first_row[i]], batch.row_length[i]},
               3 * batch.frame[i].faces - 2);
}

void record(const Workload& workload, std::size_t sample, QpProblems& problems) {
  PlacementBatch batch;
  for (const std::uint32_t h : sampled_edges(workload.state.mesh, sample))
    gather_placement(workload.state.mesh, workload.state.face_distance, h, workload.placement, batch);
  solve_placements(workload.placement, batch);
  for (std::size_t i = 0; i < batch.size(); ++i) add_problem(batch, i, workload.placement.regularization, problems);
}

void run(const Command& command) {
  QpProblems problems;
  for (const std::string& shape : command.shapes) {
    in_arena(0, [&] {
      Workload workload(shape, command.faces);
      record(workload, command.sample, problems);
      for (const std::size_t share : {2u, 4u, 10u, 25u}) {
        workload.simplify_to(workload.input.triangles.size() / share);
        record(workload, command.sample, problems);
      }
    });
  }
  write_qps(command.output, problems);
  fmt::print("{}: {} problems, {:.1f} planes on average\n", command.output, problems.size(),
             static_cast<double>(problems.all_planes()) / static_cast<double>(problems.size()));
}

}  // namespace
}  // namespace prcage::perf

int main(int argc, char** argv) {
  prcage::perf::Command command;
  CLI::App app("Records placement problems of real runs for the benchmark of the QP solver.");
  app.option_defaults()->always_capture_default();
  app.add_option("-o,--output", command.output, "File to write")->required();
  app.add_option("--shapes", command.shapes, "Built-in shapes, see prcage make --list")->delimiter(',');
  app.add_option("--faces", command.faces, "Faces of each shape");
  app.add_option("--sample", command.sample, "Most problems to take from one cage");
  CLI11_PARSE(app, argc, argv);
  try {
    prcage::perf::run(command);
  } catch (const std::exception& error) {
    fmt::print(stderr, "prcage_record_qps: {}\n", error.what());
    return 1;
  }
  return 0;
}
