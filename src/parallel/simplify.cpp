// The pipeline behind simplify() and make_low_poly(): validate, run the engine in a band on both sides of the input,
// certify from scratch.
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

#include "core/schedule.h"
#include "parallel/certify.h"
#include "parallel/deviation.h"
#include "parallel/initial_cage.h"
#include "parallel/parallel_for.h"
#include "parallel/pipeline.h"
#include "parallel/run_safely.h"
#include "parallel/wrap_room.h"

namespace prcage {
namespace {

// Samples of the input whose distance to the surface is bounded: vertices, all or an even choice of so many, and points
// spread over the area, a share of the tolerance apart from each other if so many are enough for that.
constexpr std::size_t most_vertices = 60000;
constexpr std::size_t most_spread = 120000;
constexpr double spacing_share = 1.0 / 8;
// Low-poly meshes farther from the input, relative to l, are none of it any more.
constexpr double largest_low_poly_tolerance = 0.1;
// What the distance may rise by between samples, in spacings of these.
constexpr double rise_between = 0.4;

// What is asked of a run, whichever function asks.
struct Task {
  Options engine;             // its thickness is the larger tolerance
  BandShape shape;            // both, relative to that
  bool strict_sides = false;  // every point keeps to the tolerance of its own side, not to the larger one only
  double most_thickness = 1;  // relative to l: where the search for one ends
  std::size_t samples = 0;
  const MeshView* wrap = nullptr;
};

double tau_of(const SimplifyOptions& options) { return std::max(options.tau_inner, options.tau_outer); }

// What the options of all have in common.
template <class AnyOptions>
Task task_of(const AnyOptions& options) {
  Task task;
  task.engine.tau_mode = options.tau_mode;
  task.engine.flips = options.flips;
  task.engine.seed = options.seed;
  task.engine.threads = options.threads;
  task.engine.accept_inside_out = options.accept_inside_out;
  task.engine.precision = options.precision;
  task.samples = options.samples;
  return task;
}

Task simplification(const SimplifyOptions& options) {
  Task task = task_of(options);
  task.engine.tau = options.absolute ? 1 : tau_of(options);
  task.engine.tau_absolute = options.absolute ? tau_of(options) : 0;
  task.engine.bound = options.bound;
  // Flips wear a surface down for the sake of angles, which only the samples of the input prevent.
  task.engine.flips = options.flips && options.bound == Bound::both;
  task.engine.cycles = options.cycles;
  task.engine.schedule = options.schedule;
  task.engine.face_budget = options.face_budget;
  task.shape = {Sides::both, options.tau_outer / tau_of(options), options.tau_inner / tau_of(options)};
  task.strict_sides = options.tau_mode == TauMode::strict && options.tau_inner != options.tau_outer;
  return task;
}

// The engine finds the thickness that allows the faces.
Task low_poly(const LowPolyOptions& options, const MeshView* wrap) {
  Task task = task_of(options);
  task.engine.tau = 0;
  task.most_thickness = largest_low_poly_tolerance;
  task.engine.bound = Bound::both;
  task.engine.quality = options.quality;
  task.engine.face_budget = options.faces;
  task.shape = {Sides::both, 1, wrap == nullptr ? 1 : options.inner_share};
  task.wrap = wrap;
  return task;
}

std::string error_in(const SimplifyOptions& options) {
  for (const double tau : {options.tau_inner, options.tau_outer}) {
    if (!(tau > 0 && std::isfinite(tau)) || (!options.absolute && tau > 1))
      return options.absolute ? "tau_inner and tau_outer must be positive and finite"
                              : "tau_inner and tau_outer must be in (0, 1]";
  }
  return options_error(simplification(options).engine);
}

std::string error_in(const LowPolyOptions& options) {
  if (options.faces == 0) return "faces must be at least one";
  if (!(options.inner_share > 0 && options.inner_share <= 1)) return "inner_share must be in (0, 1]";
  return options_error(low_poly(options, nullptr).engine);
}

CoverageSamples samples_of(const Mesh& surface, double area, double tau) {
  const double wanted = area / std::pow(spacing_share * tau, 2);
  const std::size_t count = wanted < most_spread ? 1 + static_cast<std::size_t>(wanted) : most_spread;
  CoverageSamples samples = samples_of(surface, most_vertices, count);
  samples.margin = rise_between * std::sqrt(area / static_cast<double>(count));
  return samples;
}

class Simplification : PipelineBase<SimplifyResult> {
 public:
  Simplification(const MeshView& input, const Task& task, Control* control, SimplifyResult& result)
      : PipelineBase(input, control, result), task_(task), options_(task.engine) {}

  void run() {
    validate_input(options_.accept_inside_out);
    thickness_ = thickness_steps(options_, result_.validation.diagonal, result_.validation.area);
    while (thickness_.size() > 1 && thickness_.back() > task_.most_thickness * result_.validation.diagonal)
      thickness_.pop_back();
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
  const Mesh& surface() const { return checked_->valid.surface.mesh; }

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
    DistanceBand band(tree);
    SurfaceTree wrap(device_);
    std::optional<WrapRoom> room;
    if (task_.wrap != nullptr && build_wrap(wrap)) room.emplace(wrap).measure(state);
    std::optional<Coverage> coverage;
    if (options_.bound == Bound::both) coverage.emplace(samples(room ? &*room : nullptr));
    const SideTest side_test(tree, band, device_);

    EngineContext context{};
    context.options = &options_;
    context.diagonal = result_.statistics.diagonal;
    context.thickness = thickness_;
    context.frame = tree.frame();
    context.device = &device_;
    context.band = &band;
    context.coverage = coverage ? &*coverage : nullptr;
    context.control = control_;
    context.statistics = &result_.statistics;
    context.band_shape = task_.shape;
    context.room = room ? &*room : nullptr;
    context.side_test = task_.strict_sides ? &side_test : nullptr;
    context.most_covered_faces = no_limit;
    context.refits = finds_thickness(options_);
    context.area = result_.validation.area;
    outcome_ = run_engine(state, context);
    Statistics& s = result_.statistics;
    if (finds_thickness(options_)) s.tau = s.cycles.empty() ? thickness_.front() : s.cycles.back().tau;
    s.band_voxels = band.voxels_filled();
    result_.tau_inner = s.tau * task_.shape.inner;
    result_.tau_outer = s.tau * task_.shape.outer;
  }

  // What is near the wrap is anchored: it has the inner tolerance in both directions.
  CoverageSamples samples(const WrapRoom* room) const {
    CoverageSamples samples = samples_of(surface(), result_.validation.area,
                                         finds_thickness(options_) ? thickness_.front() : thickness_.back());
    if (room == nullptr) return samples;
    samples.least_share = task_.shape.inner;
    samples.room.resize(samples.points.size());
    parallel_each(samples.points.size(), 256,
                  [&](std::size_t s) { samples.room[s] = room->at(vec(samples.points[s])); });
    return samples;
  }

  // False if there is nothing of it that could be a guide.
  bool build_wrap(SurfaceTree& tree) {
    SubMesh used;
    if (!well_formed(to_mesh(*task_.wrap), used)) return false;
    wrap_ = std::move(used.mesh);
    tree.build(unit_frame(wrap_.positions), wrap_.positions, wrap_.triangles);
    return true;
  }

  void finish(const CageState& state) {
    Mesh mesh = take_mesh(state, options_.precision);
    {
      const Stopwatch watch(seconds().certify);
      const Validation& v = result_.validation;  // of the input as given: its zero-area faces change nothing in it
      const Simplified input{valid().tree.frame(), v.components, v.cavities, v.euler_characteristic};
      result_.certificate = certify_simplified(device_, input, mesh);
    }
    if (!result_.certificate.valid()) {
      fail_certificate("the surface", options_.precision);
      return;
    }
    measure(mesh);
    result_.mesh = std::move(mesh);
    conclude();
    report(Control::Stage::done, result_.mesh.triangles.size(), 1);
  }

  void measure(const Mesh& mesh) {
    if (task_.samples == 0) return;
    const Stopwatch watch(seconds().certify);
    SurfaceTree tree(device_);
    tree.build(valid().tree.frame(), mesh.positions, mesh.triangles);
    result_.deviation = measure_deviation(device_, valid().tree, tree, result_.statistics.diagonal, task_.samples);
  }

  void conclude() {
    if (outcome_ == EngineOutcome::stopped) {
      stop("; the surface is valid but not finished");
    } else if (outcome_ == EngineOutcome::schedule_finished && options_.face_budget != 0) {
      const std::string faces = std::to_string(result_.statistics.cage_faces) + " faces";
      fail(Status::face_budget_not_reached,
           finds_thickness(options_) ? "no tolerance allows fewer than " + faces
                                     : "the tolerances allow no fewer than " + faces + "; larger ones allow fewer");
    } else {
      result_.status = Status::ok;
    }
  }

  const Task& task_;
  const Options& options_;
  Mesh wrap_;
};

}  // namespace

SimplifyResult simplify(const MeshView& input, const SimplifyOptions& options, Control* control) {
  return run_safely<SimplifyResult>(input, error_in(options), options.threads, [&](SimplifyResult& result) {
    Simplification(input, simplification(options), control, result).run();
  });
}

SimplifyResult make_low_poly(const MeshView& input, const MeshView* wrap, const LowPolyOptions& options,
                             Control* control) {
  return run_safely<SimplifyResult>(input, error_in(options), options.threads, [&](SimplifyResult& result) {
    Simplification(input, low_poly(options, wrap), control, result).run();
  });
}

}  // namespace prcage
