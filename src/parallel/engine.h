// The engine: from a first cage, cycles of the staircase schedule, each a loop of rounds of independent collapses
// followed by flips (DESIGN of the data flow: evaluate, select, build, collide, resolve, commit). Every cage of the run
// is valid, and encloses the one before unless vertices have been moved inward in between (tighten.h).
#pragma once

#include <vector>

#include "parallel/arena.h"
#include "parallel/cage_state.h"
#include "parallel/distance_band.h"
#include "parallel/side_test.h"
#include "parallel/tighten.h"
#include "parallel/wrap_room.h"

namespace prcage {

// The band in shares of the thickness.
struct BandShape {
  Sides sides = Sides::outer;
  double outer = 1;
  double inner = 1;  // if there are two sides
};

struct EngineContext {
  const Options* options;
  double diagonal;                // l
  std::vector<double> thickness;  // of each cycle, absolute
  UnitFrame frame;
  const TreeDevice* device;
  DistanceBand* band;
  const Obstacle* input;  // null: no tightening, and none of its components can be swept over
  Coverage* coverage;     // null: the distance of the input to the cage is not bounded
  Control* control;       // may be null
  Statistics* statistics;
  BandShape band_shape = {};
  const WrapRoom* room = nullptr;          // where a wrap bounds the surface
  const SideTest* side_test = nullptr;     // where the two sides differ and every point is to keep to its own
  std::size_t most_covered_faces = 20000;  // coverage begins when the cage has come down to so many faces
  int attempt = 0, attempts = 1;           // for the progress, where the closest of several cages is taken
  bool refits = false;                     // vertices move to where the input wants them
  double area = 0;                         // of the input, if so or if cages are polished
  bool estimates = false;                  // only how far the thickness would have to grow is wanted
  bool constrained = true;                 // false: collapses keep to the topology and to nothing else, to compare with
};

enum class EngineOutcome { schedule_finished, budget_reached, stopped };

// Runs inside an Arena. `state` holds a valid first cage with all vertices dirty.
EngineOutcome run_engine(CageState& state, const EngineContext& context);

}  // namespace prcage
