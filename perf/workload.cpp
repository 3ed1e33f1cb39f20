#include "perf/workload.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/schedule.h"
#include "core/surface.h"
#include "parallel/engine.h"
#include "tools/shapes.h"

namespace prcage::perf {
namespace {

Mesh shape_or_throw(const std::string& name, std::size_t faces) {
  std::string error;
  Mesh mesh = make_shape(name, faces, 0, error);
  if (!error.empty()) throw std::runtime_error(error);
  return mesh;
}

SurfaceTree tree_of(const Mesh& mesh, const TreeDevice& device) {
  SurfaceTree tree(device);
  tree.build(unit_frame(mesh.positions), mesh.positions, mesh.triangles);
  return tree;
}

}  // namespace

Workload::Workload(const std::string& shape, std::size_t faces)
    : input(shape_or_throw(shape, faces)),
      tree(tree_of(input, device)),
      diagonal(extent(input.positions).diagonal()),
      tau(Options{}.tau * diagonal),
      band(tree) {
  const double first_tau = thickness_steps(Options{}, diagonal, 0).front();
  displacement.step = Options{}.sigma * diagonal;
  displacement.longest_move = std::min(50 * displacement.step, 0.5 * first_tau);
  displacement.longest_radius = std::min(100 * displacement.step, 0.5 * first_tau);
  placement.min_scale = 1e-12 * diagonal;
  placement.cost_scale = 1 / (diagonal * diagonal);
  InitialCage first = displaced();
  if (!first.valid) throw std::runtime_error(shape + " cannot be displaced");
  state = std::move(first.state);
  enter_cycle(first_tau);
}

InitialCage Workload::displaced() const { return displace(input, tree, displacement, device); }

void Workload::simplify_to(std::size_t faces) {
  Options options;
  options.face_budget = faces;
  options.quality = Quality::fast;
  Statistics statistics;
  const std::vector<double> thickness = thickness_steps(options, diagonal, 0);
  run_engine(state,
             {&options, diagonal, thickness, tree.frame(), &device, &band, nullptr, nullptr, nullptr, &statistics});
  if (!statistics.cycles.empty()) enter_cycle(statistics.cycles.back().tau);
}

// As the engine begins a cycle.
void Workload::enter_cycle(double cycle_tau) {
  placement.band.outer = cycle_tau * (1 - 1e-12);
  band.set_voxel_size(cycle_tau / 2);
  sort_along_curve(state);
  make_dirty();
}

void Workload::make_dirty() { forget_costs(state); }

Round begin_round(Workload& workload) {
  Counts counts;
  evaluate_dirty_edges(workload.state, workload.placement, counts);
  Round round;
  round.selected = select_independent_collapses(workload.state, {});
  round.placed = place_collapses(workload.state, workload.placement, round.selected);
  round.batch = build_collapses(workload.state, workload.tree.frame(), round.placed);
  return round;
}

}  // namespace prcage::perf
