#include "parallel/engine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/schedule.h"
#include "parallel/commit.h"
#include "parallel/conflicts.h"
#include "parallel/flips.h"
#include "parallel/refit.h"
#include "parallel/stopwatch.h"

namespace prcage {
namespace {

// Voxels of the distance band per tau.
constexpr double voxels_per_tau = 2;
// So that rounding in distances cannot carry a proved point beyond tau: of tau, and of l, which bounds the sizes of
// faces.
constexpr double tau_rounding = 1e-12;
constexpr double size_rounding = 1e-14;
// Of the thickness of the cycle: shorter moves inward are not worth their tests.
constexpr double shortest_move = 0.02;
// Where the thickness is found, tightening begins when the cage has come down to so many times its budget, since it
// lets smaller thicknesses do, but while it has more faces than these, which would take too long, only when it is close
// to the budget. A given thickness is used up first.
constexpr std::size_t earliest_tightening = 6;
constexpr std::size_t many_to_tighten = 6000;
// Passes of refitting in the end, and what moves are worth it, of the thickness of the cycle.
constexpr int last_refits = 10;
constexpr double shortest_refit = 0.005;
// Of placements that no plane holds: far less than in cages, since it would blunt edges and corners a little each time.
constexpr double regularization_between_sides = 1e-5;
// Surfaces with more faces than this are collapsed with less care, since the rest mends what that spoils.
constexpr std::size_t many_faces = 20000;
// BandLimits::near_enough of such surfaces, and of those with fewer faces, when exact distances cost little: what is
// refused at first for distances that are too large comes later.
constexpr double near_enough_of_many = 0.5;
constexpr double near_enough_of_few = 0.02;
// A plane of the star bounds how far a vertex is from the input, and far from its own face that bound is much too
// large. Where nothing more is possible within the thickness, it is this many times as large for the planes, and only
// the proof that the new faces are within the thickness itself counts.
constexpr double loose_planes = 2;
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
  Engine(CageState& state, const EngineContext& context)
      : state_(state), context_(context), first_faces_(state.live_faces) {
    const Options& options = *context.options;
    settings_.min_scale = 1e-12 * context.diagonal;
    settings_.cost_scale = 1 / (context.diagonal * context.diagonal);
    settings_.float_positions = options.precision == Precision::float32;
    if (settings_.float_positions) settings_.absolute_margin = float_margin(state.mesh);
    if (context.band_shape.sides == Sides::both) settings_.regularization = regularization_between_sides;
    settings_.constrained = context.constrained;
  }

  EngineOutcome run() {
    const std::vector<double>& thickness = context_.thickness;
    for (std::size_t k = 0; k < thickness.size(); ++k) {
      if (budget_reached() || stopped()) break;
      if (k == 0) timed(context_.statistics->seconds.commit, [&] { sort_along_curve(state_); });
      std::optional<Snapshot> before;
      if (k > 0 && near_the_budget() && !context_.estimates) before = snapshot();
      run_cycle(k);
      if (before && budget_reached() && !stopped()) divide_last_step(k, *before);
    }
    polish();
    if (budget_reached()) return EngineOutcome::budget_reached;
    return stopped() ? EngineOutcome::stopped : EngineOutcome::schedule_finished;
  }

 private:
  // What a cycle changes.
  struct Snapshot {
    CageState state;
    std::optional<Coverage> coverage;
    Statistics statistics;
  };
  Snapshot snapshot() const {
    Snapshot now{state_, {}, *context_.statistics};
    if (context_.coverage != nullptr) now.coverage = *context_.coverage;
    return now;
  }
  void restore(const Snapshot& then) {
    state_ = then.state;
    if (context_.coverage != nullptr) *context_.coverage = *then.coverage;
    const StageSeconds spent = context_.statistics->seconds;
    *context_.statistics = then.statistics;
    context_.statistics->seconds = spent;
  }

  // The budget was reached in cycle k: with less than all of its growth of the thickness, perhaps?
  void divide_last_step(std::size_t k, const Snapshot& before) {
    const Snapshot reached = snapshot();
    restore(before);
    const double from = context_.thickness[k - 1], growth = context_.thickness[k] / from;
    const int parts = last_step_parts(*context_.options);
    for (int part = 1; part < parts && !stopped(); ++part) {
      run_cycle(k, from * std::pow(growth, static_cast<double>(part) / parts));
      if (budget_reached() && !stopped()) return;
    }
    restore(reached);
  }

  bool near_the_budget() const {
    if (!finds_thickness(*context_.options)) return false;
    const std::size_t budget = context_.options->face_budget;
    return state_.live_faces <= std::max(std::min(earliest_tightening * budget, many_to_tighten), budget + budget / 2);
  }

  bool stopped() const { return context_.control != nullptr && context_.control->stopped(); }

  // A collapse removes two faces, so one below the budget is as near as parity allows.
  bool budget_reached() const {
    const std::size_t budget = context_.options->face_budget;
    return budget != 0 && state_.live_faces <= budget;
  }

  // Do no collapses come after those of this cycle?
  bool last_of_all() const { return cycle_ + 1 == context_.thickness.size() || budget_reached(); }

  void report(Control::Stage stage, double part) {
    if (context_.control == nullptr) return;
    if (context_.estimates) stage = Control::Stage::estimate;
    const double of_attempt = (static_cast<double>(cycle_) + part) / static_cast<double>(context_.thickness.size());
    const double done = (context_.attempt + of_attempt) / context_.attempts;
    context_.control->report(stage, static_cast<int>(cycle_) + 1, state_.live_faces, 0.05 + 0.9 * done);
  }

  void run_cycle(std::size_t k) { run_cycle(k, context_.thickness[k]); }

  void run_cycle(std::size_t k, double tau) {
    cycle_ = k;
    CycleStatistics cycle;
    cycle.tau = tau;
    {
      const Stopwatch watch(cycle.seconds);
      set_limits(cycle.tau);
      if (renews_coverage() || coverage() == nullptr) start_coverage();
      forget_costs(state_);
      set_order();
      report(Control::Stage::collapse, 0);
      run_rounds(cycle);
      if (proves_all() && (near_the_budget() || k + 1 == context_.thickness.size())) {
        settings_.band.outer *= loose_planes;
        forget_costs(state_);
        run_rounds(cycle);
      }
      if (context_.options->flips && !stopped()) run_flips(cycle);
      if (!stopped()) run_tightening(cycle);
      if (!stopped()) run_refitting(cycle);
    }
    cycle.faces = state_.live_faces;
    context_.statistics->counts += cycle.counts;
    context_.statistics->cycles.push_back(cycle);
  }

  void run_rounds(CycleStatistics& cycle) {
    while (!stopped() && !budget_reached() && run_round(cycle)) {
      ++cycle.rounds;
      report(Control::Stage::collapse, 1 - 1 / (1 + 0.1 * static_cast<double>(cycle.rounds)));
    }
  }

  // Is every point of a cage proved to be within the thickness, whatever the planes say?
  bool proves_all() const {
    return context_.constrained && limits_.sides == Sides::outer && context_.options->tau_mode == TauMode::strict;
  }

  // What is proved of every point is the thickness of the run, if it is known, else that of the cycle.
  void set_limits(double tau) {
    const double proved = finds_thickness(*context_.options) ? tau : context_.thickness.back();
    const BandShape& shape = context_.band_shape;
    const auto clear = [&](double t) { return t - (tau_rounding * t + size_rounding * context_.diagonal); };
    limits_.centroids = clear(tau);
    limits_.near_enough = state_.live_faces > many_faces ? near_enough_of_many : near_enough_of_few;
    settings_.band = {shape.outer * limits_.centroids, shape.inner * limits_.centroids, shape.sides};
    limits_.sides = shape.sides;
    if (context_.options->tau_mode == TauMode::strict) {
      limits_.reach = clear(proved);
      limits_.outer = shape.outer * limits_.reach;
      limits_.inner = shape.inner * limits_.reach;
    }
    context_.band->set_voxel_size(proved / voxels_per_tau);
  }

  // Few faces can afford the rounds that the exact order takes. All edges must be selected anew.
  void set_order() { order_ = {context_.options->seed, state_.live_faces > many_faces}; }

  // While most of the collapses are still to come, the order of those at hand matters little.
  bool estimates_costs() const {
    return state_.live_faces > std::max(many_faces, first_faces_ / 8) &&
           state_.live_faces / 16 > context_.options->face_budget;
  }

  void sort_if_sparse() {
    const double slots = static_cast<double>(state_.mesh.face_slots());
    if (static_cast<double>(state_.live_faces) >= compaction_share * slots) return;
    set_order();
    const std::vector<std::uint32_t> old_faces = sort_along_curve(state_);
    if (renews_coverage())
      start_coverage();
    else if (coverage() != nullptr)
      coverage()->renumber(old_faces);
  }

  // Samples are followed once few enough faces are left for that to be cheap.
  Coverage* coverage() const {
    return context_.coverage != nullptr && context_.coverage->assigned() ? context_.coverage : nullptr;
  }

  // Cages are few in faces when they begin to carry samples, which can afford to look for their nearest faces anew.
  bool renews_coverage() const { return context_.band_shape.sides == Sides::outer; }

  // A patch that moves outward can take in a whole component other than its own.
  bool many_components() const { return context_.input != nullptr && context_.input->components() > 1; }

  void start_coverage() {
    if (context_.coverage == nullptr || state_.live_faces > context_.most_covered_faces) return;
    timed(context_.statistics->seconds.distance,
          [&] { context_.coverage->assign(state_, context_.frame, *context_.device); });
  }

  // False if there was nothing left to try.
  bool run_round(CycleStatistics& cycle) {
    StageSeconds& seconds = context_.statistics->seconds;
    timed(seconds.commit, [&] { sort_if_sparse(); });
    timed(seconds.evaluate, [&] { evaluate_dirty_edges(state_, settings_, cycle.counts); });
    std::vector<Candidate> selected;
    timed(seconds.select, [&] { selected = select_independent_collapses(state_, order_); });
    if (selected.empty()) return false;
    PlacedCollapses placed;
    timed(seconds.evaluate, [&] { placed = place_collapses(state_, settings_, selected); });
    limit_to_budget(placed);
    PatchBatch batch;
    timed(seconds.build, [&] { batch = build_collapses(state_, context_.frame, placed); });
    if (context_.constrained) test_collapses(batch);
    timed(seconds.commit, [&] {
      commit_collapses(state_, batch, estimates_costs() ? NewCosts::estimated : NewCosts::evaluated);
      if (context_.room != nullptr) context_.room->measure(batch, state_);
      if (coverage() != nullptr) coverage()->commit(batch);
    });
    cycle.counts.selected += selected.size();
    cycle.counts.postponed += selected.size() - batch.size();
    count(batch, cycle.counts);
    return true;
  }

  void test_collapses(PatchBatch& batch) {
    StageSeconds& seconds = context_.statistics->seconds;
    timed(seconds.build, [&] { test_patches_locally(state_, batch, limits_.sides); });
    timed(seconds.distance, [&] { test_patches_against_band(state_, *context_.band, limits_, batch); });
    timed(seconds.collide, [&] {
      if (many_components()) context_.input->reject_sweeps(state_, batch);
      reject_collisions(state_, *context_.device, limits_.sides, batch);
    });
    timed(seconds.distance, [&] {
      if (coverage() != nullptr) coverage()->test(state_, limits_.centroids, batch);
      if (context_.side_test != nullptr) context_.side_test->reject_wrong_sides(state_, limits_, batch);
    });
  }

  void limit_to_budget(PlacedCollapses& placed) const {
    const std::size_t budget = context_.options->face_budget;
    if (budget != 0) keep_cheapest(placed, (state_.live_faces - budget + 1) / 2);
  }

  void run_flips(CycleStatistics& cycle) {
    report(Control::Stage::flip, 0.95);
    timed(context_.statistics->seconds.flip, [&] {
      FlipSettings flips{limits_, context_.options->seed, coverage(), many_components() ? context_.input : nullptr,
                         context_.side_test};
      flips.room = context_.room;
      flip_edges(state_, flips, context_.frame, *context_.device, *context_.band, context_.control, cycle.counts);
    });
  }

  void run_tightening(CycleStatistics& cycle) {
    TightenSettings tightening;
    tightening.passes = tightening_passes(*context_.options);
    if (tightening.passes > 0 && (last_of_all() || near_the_budget())) tighten_cage(tightening, cycle);
  }

  // Once there is nothing left to collapse.
  void polish() {
    std::vector<CycleStatistics>& cycles = context_.statistics->cycles;
    TightenSettings tightening;
    tightening.fitting_passes = fitting_passes(*context_.options);
    if (tightening.fitting_passes == 0 || cycles.empty() || context_.estimates || stopped()) return;
    // Where topology wants a large thickness, the cage is to fit as if it did not.
    tightening.misfit_unit = std::min(limits_.centroids, usual_thickness(context_.area, state_.live_faces));
    const Stopwatch watch(cycles.back().seconds);
    CycleStatistics polishing;
    tighten_cage(tightening, polishing);
    cycles.back().counts += polishing.counts;
    context_.statistics->counts += polishing.counts;
  }

  void tighten_cage(TightenSettings& tightening, CycleStatistics& cycle) {
    if (context_.input == nullptr) return;
    tightening.limits = limits_;
    tightening.flips = context_.options->flips;
    tightening.shortest = shortest_move * limits_.centroids;
    tightening.float_positions = settings_.float_positions;
    tightening.seed = context_.options->seed;
    tightening.coverage = coverage();
    if (coverage() != nullptr) tightening.sample_area = sample_area();
    report(Control::Stage::tighten, 0.97);
    timed(context_.statistics->seconds.tighten, [&] {
      tighten(state_, tightening, *context_.input, context_.frame, *context_.device, *context_.band, context_.control,
              cycle.counts);
    });
  }

  double sample_area() const { return context_.area / static_cast<double>(coverage()->size()); }

  void run_refitting(CycleStatistics& cycle) {
    if (!context_.refits || coverage() == nullptr || !(last_of_all() || near_the_budget())) return;
    RefitSettings refitting;
    refitting.limits = limits_;
    refitting.passes = last_of_all() ? last_refits : 1;
    refitting.sample_area = sample_area();
    refitting.shortest = shortest_refit * limits_.centroids;
    refitting.float_positions = settings_.float_positions;
    refitting.seed = context_.options->seed;
    refitting.coverage = coverage();
    refitting.side_test = context_.side_test;
    report(Control::Stage::tighten, 0.97);
    timed(context_.statistics->seconds.tighten, [&] {
      cycle.counts.tightened +=
          refit(state_, refitting, context_.frame, *context_.device, *context_.band, context_.control);
    });
    if (context_.room != nullptr) context_.room->measure(state_);
  }

  static void count(const PatchBatch& batch, Counts& counts) {
    counts.collapses += batch.count(Verdict::accepted);
    counts.rejected_orientation += batch.count(Verdict::sweeps_inward) + batch.count(Verdict::turns_over);
    counts.rejected_degenerate += batch.count(Verdict::degenerate);
    counts.rejected_tau +=
        batch.count(Verdict::beyond_tau) + batch.count(Verdict::wrong_side) + batch.count(Verdict::uncovers_input);
    counts.rejected_cage += batch.count(Verdict::hits_cage) + batch.count(Verdict::hits_input);
    counts.rejected_conflict += batch.count(Verdict::conflict);
  }

  template <class F>
  static void timed(double& seconds, const F& f) {
    const Stopwatch watch(seconds);
    f();
  }

  CageState& state_;
  const EngineContext& context_;
  std::size_t first_faces_;
  PlacementSettings settings_;
  BandLimits limits_;
  CollapseOrder order_;
  std::size_t cycle_ = 0;
};

}  // namespace

EngineOutcome run_engine(CageState& state, const EngineContext& context) { return Engine(state, context).run(); }

}  // namespace prcage
