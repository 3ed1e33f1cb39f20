// The pipeline behind simplify(): validate, run the engine in a band on both sides of the input, certify from scratch.
//
// The first state is the input itself, zero-area faces repaired: nothing has to be moved off it. Each operation keeps
// what the certificate claims in the end: the link condition the topology, exact tests of the new faces against each
// other and all others that nothing intersects, and the test for components that are swept over their nesting.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/area_samples.h"
#include "core/mesh_view.h"
#include "core/schedule.h"
#include "parallel/certify.h"
#include "parallel/deviation.h"
#include "parallel/engine.h"
#include "parallel/initial_cage.h"
#include "parallel/run_safely.h"
#include "parallel/validate.h"

namespace prcage {
namespace {

// Samples of the input whose distance to the surface is bounded: vertices, all or an even choice of so many, and points
// spread over the area, a share of the tolerance apart from each other if so many are enough for that.
constexpr std::size_t most_vertices = 60000;
constexpr std::size_t most_spread = 120000;
constexpr double spacing_share = 1.0 / 8;
// What the distance may rise by between samples, in spacings of these.
constexpr double rise_between = 0.4;

double tau_of(const SimplifyOptions& options) { return std::max(options.tau_inner, options.tau_outer); }

// What the engine reads of them. Its thickness is the larger tolerance.
Options engine_options(const SimplifyOptions& options) {
  Options engine;
  engine.tau = options.absolute ? 1 : tau_of(options);
  engine.tau_absolute = options.absolute ? tau_of(options) : 0;
  engine.tau_mode = options.tau_mode;
  engine.bound = options.bound;
  engine.cycles = options.cycles;
  engine.schedule = options.schedule;
  engine.face_budget = options.face_budget;
  engine.flips = options.flips;
  engine.seed = options.seed;
  engine.threads = options.threads;
  engine.precision = options.precision;
  return engine;
}

std::string simplify_options_error(const SimplifyOptions& options) {
  for (const double tau : {options.tau_inner, options.tau_outer}) {
    if (!(tau > 0 && std::isfinite(tau)) || (!options.absolute && tau > 1))
      return options.absolute ? "tau_inner and tau_outer must be positive and finite"
                              : "tau_inner and tau_outer must be in (0, 1]";
  }
  return options_error(engine_options(options));
}

CoverageSamples samples_of(const Mesh& surface, double area, double tau) {
  const std::size_t stride = (surface.positions.size() + most_vertices - 1) / most_vertices;
  CoverageSamples samples;
  for (std::size_t v = 0; v < surface.positions.size(); v += stride) samples.points.push_back(surface.positions[v]);
  const double wanted = area / std::pow(spacing_share * tau, 2);
  const std::size_t count = wanted < most_spread ? 1 + static_cast<std::size_t>(wanted) : most_spread;
  const AreaSamples spread(surface.positions, surface.triangles, count, CounterRandom(0, 0));
  for (std::size_t i = 0; i < spread.size(); ++i) samples.points.push_back(position(spread[i].point));
  samples.margin = rise_between * std::sqrt(area / static_cast<double>(count));
  return samples;
}

class Simplification {
 public:
  Simplification(const MeshView& input, const SimplifyOptions& options, Control* control, SimplifyResult& result)
      : input_(input),
        options_(options),
        engine_options_(engine_options(options)),
        control_(control),
        result_(result) {}

  void run() {
    report(Control::Stage::validate, input_.triangle_count, 0);
    {
      const Stopwatch watch(seconds().validate);
      checked_ = std::make_unique<CheckedMesh>(validate_mesh(to_mesh(input_), device_, options_.accept_inside_out));
      result_.validation = checked_->validation;
    }
    result_.statistics.diagonal = result_.validation.diagonal;
    thickness_ = thickness_steps(engine_options_, result_.validation.diagonal, result_.validation.area);
    result_.statistics.tau = thickness_.back();
    if (!checked_->validation.valid()) {
      fail(Status::invalid_input, "the input is not a legal mesh: see the defects");
      return;
    }
    CageState state = first_state();
    collapse(state);
    finish(state);
  }

 private:
  StageSeconds& seconds() { return result_.statistics.seconds; }
  const ValidSurface& valid() const { return checked_->valid; }
  const Mesh& surface() const { return checked_->valid.surface.mesh; }

  void report(Control::Stage stage, std::size_t faces, double progress) {
    if (control_ != nullptr) control_->report(stage, 0, faces, progress);
  }

  void fail(Status status, std::string message) {
    result_.status = status;
    result_.message = std::move(message);
  }

  CageState first_state() const {
    CageState state;
    state.mesh = CornerTable::from_mesh(surface());
    describe_faces(surface(), valid().tree.frame(), state);
    const Components& components = valid().components;
    if (components.count() > 1) {
      state.components = components.count();
      state.vertex_component.resize(surface().positions.size());
      for (std::size_t f = 0; f < surface().triangles.size(); ++f)
        for (const std::uint32_t v : surface().triangles[f]) state.vertex_component[v] = components.of_face[f];
    }
    return state;
  }

  void collapse(CageState& state) {
    const SurfaceTree& tree = valid().tree;
    DistanceBand band(surface().positions, surface().triangles, tree.frame(), tree.tree());
    std::optional<Coverage> coverage;
    if (options_.bound == Bound::both)
      coverage.emplace(samples_of(surface(), result_.validation.area, thickness_.back()));
    const SideTest side_test(tree, band, device_);
    const bool sides_differ = options_.tau_inner != options_.tau_outer && options_.tau_mode == TauMode::strict;

    EngineContext context{};
    context.options = &engine_options_;
    context.diagonal = result_.statistics.diagonal;
    context.thickness = thickness_;
    context.frame = tree.frame();
    context.device = &device_;
    context.band = &band;
    context.coverage = coverage ? &*coverage : nullptr;
    context.control = control_;
    context.statistics = &result_.statistics;
    context.band_shape = {Sides::both, options_.tau_outer / tau_of(options_), options_.tau_inner / tau_of(options_)};
    context.side_test = sides_differ ? &side_test : nullptr;
    context.most_covered_faces = no_limit;
    outcome_ = run_engine(state, context);
    result_.statistics.band_voxels = band.voxels_filled();
  }

  void finish(const CageState& state) {
    Mesh mesh = state.mesh.to_mesh();
    const bool as_floats = options_.precision == Precision::float32;
    // Collapses place vertices on floats; those that have not moved may be doubles.
    if (as_floats)
      for (Position& p : mesh.positions) p = round_to_floats(vec(p));
    Statistics& s = result_.statistics;
    s.cage_vertices = mesh.positions.size();
    s.cage_faces = mesh.triangles.size();
    report(Control::Stage::certify, s.cage_faces, 0.95);
    {
      const Stopwatch watch(seconds().certify);
      const Validation& v = result_.validation;
      const Simplified input{valid().tree.frame(), v.components, v.cavities, euler_characteristic()};
      result_.certificate = certify_simplified(device_, input, mesh);
    }
    if (!result_.certificate.valid()) {
      fail(Status::certificate_failed,
           as_floats ? "the surface does not survive the rounding of its coordinates to floats; store it in a format "
                       "that holds doubles"
                     : "the surface failed its certificate; this is a defect of prcage, please report it");
      return;
    }
    measure(mesh);
    result_.mesh = std::move(mesh);
    conclude();
    report(Control::Stage::done, s.cage_faces, 1);
  }

  // Of the input as given: its zero-area faces change nothing in it.
  long long euler_characteristic() const { return result_.validation.euler_characteristic; }

  void measure(const Mesh& mesh) {
    if (options_.samples == 0) return;
    const Stopwatch watch(seconds().certify);
    SurfaceTree tree(device_);
    tree.build(valid().tree.frame(), mesh.positions, mesh.triangles, TreeQuality::fast_query);
    result_.deviation = measure_deviation(device_, valid().tree, tree, result_.statistics.diagonal, options_.samples);
  }

  void conclude() {
    if (outcome_ == EngineOutcome::stopped) {
      const bool cancelled = control_->cancelled();
      fail(
          cancelled ? Status::cancelled : Status::deadline_reached,
          std::string(cancelled ? "cancelled" : "the deadline has passed") + "; the surface is valid but not finished");
    } else if (outcome_ == EngineOutcome::schedule_finished && options_.face_budget != 0) {
      fail(Status::face_budget_not_reached, "the tolerances allow no fewer than " +
                                                std::to_string(result_.statistics.cage_faces) +
                                                " faces; larger ones allow fewer");
    } else {
      result_.status = Status::ok;
    }
  }

  const MeshView& input_;
  const SimplifyOptions& options_;
  const Options engine_options_;
  Control* control_;
  SimplifyResult& result_;
  TreeDevice device_;
  std::vector<double> thickness_;  // of each cycle
  std::unique_ptr<CheckedMesh> checked_;
  EngineOutcome outcome_ = EngineOutcome::schedule_finished;
};

}  // namespace

SimplifyResult simplify(const MeshView& input, const SimplifyOptions& options, Control* control) {
  return run_safely<SimplifyResult>(
      input, simplify_options_error(options), options.threads,
      [&](SimplifyResult& result) { Simplification(input, options, control, result).run(); });
}

}  // namespace prcage
