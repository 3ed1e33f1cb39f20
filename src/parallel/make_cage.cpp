// The pipeline behind make_cage(): validate, displace, run the engine, certify from scratch.
#include <sys/resource.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <sstream>

#include "core/mesh_view.h"
#include "core/schedule.h"
#include "core/simd.h"
#include "parallel/arena.h"
#include "parallel/certify.h"
#include "parallel/engine.h"
#include "parallel/initial_cage.h"
#include "parallel/soup.h"
#include "parallel/stopwatch.h"
#include "parallel/validate.h"

namespace prcage {
namespace {

// The longest first move in steps: vertices between nearly antiparallel faces would otherwise go very far.
constexpr double longest_move = 50;
// The radius at which singular vertices are cut off, in steps.
constexpr double longest_radius = 100;
// Samples of the input whose distance to the cage is bounded.
constexpr std::size_t most_samples = 40000;
// Of the first cycle's tau, for each of the two, so that C_0 lies within it.
constexpr double largest_share_of_tau = 0.5;

std::uint64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

void report(Control* control, Control::Stage stage, std::size_t faces, double progress) {
  if (control != nullptr) control->report(stage, 0, faces, progress);
}

// Where C_0 could not be freed of conflicts, for people.
std::string displacement_message(const InitialCage& cage, const Mesh& surface) {
  const bool contact = cage.contacts.count > 0;
  const FacePairs& pairs = contact ? cage.contacts : cage.self_intersections;
  const auto face = pairs.pairs[0][contact ? 1 : 0];
  const Position& p =
      surface.positions[surface.triangles[std::min<std::size_t>(face, surface.triangles.size() - 1)][0]];
  std::ostringstream text;
  text << "the input cannot be moved off itself without a collision: "
       << cage.contacts.count + cage.self_intersections.count << " pairs of faces stay in conflict, e.g. near (" << p[0]
       << ", " << p[1] << ", " << p[2]
       << "); sheets may be too close to each other there for double precision, or a vertex too singular";
  return text.str();
}

class Pipeline {
 public:
  Pipeline(const MeshView& input, const Options& options, Control* control, Result& result)
      : input_(input), options_(options), control_(control), result_(result) {}

  // The input is a wrap of the triangles, which then are what is certified to be enclosed.
  void run_around(const MeshView& triangles) {
    {
      const Stopwatch watch(seconds().validate);
      Mesh faces;
      const std::string error = usable_faces(to_mesh(triangles), faces, result_.statistics.dropped);
      if (!error.empty()) {
        fail(Status::invalid_input, error);
        return;
      }
      soup_ = std::make_unique<Soup>(make_soup(std::move(faces), device_));
    }
    run();
  }

  void run() {
    report(control_, Control::Stage::validate, input_.triangle_count, 0);
    {
      const Stopwatch watch(seconds().validate);
      checked_ = std::make_unique<CheckedMesh>(validate_mesh(to_mesh(input_), device_, options_.accept_inside_out));
      result_.validation = checked_->validation;
    }
    describe_input();
    if (!checked_->validation.valid()) {
      fail(Status::invalid_input,
           std::string(soup_ ? "the wrap" : "the input") + " is not a legal mesh: see the defects");
      return;
    }
    InitialCage first = displaced();
    if (!first.valid) {
      fail(Status::displacement_failed, displacement_message(first, valid().surface.mesh));
      return;
    }
    collapse(first.state);
    finish(first.state);
  }

 private:
  StageSeconds& seconds() { return result_.statistics.seconds; }
  const ValidSurface& valid() const { return checked_->valid; }

  void fail(Status status, std::string message) {
    result_.status = status;
    result_.message = std::move(message);
  }

  void describe_input() {
    Statistics& s = result_.statistics;
    s.diagonal = result_.validation.diagonal;
    thickness_ = thickness_steps(options_, s.diagonal, result_.validation.area);
    s.tau = thickness_.back();
  }

  InitialCage displaced() {
    report(control_, Control::Stage::displace, valid().surface.mesh.triangles.size(), 0.03);
    const Stopwatch watch(seconds().displace);
    Statistics& s = result_.statistics;
    DisplacementSettings settings;
    settings.step = options_.sigma * s.diagonal;
    const double share_of_tau = largest_share_of_tau * thickness_.front();
    settings.longest_move = std::min(longest_move * settings.step, share_of_tau);
    settings.longest_radius = std::min(longest_radius * settings.step, share_of_tau);
    InitialCage first = displace(valid().surface.mesh, valid().tree, settings, device_);
    s.singular_vertices = first.singular_vertices;
    s.capped_vertices = first.capped_vertices;
    s.halved_vertices = first.halved_vertices;
    const auto [low, high] = std::minmax_element(first.step.begin(), first.step.end());
    s.sigma_min = *low;
    s.sigma_max = *high;
    return first;
  }

  void collapse(CageState& state) {
    const Mesh& surface = valid().surface.mesh;
    DistanceBand band(surface.positions, surface.triangles, valid().tree.frame(), valid().tree.tree());
    Statistics& s = result_.statistics;
    const Obstacle obstacle(valid().tree, valid().components, device_);
    std::optional<Coverage> coverage;
    if (options_.bound == Bound::both) coverage.emplace(surface.positions, most_samples);
    const EngineContext context{&options_, s.diagonal, thickness_, valid().tree.frame(),
                                &device_,  &band,      &obstacle,  coverage ? &*coverage : nullptr,
                                control_,  &s};
    outcome_ = run_engine(state, context);
    if (finds_thickness(options_)) s.tau = s.cycles.empty() ? thickness_.front() : s.cycles.back().tau;
    for (CycleStatistics& cycle : s.cycles) cycle.beta = cycle.tau / s.tau;
    s.band_voxels = band.voxels_filled();
  }

  void finish(const CageState& state) {
    Mesh cage = state.mesh.to_mesh();
    const bool as_floats = options_.precision == Precision::float32;
    // Collapses place vertices on floats; those that never moved since C_0 are still doubles.
    if (as_floats)
      for (Position& p : cage.positions) p = round_to_floats(vec(p));
    Statistics& s = result_.statistics;
    s.cage_vertices = cage.positions.size();
    s.cage_faces = cage.triangles.size();
    report(control_, Control::Stage::certify, s.cage_faces, 0.95);
    {
      const Stopwatch watch(seconds().certify);
      const Validation& v = result_.validation;
      const Enclosed input = soup_ ? enclosed(*soup_, v.components, v.euler_characteristic) : enclosed(*checked_);
      result_.certificate = certify_cage(device_, input, cage);
    }
    if (!result_.certificate.valid()) {
      fail(Status::certificate_failed,
           as_floats ? "the cage does not survive the rounding of its coordinates to floats; store it in a format that "
                       "holds doubles"
                     : "the cage failed its certificate; this is a defect of prcage, please report it");
      return;
    }
    result_.cage = std::move(cage);
    conclude();
    report(control_, Control::Stage::done, s.cage_faces, 1);
  }

  void conclude() {
    switch (outcome_) {
      case EngineOutcome::cancelled:
        fail(Status::cancelled, "cancelled; the cage is valid but not finished");
        break;
      case EngineOutcome::schedule_finished:
        if (options_.face_budget != 0) {
          fail(Status::face_budget_not_reached,
               (finds_thickness(options_) ? "no thickness allows fewer than " : "tau allows no fewer than ") +
                   std::to_string(result_.statistics.cage_faces) +
                   (finds_thickness(options_) ? " faces" : " faces; a larger tau allows fewer, or none given at all"));
          break;
        }
        [[fallthrough]];
      case EngineOutcome::budget_reached:
        result_.status = Status::ok;
    }
  }

  const MeshView& input_;
  const Options& options_;
  Control* control_;
  Result& result_;
  TreeDevice device_;
  std::vector<double> thickness_;  // of each cycle
  std::unique_ptr<CheckedMesh> checked_;
  std::unique_ptr<Soup> soup_;  // null: the input itself is enclosed
  EngineOutcome outcome_ = EngineOutcome::schedule_finished;
};

// Everything but the pipeline itself: the options, the arena, what may be thrown.
template <class RunPipeline>
Result run_safely(const MeshView& input, const Options& options, const RunPipeline& run_pipeline) {
  Result result;
  Statistics& s = result.statistics;
  s.input_vertices = input.vertex_count;
  s.input_faces = input.triangle_count;
  s.simd = name_of(simd_level());
  if (const std::string error = options_error(options); !error.empty()) {
    result.status = Status::invalid_options;
    result.message = error;
    return result;
  }
  {
    const Stopwatch watch(s.seconds.total);
    try {
      Arena arena(options.threads);
      s.threads = arena.threads();
      arena.run([&] { run_pipeline(result); });
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& e) {
      result = Result{};
      result.message = e.what();
    }
  }
  result.statistics.peak_memory_bytes = peak_memory_bytes();
  return result;
}

}  // namespace

Result make_cage(const MeshView& input, const Options& options, Control* control) {
  return run_safely(input, options, [&](Result& result) { Pipeline(input, options, control, result).run(); });
}

Result make_cage_around(const MeshView& input, const MeshView& wrap, const Options& options, Control* control) {
  return run_safely(input, options,
                    [&](Result& result) { Pipeline(wrap, options, control, result).run_around(input); });
}

}  // namespace prcage
