// What the stages of the engine work on, set up for one built-in shape as make_cage() sets it up, and brought to any
// point of a run by the engine itself.
#pragma once

#include <cstddef>
#include <string>
#include <type_traits>

#include "core/placement.h"
#include "parallel/arena.h"
#include "parallel/cage_state.h"
#include "parallel/candidates.h"
#include "parallel/distance_band.h"
#include "parallel/initial_cage.h"
#include "parallel/patches.h"

namespace prcage::perf {

// Runs f in an arena of its own, as every parallel part of the engine must, and returns what it returns.
template <class F>
auto in_arena(int threads, const F& f) {
  Arena arena(threads);
  if constexpr (std::is_void_v<decltype(f())>) {
    arena.run(f);
  } else {
    decltype(f()) result;
    arena.run([&] { result = f(); });
    return result;
  }
}

// To be made and used inside an arena; stays where it is.
class Workload {
 public:
  // C_0 of the shape. Throws std::runtime_error if there is no such shape or it cannot be displaced.
  Workload(const std::string& shape, std::size_t faces);
  Workload(const Workload&) = delete;
  Workload& operator=(const Workload&) = delete;

  // Runs the engine until the cage has at most `faces` faces or tau allows no fewer. `placement` is afterwards that of
  // the cycle that was reached. All vertices are dirty.
  void simplify_to(std::size_t faces);

  // Every edge is to be evaluated.
  void make_dirty();

  InitialCage displaced() const;

  Mesh input;
  TreeDevice device;
  SurfaceTree tree;
  double diagonal = 0;
  double tau = 0;  // of the last cycle
  DistanceBand band;
  CageState state;
  PlacementSettings placement;
  DisplacementSettings displacement;

 private:
  void enter_cycle(double cycle_tau);
};

// What the stages of one round hand to each other, up to the commit. The state of the workload is left evaluated.
struct Round {
  std::vector<Candidate> selected;
  PlacedCollapses placed;
  PatchBatch batch;  // built, not tested
};

Round begin_round(Workload& workload);

}  // namespace prcage::perf
