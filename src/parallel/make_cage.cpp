// The pipeline behind make_cage(): validate, displace, run the engine, certify from scratch. Nested levels run all but
// the first of it again and again: what is displaced, and must not be touched, is then the level before, while
// thicknesses are those around the input.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>

#include "core/round_outward.h"
#include "core/schedule.h"
#include "parallel/certify.h"
#include "parallel/deviation.h"
#include "parallel/initial_cage.h"
#include "parallel/parallel_for.h"
#include "parallel/pipeline.h"
#include "parallel/run_safely.h"
#include "parallel/soup.h"

namespace prcage {
namespace {

// The longest first move in steps: vertices between nearly antiparallel faces would otherwise go very far.
constexpr double longest_move = 50;
// The radius at which singular vertices are cut off, in steps.
constexpr double longest_radius = 100;
// Samples of the input whose distance to the cage is bounded: vertices, and points of faces, which may be large.
constexpr std::size_t most_vertices = 40000;
constexpr std::size_t spread_points = 40000;
// Cages of which the closest is taken, with best quality, and samples for the distance.
constexpr int best_attempts = 3;
constexpr std::size_t hausdorff_samples = 20000;
// Of the first cycle's tau, for each of the two, so that C_0 lies within it.
constexpr double largest_share_of_tau = 0.5;
// By how much an estimate of the thickness that a face budget needs is raised: the way there went on in finer steps
// than a run takes.
constexpr double estimate_margin = 1.2;
// So often another level is made where the next one cannot be moved off it, and another step of the move is tried.
constexpr int most_attempts = 8;
constexpr double sigma_ratio = 4;
constexpr double narrowing = 0.04;  // of the thicknesses, with each attempt
constexpr double largest_sigma = 0.01;
constexpr int most_steps = 3;
constexpr double step_ratio = 32;
// Of the room between a level and the next, for each of the two; what is left is for rounding.
constexpr double largest_share_of_gap = 0.49;

// Where C_0 could not be freed of conflicts, for people.
std::string displacement_message(const char* what, const InitialCage& cage, const Mesh& surface) {
  const bool contact = cage.contacts.count > 0;
  const FacePairs& pairs = contact ? cage.contacts : cage.self_intersections;
  const auto face = pairs.pairs[0][contact ? 1 : 0];
  const Position& p =
      surface.positions[surface.triangles[std::min<std::size_t>(face, surface.triangles.size() - 1)][0]];
  std::ostringstream text;
  text << what
       << " cannot be moved off itself without a collision: " << cage.contacts.count + cage.self_intersections.count
       << " pairs of faces stay in conflict, e.g. near (" << p[0] << ", " << p[1] << ", " << p[2]
       << "); sheets may be too close to each other there for double precision, or a vertex too singular";
  return text.str();
}

// The smallest number of two digits that is not below x > 0.
double round_up(double x) {
  const double unit = std::pow(10, std::floor(std::log10(x)) - 1);
  return std::ceil(x / unit) * unit;
}

// The live faces, in the order that they have in the mesh of the cage: what is proved of the distance of their points
// to the input.
std::vector<float> live_reach(const CageState& state) {
  std::vector<float> reach;
  for (std::uint32_t f = 0; f < state.mesh.face_slots(); ++f)
    if (state.mesh.face_alive(f)) reach.push_back(state.face_reach[f]);
  return reach;
}

// The first cage of a level is made from the level before: its first faces are those of that level, whose `reach` is
// known, moved by up to `gap`; the others are caps. What the engine knows of faces are distances to the input. Large
// faces would be slow to prove near it, time and again.
void measure_to_input(CageState& state, const DistanceBand& band, const std::vector<float>& reach, double gap) {
  const float farthest = *std::max_element(reach.begin(), reach.end());
  const CornerTable& mesh = state.mesh;
  parallel_each(mesh.face_slots(), 64, [&](std::size_t f) {
    const auto corners = mesh.corners(static_cast<std::uint32_t>(f));
    const DistanceBand::Near near = band.nearest((corners[0] + corners[1] + corners[2]) / 3);
    state.face_near[f] = near.face;
    state.face_distance[f] = float_above(near.distance);
    const double inherited = (f < reach.size() ? reach[f] : farthest) + gap;
    const double measured = std::sqrt(band.distance_from(near.face).largest_squared(corners));
    state.face_reach[f] = float_above(std::min(inherited, measured));
  });
}

// A level that is made, and what the next one begins with.
struct LevelBefore {
  explicit LevelBefore(CheckedMesh mesh) : checked(std::move(mesh)) {}

  CheckedMesh checked;
  Result result;
  std::vector<float> reach;    // of each face: bounds the distance of its points to the input
  std::size_t first_step = 0;  // of the thicknesses, for the next level
  double gap = 0;              // how far the next level moves off at first, at most
  InitialCage next;            // its first cage
};

// What came of a run of the engine.
struct Attempt {
  CageState state;
  Statistics statistics;
  EngineOutcome outcome = EngineOutcome::schedule_finished;
  double distance = 0;  // from the input, if there is more than one attempt

  bool better_than(const Attempt& other, std::size_t face_budget) const {
    const std::size_t faces = std::max(state.live_faces, face_budget);
    const std::size_t other_faces = std::max(other.state.live_faces, face_budget);
    return faces != other_faces ? faces < other_faces : distance < other.distance;
  }
};

class Pipeline : PipelineBase<Result> {
 public:
  Pipeline(const MeshView& input, const Options& options, Control* control, Result& result)
      : PipelineBase(input, control, result), options_(options) {}

  // The input is a wrap of the triangles, which then are what is certified to be enclosed. False if there are none.
  bool take_triangles(const MeshView& triangles) {
    const Stopwatch watch(seconds().validate);
    Mesh faces;
    const std::string error = usable_faces(to_mesh(triangles), faces, result_.statistics.dropped);
    if (!error.empty()) {
      fail(Status::invalid_input, error);
      return false;
    }
    soup_ = std::make_unique<Soup>(make_soup(std::move(faces), device_));
    return true;
  }

  // False if no cage is to be made of the input.
  bool check_input() {
    validate_input(options_.accept_inside_out);
    describe_input();
    if (!checked_->validation.valid()) {
      fail(Status::invalid_input,
           std::string(soup_ ? "the wrap" : "the input") + " is not a legal mesh: see the defects");
      return false;
    }
    if (stopped() && !control_->cancelled()) {
      stop(" before there was a cage");
      return false;
    }
    return true;
  }

  void make() {
    InitialCage first = before_ ? before_->next : displaced_input();
    record(first);
    if (!first.valid) {
      fail(Status::displacement_failed,
           displacement_message(before_ ? "the level before" : "the input", first, inner().surface.mesh));
      return;
    }
    collapse(first.state);
    finish(first.state);
  }

  // Each level around the one before. All but the last result are moved to `levels`.
  void make_levels(const std::vector<std::size_t>& face_budgets, std::vector<Result>& levels) {
    const std::vector<double> steps = thickness_;
    for (std::size_t i = 0;; ++i) {
      set_level(i, face_budgets, steps);
      std::unique_ptr<LevelBefore> made = make_level(i + 1 == face_budgets.size(), steps, levels);
      if (!made) return;
      keep_level(std::move(made), levels);
      if (stopped()) return stop(" before the level was begun");
    }
  }

 private:
  // What the cage must enclose: the input, or the level before.
  const CheckedMesh& enclosed_mesh() const { return before_ ? before_->checked : *checked_; }
  const ValidSurface& inner() const { return enclosed_mesh().valid; }

  // Where the thickness is found, a level does not try smaller ones than a cage of its own.
  void pass_over_small_steps(const std::vector<double>& steps) {
    if (!finds_thickness(options_)) return;
    const double least = thickness_steps(options_, result_.statistics.diagonal, result_.validation.area).front();
    while (first_step_ + 1 < steps.size() && steps[first_step_] < least) ++first_step_;
  }

  void set_level(std::size_t i, const std::vector<std::size_t>& face_budgets, const std::vector<double>& steps) {
    options_.face_budget = face_budgets[i];
    share_ = level_share(i, face_budgets.size());
    pass_over_small_steps(steps);
    thickness_.clear();
    for (std::size_t k = first_step_; k < steps.size(); ++k) thickness_.push_back(share_ * steps[k]);
    result_.statistics.tau = thickness_.back();
    if (control_ != nullptr) control_->begin_level(static_cast<int>(i) + 1, static_cast<int>(face_budgets.size()));
  }

  // Makes a level, and the first cage around it. Where there is none, since sheets have come too close to each other or
  // vertices are too singular, a thinner band and a longer first step off the input lead to another level. Null if the
  // sequence ends here.
  std::unique_ptr<LevelBefore> make_level(bool last, const std::vector<double>& steps,
                                          const std::vector<Result>& levels) {
    const Options given = options_;
    const Result blank = result_;
    std::unique_ptr<LevelBefore> made;
    for (int attempt = 0; attempt < most_attempts && !(made && (made->next.valid || stopped())); ++attempt) {
      narrowed_ = 1 - narrowing * attempt;
      if (attempt > 0 && before_) move_off(*before_, std::pow(0.5, attempt));
      options_.sigma = std::min(given.sigma * std::pow(sigma_ratio, attempt), std::max(given.sigma, largest_sigma));
      result_ = blank;
      make();
      if (!levels.empty()) drop_if_useless(levels.back());
      const bool ends = last || !result_.has_cage() || outcome_ == EngineOutcome::stopped;
      if (ends && made) continue;
      if (ends) return nullptr;
      made = level_to_leave(steps);
    }
    options_ = given;
    narrowed_ = 1;
    return made;
  }

  // The present result as the level before, and the first cage around it, for which a share of the thickness is room.
  std::unique_ptr<LevelBefore> level_to_leave(const std::vector<double>& steps) {
    auto level = std::make_unique<LevelBefore>(validate_mesh(result_.cage, device_));
    level->result = result_;
    level->reach = reach_;
    const std::size_t cycles = result_.statistics.cycles.size();
    level->first_step = first_step_ + (cycles > 0 ? cycles - 1 : 0);
    level->gap = level_gap * steps[level->first_step];
    move_off(*level, 1);
    return level;
  }

  // The first cage around a level, within a share of the room that there is.
  void move_off(LevelBefore& level, double share) const {
    DisplacementSettings settings;
    settings.longest_move = settings.longest_radius = share * largest_share_of_gap * level.gap;
    // Many vertices of a level stay where they are put now.
    settings.float_positions = options_.precision == Precision::float32;
    settings.step = std::min(options_.sigma * result_.statistics.diagonal, settings.longest_move);
    const ValidSurface& surface = level.checked.valid;
    level.next.valid = false;
    for (int i = 0; i < most_steps && !level.next.valid && !stopped(); ++i) {
      level.next = displace(surface.surface.mesh, surface.tree, settings, device_);
      settings.step /= step_ratio;
    }
  }

  void keep_level(std::unique_ptr<LevelBefore> level, std::vector<Result>& levels) {
    before_ = std::move(level);
    first_step_ = before_->first_step;
    const Result& result = before_->result;
    Result next;
    next.validation = result.validation;
    const Statistics& s = result.statistics;
    Statistics& t = next.statistics;
    t.input_vertices = s.input_vertices;
    t.input_faces = s.input_faces;
    t.dropped = s.dropped;
    t.diagonal = s.diagonal;
    t.threads = s.threads;
    t.simd = s.simd;
    result_ = std::move(next);
    levels.push_back(std::move(before_->result));
    const auto now = std::chrono::steady_clock::now();
    levels.back().statistics.seconds.total = std::chrono::duration<double>(now - std::exchange(start_, now)).count();
    levels.back().statistics.peak_memory_bytes = peak_memory_bytes();
  }

  // A level that was stopped, or that its thickness does not allow, may not have come anywhere.
  void drop_if_useless(const Result& before) {
    if (result_.status == Status::ok || !result_.has_cage()) return;
    if (result_.cage.triangles.size() < before.cage.triangles.size()) return;
    result_.cage = {};
    result_.certificate = {};
    result_.around_previous.reset();
    result_.statistics.cage_vertices = result_.statistics.cage_faces = 0;
    if (outcome_ == EngineOutcome::stopped)
      stop(" before the level had fewer faces than the one before");
    else
      result_.message = "no fewer faces than the level before has are possible";
  }

  void describe_input() {
    Statistics& s = result_.statistics;
    thickness_ = thickness_steps(options_, s.diagonal, result_.validation.area);
    s.tau = thickness_.back();
  }

  InitialCage displaced_input() {
    report(Control::Stage::displace, valid().surface.mesh.triangles.size(), 0.03);
    const Stopwatch watch(seconds().displace);
    DisplacementSettings settings;
    settings.step = options_.sigma * result_.statistics.diagonal;
    const double share_of_tau = largest_share_of_tau * thickness_.front();
    settings.longest_move = std::min(longest_move * settings.step, share_of_tau);
    settings.longest_radius = std::min(longest_radius * settings.step, share_of_tau);
    return displace(valid().surface.mesh, valid().tree, settings, device_);
  }

  void record(const InitialCage& first) {
    Statistics& s = result_.statistics;
    s.singular_vertices = first.singular_vertices;
    s.capped_vertices = first.capped_vertices;
    s.halved_vertices = first.halved_vertices;
    if (first.step.empty()) return;
    const auto [low, high] = std::minmax_element(first.step.begin(), first.step.end());
    s.sigma_min = *low;
    s.sigma_max = *high;
  }

  void collapse(CageState& state) {
    DistanceBand band(valid().tree);
    Statistics& s = result_.statistics;
    const Obstacle obstacle(inner().tree, inner().components, device_);
    std::vector<double> thickness = thickness_;
    for (double& t : thickness) t *= narrowed_;
    EngineContext context{&options_, s.diagonal, thickness, inner().tree.frame(), &device_, &band, &obstacle,
                          nullptr,   control_,   &s};
    if (before_) measure_to_input(state, band, before_->reach, before_->gap + float_rounding(state.mesh));
    context.area = result_.validation.area;
    take_closest_attempt(state, context);
    // The first cage, of which something may be left, is within the first thickness.
    if (finds_thickness(options_))
      s.tau = s.cycles.empty() ? thickness_.front() : std::max(s.cycles.back().tau, thickness_.front());
    for (CycleStatistics& cycle : s.cycles) cycle.beta = cycle.tau / s.tau;
    if (outcome_ == EngineOutcome::schedule_finished && options_.face_budget != 0 && !finds_thickness(options_))
      estimate_needed_tau(state, context);
    reach_ = live_reach(state);
    s.band_voxels = band.voxels_filled();
  }

  // From the first cage; where quality is best, the closest of several that differ in their seeds.
  void take_closest_attempt(CageState& state, EngineContext context) {
    context.attempts = options_.quality == Quality::best ? best_attempts : 1;
    Statistics& s = result_.statistics;
    std::optional<Attempt> best;
    StageSeconds spent = s.seconds;
    bool cut_short = false;
    for (; context.attempt < context.attempts && !cut_short; ++context.attempt) {
      const bool last = context.attempt + 1 == context.attempts;
      Attempt attempt{last ? std::exchange(state, {}) : state, s};
      attempt.statistics.seconds = spent;
      run_attempt(attempt, context);
      spent = attempt.statistics.seconds;
      cut_short = attempt.outcome == EngineOutcome::stopped;
      if (!best || attempt.better_than(*best, options_.face_budget)) best = std::move(attempt);
    }
    state = std::move(best->state);
    s = std::move(best->statistics);
    s.seconds = spent;
    outcome_ = cut_short ? EngineOutcome::stopped : best->outcome;
  }

  // Null if only the distance of the cage to the input is bounded.
  std::optional<Coverage> samples_to_cover() const {
    if (options_.bound != Bound::both) return {};
    return Coverage(samples_of(valid().surface.mesh, most_vertices, spread_points));
  }

  void run_attempt(Attempt& attempt, EngineContext context) const {
    Options options = options_;
    options.seed += static_cast<std::uint64_t>(context.attempt);
    std::optional<Coverage> coverage = samples_to_cover();
    context.coverage = coverage ? &*coverage : nullptr;
    context.options = &options;
    context.statistics = &attempt.statistics;
    attempt.outcome = run_engine(attempt.state, context);
    if (context.attempts == 1) return;
    const Mesh cage = attempt.state.mesh.to_mesh();
    SurfaceTree tree(device_);
    tree.build(unit_frame(cage.positions), cage.positions, cage.triangles);
    attempt.distance = measured_hausdorff(valid().tree, tree, hausdorff_samples);
  }

  // How far it moves a vertex at most if the level before and the first cage of this one are rounded to floats.
  double float_rounding(const CornerTable& mesh) const {
    if (options_.precision != Precision::float32) return 0;
    double largest = 0;
    for (const Position& p : mesh.position)
      for (const double x : p) largest = std::max(largest, std::abs(x));
    return 2 * largest * static_cast<double>(std::numeric_limits<float>::epsilon());
  }

  // A copy of the cage goes on with growing thickness.
  void estimate_needed_tau(CageState state, EngineContext context) {
    const Stopwatch watch(seconds().estimate);
    Options options = options_;
    options.tau = options.tau_absolute = 0;  // every cycle has its own thickness
    options.quality = Quality::fast;         // nothing is to come back
    Statistics unused;
    std::optional<Coverage> coverage = samples_to_cover();
    context.coverage = coverage ? &*coverage : nullptr;
    context.options = &options;
    context.statistics = &unused;
    context.thickness =
        wider_steps(thickness_.back(), options_.face_budget, result_.statistics.diagonal, result_.validation.area);
    context.estimates = true;
    no_tau_helps_ = false;
    if (context.thickness.empty()) return;
    const EngineOutcome outcome = run_engine(state, context);
    no_tau_helps_ = outcome == EngineOutcome::schedule_finished;
    if (outcome != EngineOutcome::budget_reached) return;
    const double unit = options_.tau_absolute > 0 ? 1 : result_.statistics.diagonal;
    result_.statistics.needed_tau = round_up(estimate_margin * unused.cycles.back().tau / share_ / unit) * unit;
  }

  void finish(const CageState& state) {
    Mesh cage = take_mesh(state, options_.precision);
    {
      const Stopwatch watch(seconds().certify);
      const Validation& v = result_.validation;
      const Enclosed input = soup_ ? enclosed(*soup_, v.components, v.euler_characteristic) : enclosed(*checked_);
      result_.certificate = certify_cage(device_, input, cage);
      if (before_) result_.around_previous = certify_cage(device_, enclosed(before_->checked), cage);
    }
    if (!result_.certificate.valid() || (before_ && !result_.around_previous->valid())) {
      fail_certificate("the cage", options_.precision);
      return;
    }
    result_.cage = std::move(cage);
    conclude();
    report(Control::Stage::done, result_.cage.triangles.size(), 1);
  }

  void conclude() {
    switch (outcome_) {
      case EngineOutcome::stopped:
        stop("; the cage is valid but not finished");
        break;
      case EngineOutcome::schedule_finished:
        if (options_.face_budget != 0) {
          fail(Status::face_budget_not_reached, missed_budget_message());
          break;
        }
        [[fallthrough]];
      case EngineOutcome::budget_reached:
        result_.status = Status::ok;
    }
  }

  std::string missed_budget_message() const {
    const Statistics& s = result_.statistics;
    std::ostringstream text;
    text << "no fewer than " << s.cage_faces << " faces were reached "
         << (finds_thickness(options_) ? "at any thickness" : "within tau");
    const bool absolute = options_.tau_absolute > 0;
    if (s.needed_tau > 0) {
      text << "; about " << (absolute ? s.needed_tau : s.needed_tau / s.diagonal)
           << (absolute ? " in the unit of the input" : "") << " would allow " << options_.face_budget
           << " (an upper estimate)";
    } else if (no_tau_helps_) {
      text << ", and no larger one that was tried allows " << options_.face_budget;
    }
    return text.str();
  }

  Options options_;
  std::unique_ptr<Soup> soup_;           // null: the input itself is enclosed
  std::unique_ptr<LevelBefore> before_;  // null: the first level
  std::vector<float> reach_;             // of each face of the cage: bounds the distance of its points to the input
  double narrowed_ = 1;                  // further share of thicknesses, where a level is made again
  double share_ = 1;                     // of every thickness, for this level
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::size_t first_step_ = 0;  // of the thicknesses: where this level begins
  bool no_tau_helps_ = false;   // to reach the face budget
};

template <class RunPipeline>
std::vector<Result> run_levels_safely(const MeshView& input, const std::vector<std::size_t>& face_budgets,
                                      Options options, const RunPipeline& run_pipeline) {
  if (const std::string error = levels_error(face_budgets); !error.empty()) {
    Result refused;
    refused.status = Status::invalid_options;
    refused.message = error;
    return {refused};
  }
  options.face_budget = face_budgets.front();
  std::vector<Result> levels;
  Result last = run_safely<Result>(input, options_error(options), options.threads,
                                   [&](Result& result) { run_pipeline(options, result, levels); });
  for (const Result& level : levels) last.statistics.seconds.total -= level.statistics.seconds.total;
  levels.push_back(std::move(last));
  return levels;
}

}  // namespace

Result make_cage(const MeshView& input, const Options& options, Control* control) {
  return run_safely<Result>(input, options_error(options), options.threads, [&](Result& result) {
    Pipeline pipeline(input, options, control, result);
    if (pipeline.check_input()) pipeline.make();
  });
}

Result make_cage_around(const MeshView& input, const MeshView& wrap, const Options& options, Control* control) {
  return run_safely<Result>(input, options_error(options), options.threads, [&](Result& result) {
    Pipeline pipeline(wrap, options, control, result);
    if (pipeline.take_triangles(input) && pipeline.check_input()) pipeline.make();
  });
}

std::vector<Result> make_cages(const MeshView& input, const std::vector<std::size_t>& face_budgets,
                               const Options& options, Control* control) {
  return run_levels_safely(input, face_budgets, options, [&](const Options& first, Result& result, auto& levels) {
    Pipeline pipeline(input, first, control, result);
    if (pipeline.check_input()) pipeline.make_levels(face_budgets, levels);
  });
}

std::vector<Result> make_cages_around(const MeshView& input, const MeshView& wrap,
                                      const std::vector<std::size_t>& face_budgets, const Options& options,
                                      Control* control) {
  return run_levels_safely(input, face_budgets, options, [&](const Options& first, Result& result, auto& levels) {
    Pipeline pipeline(wrap, first, control, result);
    if (pipeline.take_triangles(input) && pipeline.check_input()) pipeline.make_levels(face_budgets, levels);
  });
}

}  // namespace prcage
