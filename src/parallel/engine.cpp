#include "parallel/engine.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/schedule.h"
#include "parallel/commit.h"
#include "parallel/conflicts.h"
#include "parallel/flips.h"
#include "parallel/stopwatch.h"

namespace prcage {
namespace {

// Voxels of the distance band per tau.
constexpr double voxels_per_tau = 2;
// So that rounding in distances cannot carry a proved point beyond tau.
constexpr double below_one = 1 - 1e-12;
// Arrays are compacted and sorted below this share of live faces.
constexpr double compaction_share = 0.6;

// Rounded positions are off by up to half an ulp of a float in each coordinate; constraints keep clear of that.
double float_margin(const CornerTable& mesh) {
  double largest = 0;
  for (const Position& p : mesh.position)
    for (const double x : p) largest = std::max(largest, std::abs(x));
  return 2 * largest * static_cast<double>(std::numeric_limits<float>::epsilon());
}

class Engine {
 public:
  Engine(CageState& state, const EngineContext& context) : state_(state), context_(context) {
    const Options& options = *context.options;
    settings_.min_scale = 1e-12 * context.diagonal;
    settings_.cost_scale = 1 / (context.diagonal * context.diagonal);
    settings_.float_positions = options.precision == Precision::float32;
    if (settings_.float_positions) settings_.absolute_margin = float_margin(state.mesh);
    if (options.tau_mode == TauMode::strict) limits_.reach = context.tau * below_one;
    context.band->set_voxel_size(context.tau / voxels_per_tau);
  }

  EngineOutcome run() {
    const std::vector<double> schedule = schedule_of(*context_.options);
    for (std::size_t k = 0; k < schedule.size(); ++k) {
      if (budget_reached()) return EngineOutcome::budget_reached;
      if (cancelled()) return EngineOutcome::cancelled;
      if (k == 0) timed(context_.statistics->seconds.commit, [&] { sort_along_curve(state_); });
      run_cycle(k, schedule.size(), schedule[k]);
    }
    if (cancelled()) return EngineOutcome::cancelled;
    return budget_reached() ? EngineOutcome::budget_reached : EngineOutcome::schedule_finished;
  }

 private:
  bool cancelled() const { return context_.control != nullptr && context_.control->cancelled(); }

  // A collapse removes two faces, so one below the budget is as near as parity allows.
  bool budget_reached() const {
    const std::size_t budget = context_.options->face_budget;
    return budget != 0 && state_.live_faces <= budget;
  }

  void report(Control::Stage stage, double part) {
    if (context_.control == nullptr) return;
    const double done = (static_cast<double>(cycle_) + part) / static_cast<double>(cycles_);
    context_.control->report(stage, static_cast<int>(cycle_) + 1, state_.live_faces, 0.05 + 0.9 * done);
  }

  void run_cycle(std::size_t k, std::size_t cycles, double beta) {
    cycle_ = k;
    cycles_ = cycles;
    CycleStatistics cycle;
    cycle.beta = beta;
    cycle.tau = beta * context_.tau;
    {
      const Stopwatch watch(cycle.seconds);
      limits_.centroids = settings_.band.tau = cycle.tau * below_one;
      forget_costs(state_);
      report(Control::Stage::collapse, 0);
      while (!cancelled() && !budget_reached() && run_round(cycle)) {
        ++cycle.rounds;
        report(Control::Stage::collapse, 1 - 1 / (1 + 0.1 * static_cast<double>(cycle.rounds)));
      }
      if (context_.options->flips && !cancelled()) run_flips(cycle);
    }
    cycle.faces = state_.live_faces;
    context_.statistics->counts += cycle.counts;
    context_.statistics->cycles.push_back(cycle);
  }

  void sort_if_sparse() {
    const double slots = static_cast<double>(state_.mesh.face_slots());
    if (static_cast<double>(state_.live_faces) < compaction_share * slots) sort_along_curve(state_);
  }

  // False if there was nothing left to try.
  bool run_round(CycleStatistics& cycle) {
    StageSeconds& seconds = context_.statistics->seconds;
    timed(seconds.commit, [&] { sort_if_sparse(); });
    timed(seconds.evaluate, [&] { evaluate_dirty_edges(state_, settings_, cycle.counts); });
    std::vector<Candidate> selected;
    timed(seconds.select, [&] { selected = select_independent_collapses(state_, context_.options->seed); });
    if (selected.empty()) return false;
    PlacedCollapses placed;
    timed(seconds.evaluate, [&] { placed = place_collapses(state_, settings_, selected); });
    limit_to_budget(placed);
    PatchBatch batch;
    timed(seconds.build, [&] {
      batch = build_collapses(state_, context_.frame, placed);
      test_patches_locally(state_, batch);
    });
    timed(seconds.distance, [&] { test_patches_against_band(state_, *context_.band, limits_, batch); });
    timed(seconds.collide, [&] {
      reject_hits_on_cage(state_, *context_.device, batch);
      reject_conflicts(state_, *context_.device, batch);
    });
    timed(seconds.commit, [&] { commit_collapses(state_, batch); });
    cycle.counts.selected += selected.size();
    cycle.counts.postponed += selected.size() - batch.size();
    count(batch, cycle.counts);
    return true;
  }

  void limit_to_budget(PlacedCollapses& placed) const {
    const std::size_t budget = context_.options->face_budget;
    if (budget != 0) keep_cheapest(placed, (state_.live_faces - budget + 1) / 2);
  }

  void run_flips(CycleStatistics& cycle) {
    report(Control::Stage::flip, 0.95);
    timed(context_.statistics->seconds.flip, [&] {
      const FlipSettings flips{limits_, context_.options->seed};
      flip_edges(state_, flips, context_.frame, *context_.device, *context_.band, context_.control, cycle.counts);
    });
  }

  static void count(const PatchBatch& batch, Counts& counts) {
    counts.collapses += batch.count(Verdict::accepted);
    counts.rejected_orientation += batch.count(Verdict::sweeps_inward);
    counts.rejected_degenerate += batch.count(Verdict::degenerate);
    counts.rejected_tau += batch.count(Verdict::beyond_tau);
    counts.rejected_cage += batch.count(Verdict::hits_cage);
    counts.rejected_conflict += batch.count(Verdict::conflict);
  }

  template <class F>
  static void timed(double& seconds, const F& f) {
    const Stopwatch watch(seconds);
    f();
  }

  CageState& state_;
  const EngineContext& context_;
  PlacementSettings settings_;
  BandLimits limits_;
  std::size_t cycle_ = 0;
  std::size_t cycles_ = 1;
};

}  // namespace

EngineOutcome run_engine(CageState& state, const EngineContext& context) { return Engine(state, context).run(); }

}  // namespace prcage
