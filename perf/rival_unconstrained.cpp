// Contender: prcage's own engine with the constraints off (paper, Fig. 22). The same rounds of independent collapses,
// link condition included, but vertices go to the minimum of the quadric and no exact test is asked: nothing bounds the
// distance to the input, faces may turn over, and the surface may meet itself. The time is that of the engine alone, on
// an input that has been validated.
#include <cstddef>
#include <stdexcept>

#include "core/corner_table.h"
#include "parallel/arena.h"
#include "parallel/engine.h"
#include "parallel/initial_cage.h"
#include "parallel/stopwatch.h"
#include "parallel/validate.h"
#include "perf/rival.h"

namespace prcage::perf {
namespace {

Attempt simplify_unconstrained(const Mesh& input, std::size_t faces) {
  const TreeDevice device;
  const CheckedMesh checked = validate_mesh(input, device);
  if (!checked.validation.valid()) throw std::runtime_error("the input is not a legal mesh");
  const SurfaceTree& tree = checked.valid.tree;
  const Mesh& surface = checked.valid.surface.mesh;

  Attempt attempt;
  const Stopwatch watch(attempt.seconds);
  CageState state;
  state.mesh = CornerTable::from_mesh(surface);
  describe_faces(surface, tree.frame(), state);
  Options options;
  options.face_budget = faces;
  options.flips = false;
  DistanceBand unused_band(tree);
  Statistics statistics;
  EngineContext context{};
  context.options = &options;
  context.diagonal = checked.validation.diagonal;
  context.thickness = {context.diagonal};
  context.frame = tree.frame();
  context.device = &device;
  context.band = &unused_band;
  context.statistics = &statistics;
  context.band_shape.sides = Sides::both;  // as in a simplification
  context.constrained = false;
  run_engine(state, context);
  attempt.cage = state.mesh.to_mesh();
  return attempt;
}

}  // namespace
}  // namespace prcage::perf

int main(int argc, char** argv) {
  using namespace prcage;
  return perf::rival_main(argc, argv, [](const Mesh& input, std::size_t faces) {
    perf::Search search;
    Arena(1).run([&] { search.kept = perf::simplify_unconstrained(input, faces); });
    search.seconds = search.kept.seconds;
    return search;
  });
}
