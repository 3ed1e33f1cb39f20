#include "parallel/tighten.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/angles.h"
#include "core/counter_random.h"
#include "parallel/commit.h"
#include "parallel/conflicts.h"
#include "parallel/flips.h"
#include "parallel/misfit.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

// A move that fails is tried again at half the length so many times.
constexpr int most_halvings = 4;
// What a move may do to a face: turn it by 45 degrees, and leave this share of its area.
constexpr double least_cosine = 0.7;
constexpr double least_area = 0.3;
// Every pass but the first tilts the directions at random, by up to the angle of this tangent: vertices that are
// blocked on the straight way in slide past what blocks them.
constexpr double largest_tilt = 8;
// Edges are flipped for a better fit before every pass of moves for it that this divides.
constexpr int fitting_passes_per_flips = 5;
// Angles in degrees: edges are flipped, and vertices slide, for the sake of faces that are narrower than this. Vertices
// do if that is a gain of so many times at least. The polish leaves no faces narrower that are not so already.
constexpr double wide_enough_for_flips = 15;
constexpr double wide_enough = 20;
constexpr double least_widening = 1.05;

// What is planned for a vertex.
struct Move {
  Vec3 direction = Vec3::Zero();  // unit vector inward
  double length = 0;              // zero: done
  int halvings = 0;
};

Vec3 scaled_normal(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a); }

Vec3 tilted(const Vec3& direction, const CounterRandom& random, std::uint64_t v) {
  const auto uniform = [&](std::uint64_t k) { return random.uniform(4 * v + k); };
  const Vec3 any(uniform(0) - 0.5, uniform(1) - 0.5, uniform(2) - 0.5);
  const Vec3 across = any - any.dot(direction) * direction;
  const double length = across.norm();
  return length > 0 ? (direction + largest_tilt * uniform(3) / length * across).normalized() : direction;
}

// Against the mean normal of the star, that is down the gradient of the volume, or the other way, or tilted from there,
// by as much as the star is away from the input at most.
Move first_move(const CageState& state, const DistanceBand& band, std::uint32_t v, bool outward,
                const CounterRandom* tilt) {
  const CornerTable& mesh = state.mesh;
  if (mesh.vertex_halfedge[v] == none) return {};
  Vec3 sum = Vec3::Zero();
  float farthest = 0;
  for_each_outgoing(mesh, v, [&](std::uint32_t h) {
    sum += scaled_normal(mesh.vec_at(v), mesh.vec_at(mesh.target(h)), mesh.vec_at(mesh.apex(h)));
    farthest = std::max(farthest, state.face_distance[h / 3]);
  });
  const double length = sum.norm();
  if (!(length > 0)) return {};
  const double own = band.nearest(mesh.vec_at(v), state.face_near[mesh.vertex_halfedge[v] / 3]).distance;
  const Vec3 way = (outward ? sum : -sum) / length;
  return {tilt == nullptr ? way : tilted(way, *tilt, v), std::max<double>(own, farthest), 0};
}

// Do the faces keep their shape and their side?
bool keeps_faces(const CornerTable& mesh, std::uint32_t v, const Vec3& p) {
  bool keeps = true;
  for_each_outgoing(mesh, v, [&](std::uint32_t h) {
    const Vec3 b = mesh.vec_at(mesh.target(h)), c = mesh.vec_at(mesh.apex(h));
    const Vec3 before = scaled_normal(mesh.vec_at(v), b, c), after = scaled_normal(p, b, c);
    keeps = keeps && before.dot(after) >= least_cosine * before.norm() * after.norm() &&
            after.norm() >= least_area * before.norm();
  });
  return keeps;
}

// Along the surface towards where the narrowest faces of the star would be equilateral.
Move widening_move(const CornerTable& mesh, std::uint32_t v) {
  if (mesh.vertex_halfedge[v] == none) return {};
  const Vec3 at = mesh.vec_at(v);
  Vec3 normal = Vec3::Zero(), goal = Vec3::Zero();
  double narrowest = 180, weights = 0;
  for_each_outgoing(mesh, v, [&](std::uint32_t h) {
    const Vec3 b = mesh.vec_at(mesh.target(h)), c = mesh.vec_at(mesh.apex(h));
    normal += scaled_normal(at, b, c);
    const double angle = least_angle(at, b, c);
    narrowest = std::min(narrowest, angle);
    const Vec3 middle = 0.5 * (b + c), edge = c - b,
               up = (at - middle) - (at - middle).dot(edge) / edge.squaredNorm() * edge;
    const double height = up.norm();
    if (!(height > 0)) return;
    const double weight = 1 / (angle * angle);
    goal += weight * (middle + 0.5 * std::numbers::sqrt3 * edge.norm() / height * up);
    weights += weight;
  });
  if (!(weights > 0) || narrowest > wide_enough) return {};
  const Vec3 way = goal / weights - at;
  const Vec3 along = way - way.dot(normal) / normal.squaredNorm() * normal;
  const double length = along.norm();
  if (!(length > 0)) return {};
  return {along / length, 0.5 * length, 0};
}

// The smallest angle of the star of v, with v at p.
double narrowest_angle(const CornerTable& mesh, std::uint32_t v, const Vec3& p) {
  double narrowest = 180;
  for_each_outgoing(mesh, v, [&](std::uint32_t h) {
    narrowest = std::min(narrowest, least_angle(p, mesh.vec_at(mesh.target(h)), mesh.vec_at(mesh.apex(h))));
  });
  return narrowest;
}

// Is the narrowest face wider, and the volume no larger?
bool widens(const CornerTable& mesh, std::uint32_t v, const Vec3& p) {
  const Vec3 a = mesh.vec_at(v);
  double volume = 0;
  for_each_outgoing(mesh, v, [&](std::uint32_t h) {
    volume += (p - a).dot(scaled_normal(a, mesh.vec_at(mesh.target(h)), mesh.vec_at(mesh.apex(h))));
  });
  return volume <= 0 && narrowest_angle(mesh, v, p) > least_widening * narrowest_angle(mesh, v, a);
}

// Is no face narrower than those that are so already, or else wide enough?
bool keeps_wide(const CornerTable& mesh, std::uint32_t v, const Vec3& p) {
  return narrowest_angle(mesh, v, p) >= std::min(narrowest_angle(mesh, v, mesh.vec_at(v)), wide_enough_for_flips);
}

// Of all faces of a patch and of those that they replace: by how much is there more of it?
double misfit_rise(const CageState& state, const DistanceBand& band, double unit, const PatchBatch& batch,
                   std::size_t i) {
  const CornerTable& mesh = state.mesh;
  double sum = 0;
  for (const std::uint32_t f : batch.removed_faces(i)) sum -= misfit(band, mesh.corners(f), state.face_near[f], unit);
  for (std::size_t t = batch.first_face[i]; t < batch.first_face[i + 1]; ++t)
    sum += misfit(band, patch_corners(mesh, batch, t), batch.near[t].face, unit);
  return sum;
}

enum class MoveKind { inward, tilted, fitting, widening };

class Tightening {
 public:
  Tightening(CageState& state, const TightenSettings& settings, const Obstacle& obstacle, const UnitFrame& frame,
             const TreeDevice& device, DistanceBand& band, const Control* control, Counts& counts)
      : state_(state),
        settings_(settings),
        obstacle_(obstacle),
        frame_(frame),
        device_(device),
        band_(band),
        control_(control),
        counts_(counts),
        moves_(state.mesh.vertex_slots()) {}

  void run() {
    for (int pass = 0; pass < settings_.passes; ++pass) {
      move(pass == 0 ? MoveKind::inward : MoveKind::tilted, pass);
      flip(FlipGoal::volume);
      flip(FlipGoal::angle);
    }
    for (int pass = 0; pass < settings_.fitting_passes; ++pass) {
      if (pass % fitting_passes_per_flips == 0) flip(FlipGoal::fit);
      move(MoveKind::fitting, settings_.passes + pass);
    }
    move(MoveKind::widening, 0);
  }

 private:
  bool stopped() const { return control_ != nullptr && control_->stopped(); }

  void flip(FlipGoal goal) {
    if (!settings_.flips) return;
    FlipSettings flips{settings_.limits, settings_.seed, settings_.coverage,   &obstacle_,
                       nullptr,          goal,           wide_enough_for_flips};
    flips.misfit_unit = settings_.misfit_unit;
    flip_edges(state_, flips, frame_, device_, band_, control_, counts_);
  }

  // Rounds until no vertex has a move left.
  void move(MoveKind kind, int pass) {
    const CornerTable& mesh = state_.mesh;
    const CounterRandom tilt(settings_.seed, static_cast<std::uint64_t>(pass));
    const bool outward = kind == MoveKind::fitting && pass % 2 != 0;
    parallel_each(moves_.size(), 16, [&](std::size_t i) {
      const auto v = static_cast<std::uint32_t>(i);
      moves_[i] = kind == MoveKind::widening
                      ? widening_move(mesh, v)
                      : first_move(state_, band_, v, outward, kind == MoveKind::inward ? nullptr : &tilt);
    });
    for (std::uint64_t round = 0; !stopped(); ++round) {
      parallel_each(moves_.size(), 256, [&](std::size_t i) { shorten(kind, static_cast<std::uint32_t>(i)); });
      const auto wanted = [&](std::uint32_t v) { return moves_[v].length > 0; };
      const std::vector<Candidate> selected = select_independent_vertices(mesh, settings_.seed + round, wanted);
      if (selected.empty()) break;
      try_moves(kind, selected);
    }
  }

  // Shortens a move until the faces keep their shape, or become wider if they are to.
  void shorten(MoveKind kind, std::uint32_t v) {
    const CornerTable& mesh = state_.mesh;
    Move& move = moves_[v];
    const auto good = [&](const Vec3& p) {
      if (!keeps_faces(mesh, v, p)) return false;
      return kind == MoveKind::widening ? widens(mesh, v, p) : kind != MoveKind::fitting || keeps_wide(mesh, v, p);
    };
    while (move.length > 0 && !good(mesh.vec_at(v) + move.length * move.direction))
      move.length = ++move.halvings > most_halvings ? 0 : 0.5 * move.length;
    if (move.length < settings_.shortest) move.length = 0;
  }

  void try_moves(MoveKind kind, const std::vector<Candidate>& selected) {
    const CornerTable& mesh = state_.mesh;
    std::vector<Position> points(selected.size());
    for (std::size_t i = 0; i < selected.size(); ++i) {
      const std::uint32_t v = mesh.origin(selected[i].halfedge);
      const Vec3 p = mesh.vec_at(v) + moves_[v].length * moves_[v].direction;
      points[i] = settings_.float_positions ? round_to_floats(p) : position(p);
    }
    PatchBatch batch = build_moves(state_, frame_, selected, std::move(points));
    test_patches_locally(state_, batch);
    obstacle_.reject_hits(state_, batch);
    obstacle_.reject_sweeps(state_, batch);
    reject_hits_on_cage(state_, device_, batch);
    reject_conflicts(state_, device_, batch);
    test_patches_against_band(state_, band_, settings_.limits, batch);
    if (settings_.coverage != nullptr) settings_.coverage->test(state_, settings_.limits.centroids, batch);
    if (kind == MoveKind::fitting) reject_worse_fits(batch);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      Move& move = moves_[batch.moved[i]];
      if (batch.verdict[i] == Verdict::conflict) continue;  // another one goes first
      const bool give_up = batch.alive(i) || ++move.halvings > most_halvings;
      move.length = give_up ? 0 : 0.5 * move.length;
    }
    commit_moves(state_, batch);
    if (settings_.coverage != nullptr) settings_.coverage->commit(batch);
    counts_.tightened += batch.count(Verdict::accepted);
  }

  void reject_worse_fits(PatchBatch& batch) const {
    const double unit = settings_.misfit_unit;
    parallel_each(batch.size(), 1, [&](std::size_t i) {
      if (!batch.alive(i)) return;
      double rise = misfit_rise(state_, band_, unit, batch, i);
      if (settings_.coverage != nullptr)
        rise += misfit_of_samples(settings_.coverage->rise()[i], settings_.sample_area, unit);
      if (rise > 0) batch.verdict[i] = Verdict::fits_worse;
    });
  }

  CageState& state_;
  const TightenSettings& settings_;
  const Obstacle& obstacle_;
  const UnitFrame& frame_;
  const TreeDevice& device_;
  DistanceBand& band_;
  const Control* control_;
  Counts& counts_;
  std::vector<Move> moves_;
};

}  // namespace

void tighten(CageState& state, const TightenSettings& settings, const Obstacle& obstacle, const UnitFrame& frame,
             const TreeDevice& device, DistanceBand& band, const Control* control, Counts& counts) {
  Tightening(state, settings, obstacle, frame, device, band, control, counts).run();
}

}  // namespace prcage
