#include "parallel/tighten.h"

#include <algorithm>
#include <cmath>

#include "core/counter_random.h"
#include "parallel/commit.h"
#include "parallel/conflicts.h"
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

// Against the mean normal of the star, that is down the gradient of the volume, or tilted from there, by as much as the
// star is away from the input at most.
Move first_move(const CageState& state, const DistanceBand& band, std::uint32_t v, const CounterRandom* tilt) {
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
  const Vec3 inward = -sum / length;
  return {tilt == nullptr ? inward : tilted(inward, *tilt, v), std::max<double>(own, farthest), 0};
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

// Shortens a move until the faces keep their shape.
void shorten(const CornerTable& mesh, std::uint32_t v, double shortest, Move& move) {
  while (move.length > 0 && !keeps_faces(mesh, v, mesh.vec_at(v) + move.length * move.direction)) {
    move.length = ++move.halvings > most_halvings ? 0 : 0.5 * move.length;
  }
  if (move.length < shortest) move.length = 0;
}

// Vertices that have a move, none of them next to another.
std::vector<Candidate> select_independent_moves(const CornerTable& mesh, const std::vector<Move>& moves,
                                                std::uint64_t seed) {
  const auto key = [&](std::uint32_t v) { return candidate_key(0, v, seed); };
  return parallel_gather<Candidate>(moves.size(), 1u << 12, [&](std::size_t begin, std::size_t end, auto& list) {
    for (auto v = static_cast<std::uint32_t>(begin); v < end; ++v) {
      if (!(moves[v].length > 0)) continue;
      bool least = true;
      for_each_outgoing(mesh, v, [&](std::uint32_t h) {
        const std::uint32_t w = mesh.target(h);
        least = least && (!(moves[w].length > 0) || key(v) < key(w));
      });
      if (least) list.push_back({key(v), mesh.vertex_halfedge[v]});
    }
  });
}

}  // namespace

std::size_t tighten(CageState& state, const TightenSettings& settings, const Obstacle& obstacle, const UnitFrame& frame,
                    const TreeDevice& device, DistanceBand& band, const Control* control) {
  const CornerTable& mesh = state.mesh;
  std::size_t moved = 0;
  std::vector<Move> moves(mesh.vertex_slots());
  for (int pass = 0; pass < settings.passes; ++pass) {
    const CounterRandom tilt(settings.seed, static_cast<std::uint64_t>(pass));
    parallel_each(moves.size(), 16, [&](std::size_t v) {
      moves[v] = first_move(state, band, static_cast<std::uint32_t>(v), pass == 0 ? nullptr : &tilt);
    });
    for (std::uint64_t round = 0;; ++round) {
      if (control != nullptr && control->stopped()) return moved;
      parallel_each(moves.size(), 256, [&](std::size_t v) {
        if (moves[v].length > 0) shorten(mesh, static_cast<std::uint32_t>(v), settings.shortest, moves[v]);
      });
      const std::vector<Candidate> selected = select_independent_moves(mesh, moves, settings.seed + round);
      if (selected.empty()) break;
      std::vector<Position> points(selected.size());
      for (std::size_t i = 0; i < selected.size(); ++i) {
        const std::uint32_t v = mesh.origin(selected[i].halfedge);
        points[i] = settings.float_positions ? round_to_floats(mesh.vec_at(v) + moves[v].length * moves[v].direction)
                                             : position(mesh.vec_at(v) + moves[v].length * moves[v].direction);
      }
      PatchBatch batch = build_moves(state, frame, selected, std::move(points));
      test_patches_locally(state, batch);
      obstacle.reject_hits(state, batch);
      obstacle.reject_sweeps(state, batch);
      reject_hits_on_cage(state, device, batch);
      reject_conflicts(state, device, batch);
      test_patches_against_band(state, band, settings.limits, batch);
      if (settings.coverage != nullptr) settings.coverage->test(state, settings.limits.centroids, batch);
      for (std::size_t i = 0; i < batch.size(); ++i) {
        Move& move = moves[batch.moved[i]];
        if (batch.verdict[i] == Verdict::conflict) continue;  // another one goes first
        const bool give_up = batch.alive(i) || ++move.halvings > most_halvings;
        move.length = give_up ? 0 : 0.5 * move.length;
      }
      commit_moves(state, batch);
      if (settings.coverage != nullptr) settings.coverage->commit(batch);
      moved += batch.count(Verdict::accepted);
    }
  }
  return moved;
}

}  // namespace prcage
