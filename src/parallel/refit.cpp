#include "parallel/refit.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>

#include "core/distance.h"
#include "core/lattice.h"
#include "parallel/commit.h"
#include "parallel/conflicts.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

// A move that fails is tried again at half the length so many times.
constexpr int most_halvings = 3;
// Of the squares: what a move must gain.
constexpr double least_gain = 1e-3;
// Of the trace of the normal equations: holds vertices where samples say nothing.
constexpr double damping = 1e-3;

// What is planned for a vertex; zero: nothing.
struct Step {
  Vec3 move = Vec3::Zero();
  int halvings = 0;

  bool wanted() const { return !move.isZero(0); }
};

double area(const Corners& p) { return 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).norm(); }

// The normal equations of a vertex.
struct Pulls {
  Eigen::Matrix3d form = Eigen::Matrix3d::Zero();
  Vec3 sum = Vec3::Zero();

  // A point that follows the vertex by `share` wants to go by `off`; only the distance counts.
  void add(const Vec3& off, double share, double weight) {
    const double distance = off.norm();
    if (!(distance > 0)) return;
    const Vec3 along = off / distance;
    form += weight * share * share * along * along.transpose();
    sum += weight * share * off;
  }

  Vec3 step() const {
    const double trace = form.trace();
    if (!(trace > 0)) return Vec3::Zero();
    Eigen::Matrix3d damped = form;
    damped.diagonal().array() += damping * trace;
    return damped.ldlt().solve(sum);
  }
};

class Refit {
 public:
  Refit(CageState& state, const RefitSettings& settings, const UnitFrame& frame, const TreeDevice& device,
        DistanceBand& band)
      : state_(state),
        settings_(settings),
        frame_(frame),
        device_(device),
        band_(band),
        steps_(state.mesh.vertex_slots()) {}

  void plan() {
    parallel_each(steps_.size(), 4, [&](std::size_t v) {
      steps_[v] = {};
      if (state_.mesh.vertex_halfedge[v] == none) return;
      steps_[v].move = least_squares_step(static_cast<std::uint32_t>(v));
      drop_if_short(steps_[v]);
    });
  }

  // Moves of vertices that are not neighbours. False if there are none left.
  bool move_some(std::uint64_t round, std::size_t& moved) {
    const auto wanted = [&](std::uint32_t v) { return steps_[v].wanted(); };
    const std::vector<Candidate> selected = select_independent_vertices(state_.mesh, settings_.seed + round, wanted);
    if (selected.empty()) return false;
    PatchBatch batch = build_moves(state_, frame_, selected, places(selected));
    test(batch);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      Step& step = steps_[batch.moved[i]];
      if (batch.verdict[i] == Verdict::conflict) continue;  // another one goes first
      if (batch.alive(i) || ++step.halvings > most_halvings) step.move = Vec3::Zero();
      step.move *= 0.5;
      drop_if_short(step);
    }
    commit_moves(state_, batch);
    settings_.coverage->commit(batch);
    moved += batch.count(Verdict::accepted);
    return true;
  }

 private:
  // The step of Gauss and Newton: samples pull at the points of the star that are nearest to them, and the input at
  // points of the star.
  Vec3 least_squares_step(std::uint32_t v) const {
    const CornerTable& mesh = state_.mesh;
    Pulls pulls;
    for_each_outgoing(mesh, v, [&](std::uint32_t h) {
      const Corners p{mesh.vec_at(v), mesh.vec_at(mesh.target(h)), mesh.vec_at(mesh.apex(h))};
      const TriangleDistance face(p[0], p[1], p[2]);
      settings_.coverage->for_each_sample(h / 3, [&](const Vec3& x) {
        const auto weights = face.nearest_weights(x);
        pulls.add(x - at(p, weights), weights[0], settings_.sample_area);
      });
      std::uint32_t hint = state_.face_near[h / 3];
      const double point_area = area(p) / lattice_points;
      for_each_lattice_point([&](const Barycentric& weights) {
        const Vec3 y = at(p, weights);
        hint = band_.nearest(y, hint).face;
        pulls.add(band_.nearest_point(y, hint) - y, weights[0], point_area);
      });
    });
    return pulls.step();
  }

  // The integral of the squared distance of a face to the input.
  double squares(const Corners& p, std::uint32_t hint) const {
    double sum = 0;
    for_each_lattice_point([&](const Barycentric& weights) {
      const DistanceBand::Near near = band_.nearest(at(p, weights), hint);
      hint = near.face;
      sum += near.distance * near.distance;
    });
    return sum * area(p) / lattice_points;
  }

  // Rejects moves after which the surface and the input would not be nearer to each other.
  void reject_without_gain(PatchBatch& batch) const {
    const CornerTable& mesh = state_.mesh;
    parallel_each(batch.size(), 1, [&](std::size_t i) {
      if (!batch.alive(i)) return;
      double rise = settings_.sample_area * settings_.coverage->rise()[i], before = 0;
      for (std::size_t t = batch.first_face[i]; t < batch.first_face[i + 1]; ++t) {
        const std::uint32_t f = batch.face[t];
        before += squares(mesh.corners(f), state_.face_near[f]);
        rise += squares(patch_corners(mesh, batch, t), state_.face_near[f]);
      }
      if (!(rise < (1 - least_gain) * before)) batch.verdict[i] = Verdict::uncovers_input;
    });
  }

  void drop_if_short(Step& step) const {
    if (!(step.move.norm() >= settings_.shortest)) step.move = Vec3::Zero();
  }

  std::vector<Position> places(const std::vector<Candidate>& selected) const {
    std::vector<Position> points;
    for (const Candidate& candidate : selected) {
      const std::uint32_t v = state_.mesh.origin(candidate.halfedge);
      const Vec3 p = state_.mesh.vec_at(v) + steps_[v].move;
      points.push_back(settings_.float_positions ? round_to_floats(p) : position(p));
    }
    return points;
  }

  void test(PatchBatch& batch) const {
    test_patches_locally(state_, batch, settings_.limits.sides);
    settings_.coverage->test(state_, settings_.limits.centroids, batch);
    reject_without_gain(batch);
    test_patches_against_band(state_, band_, settings_.limits, batch);
    reject_collisions(state_, device_, settings_.limits.sides, batch);
    if (settings_.side_test != nullptr) settings_.side_test->reject_wrong_sides(state_, settings_.limits, batch);
  }

  CageState& state_;
  const RefitSettings& settings_;
  const UnitFrame& frame_;
  const TreeDevice& device_;
  DistanceBand& band_;
  std::vector<Step> steps_;  // of each vertex
};

}  // namespace

std::size_t refit(CageState& state, const RefitSettings& settings, const UnitFrame& frame, const TreeDevice& device,
                  DistanceBand& band, const Control* control) {
  Refit refitting(state, settings, frame, device, band);
  std::size_t moved = 0;
  for (int pass = 0; pass < settings.passes; ++pass) {
    const std::size_t before = moved;
    refitting.plan();
    for (std::uint64_t round = 0; refitting.move_some(round, moved); ++round)
      if (control != nullptr && control->stopped()) return moved;
    if (moved == before) break;
  }
  return moved;
}

}  // namespace prcage
