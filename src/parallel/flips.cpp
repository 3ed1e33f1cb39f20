#include "parallel/flips.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/angles.h"
#include "core/predicates.h"
#include "parallel/commit.h"
#include "parallel/conflicts.h"
#include "parallel/misfit.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

// Rounds end by themselves, since every flip raises an angle; this bounds the slow tail.
constexpr int max_rounds = 64;
constexpr double smallest_gain = 1e-4;  // degrees
// Cosine of the angle that a new face may turn against the old ones: flips across sharp features are no polish.
constexpr double smallest_normal_cosine = 0.2;
// Flips that take volume away take so much of the thickness of the cycle at least, as the height of one corner above
// the opposite face.
constexpr double smallest_height = 0.002;
// Degrees: what flips for a better fit gain, in the mean over their quadrilateral.
constexpr double smallest_fit = 0.1;
// The gain that flips are ranked by, at most.
constexpr double largest_gain = 180;

Vec3 unit_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const double length = n.norm();
  return length > 0 ? Vec3(n / length) : Vec3::Zero();
}

bool joined(const CornerTable& mesh, std::uint32_t u, std::uint32_t v) {
  bool found = false;
  for_each_outgoing(mesh, u, [&](std::uint32_t h) { found = found || mesh.target(h) == v; });
  return found;
}

// The two faces of an edge from a to b, with apexes c and d, and those that a flip would make of them.
struct Quadrilateral {
  Quadrilateral(const CornerTable& mesh, std::uint32_t h)
      : va(mesh.origin(h)),
        vb(mesh.target(h)),
        vc(mesh.apex(h)),
        vd(mesh.apex(mesh.twin[h])),
        a(mesh.vec_at(va)),
        b(mesh.vec_at(vb)),
        c(mesh.vec_at(vc)),
        d(mesh.vec_at(vd)) {}

  double angle_before() const { return std::min(least_angle(a, b, c), least_angle(b, a, d)); }
  double angle_after() const { return std::min(least_angle(d, c, a), least_angle(c, d, b)); }

  // How far d is below the plane of abc, times twice the area of the larger face: what a flip takes away.
  double depth() const {
    const Vec3 n = (b - a).cross(c - a);
    const double area = std::max(n.norm(), (a - b).cross(d - b).norm());
    return area > 0 ? n.dot(a - d) / area : 0;
  }

  double area() const { return 0.5 * ((b - a).cross(c - a).norm() + (a - b).cross(d - b).norm()); }

  bool keeps_direction() const {
    const Vec3 old1 = unit_normal(a, b, c), old2 = unit_normal(b, a, d);
    const Vec3 new1 = unit_normal(d, c, a), new2 = unit_normal(c, d, b);
    return std::min({new1.dot(old1), new1.dot(old2), new2.dot(old1), new2.dot(old2)}) >= smallest_normal_cosine;
  }

  bool keeps_manifold(const CornerTable& mesh) const {
    return mesh.valence(va, 4) > 3 && mesh.valence(vb, 4) > 3 && !joined(mesh, vc, vd);
  }

  std::uint32_t va, vb, vc, vd;
  Vec3 a, b, c, d;
};

// What is won by a flip, in degrees; not positive if it is not allowed.
double angle_gain(const CornerTable& mesh, const FlipSettings& settings, const Quadrilateral& q) {
  const double before = q.angle_before(), gain = q.angle_after() - before;
  if (before >= settings.wide_enough || gain <= smallest_gain) return 0;
  if (!q.keeps_direction() || !q.keeps_manifold(mesh)) return 0;
  const bool anywhere = settings.limits.sides == Sides::both;
  return anywhere || exact::orient3d(q.a.data(), q.b.data(), q.c.data(), q.d.data()) >= 0 ? gain : 0;
}

// The same in shares of the thickness.
double volume_gain(const CornerTable& mesh, const FlipSettings& settings, const Quadrilateral& q) {
  const double depth = q.depth() / settings.limits.centroids;
  if (!(depth > smallest_height) || q.angle_after() < std::min(q.angle_before(), settings.wide_enough)) return 0;
  return q.keeps_direction() && q.keeps_manifold(mesh) ? std::min(depth, largest_gain) : 0;
}

// The same in degrees of misfit, in the mean.
double fit_gain(const CageState& state, const FlipSettings& settings, const DistanceBand& band, std::uint32_t h,
                const Quadrilateral& q) {
  const CornerTable& mesh = state.mesh;
  if (q.angle_after() < std::min(q.angle_before(), settings.wide_enough)) return 0;
  if (!q.keeps_direction() || !q.keeps_manifold(mesh)) return 0;
  const auto misfit_of = [&](const Vec3& a, const Vec3& b, const Vec3& c, std::uint32_t f) {
    return misfit(band, {a, b, c}, state.face_near[f], settings.misfit_unit);
  };
  const std::uint32_t f = h / 3, g = mesh.twin[h] / 3;
  const double gain = misfit_of(q.a, q.b, q.c, f) + misfit_of(q.b, q.a, q.d, g) - misfit_of(q.d, q.c, q.a, f) -
                      misfit_of(q.c, q.d, q.b, g);
  const double mean = gain / q.area() * 180 / std::numbers::pi;
  return mean > smallest_fit ? std::min(mean, largest_gain) : 0;
}

double flip_gain(const CageState& state, const FlipSettings& settings, const DistanceBand& band, std::uint32_t h) {
  const Quadrilateral q(state.mesh, h);
  switch (settings.goal) {
    case FlipGoal::angle:
      return angle_gain(state.mesh, settings, q);
    case FlipGoal::volume:
      return volume_gain(state.mesh, settings, q);
    case FlipGoal::fit:
      return fit_gain(state, settings, band, h, q);
  }
  return 0;
}

// Flips worth trying, the largest gain with the lowest key. Blocked edges failed an exact test in this stage already.
std::vector<Candidate> find_flips(const CageState& state, const std::vector<std::uint8_t>& blocked,
                                  const FlipSettings& settings, const DistanceBand& band) {
  const CornerTable& mesh = state.mesh;
  const std::size_t grain = settings.goal == FlipGoal::fit ? 32 : 1u << 12;  // queries take their time
  return parallel_gather<Candidate>(mesh.corner_vertex.size(), grain,
                                    [&](std::size_t begin, std::size_t end, auto& list) {
                                      for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
                                        if (!represents_edge(mesh, h) || blocked[h]) continue;
                                        const double gain = flip_gain(state, settings, band, h);
                                        if (gain <= 0) continue;
                                        const auto rank = static_cast<float>(largest_gain - gain);
                                        list.push_back({candidate_key(rank, h, settings.seed), h});
                                      }
                                    });
}

// The paper's test of the band for flips: at the middle of the new edge and at the new centroids.
void test_flips_at_samples(const CageState& state, DistanceBand& band, double tau, PatchBatch& batch) {
  parallel_each(batch.size(), default_grain, [&](std::size_t i) {
    if (!batch.alive(i)) return;
    const std::size_t t = batch.first_face[i];
    const Triangle& v = batch.triangle[t];  // its first two corners are the new edge
    const Vec3 middle = 0.5 * (state.mesh.vec_at(v[0]) + state.mesh.vec_at(v[1]));
    const double farthest =
        std::max({band.near(middle).distance, std::abs(batch.near[t].distance), std::abs(batch.near[t + 1].distance)});
    if (farthest > tau) batch.verdict[i] = Verdict::beyond_tau;
  });
  band.absorb();
}

// A cage keeps outside of the input; a surface that may cut into it would be worn down by flips for the sake of angles.
void test_coverage(const CageState& state, const FlipSettings& settings, PatchBatch& batch) {
  settings.coverage->test(state, settings.limits.centroids, batch);
  if (settings.limits.sides == Sides::outer) return;
  for (std::size_t i = 0; i < batch.size(); ++i)
    if (batch.alive(i) && settings.coverage->rise()[i] > 0) batch.verdict[i] = Verdict::uncovers_input;
}

void block_rejected(const CornerTable& mesh, const PatchBatch& batch, std::vector<std::uint8_t>& blocked) {
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (batch.alive(i) || batch.verdict[i] == Verdict::conflict) continue;
    const std::uint32_t h = batch.candidate[i].halfedge;
    blocked[h] = blocked[mesh.twin[h]] = 1;
  }
}

}  // namespace

void flip_edges(CageState& state, const FlipSettings& settings, const UnitFrame& frame, const TreeDevice& device,
                DistanceBand& band, const Control* control, Counts& counts) {
  std::vector<std::uint8_t> blocked(state.mesh.corner_vertex.size(), 0);
  for (int round = 0; round < max_rounds; ++round) {
    if (control != nullptr && control->stopped()) return;
    const std::vector<Candidate> selected =
        select_independent_flips(state.mesh, find_flips(state, blocked, settings, band));
    if (selected.empty()) return;
    PatchBatch batch = build_flips(state, frame, selected);
    const bool inward = settings.goal != FlipGoal::angle;
    test_patches_locally(state, batch, settings.limits.sides, inward);
    test_patches_against_band(state, band, settings.limits, batch);
    test_flips_at_samples(state, band, settings.limits.centroids, batch);
    if (inward) settings.obstacle->reject_hits(state, batch);
    if (settings.obstacle != nullptr) settings.obstacle->reject_sweeps(state, batch);
    reject_collisions(state, device, settings.limits.sides, batch);
    if (settings.coverage != nullptr) test_coverage(state, settings, batch);
    if (settings.side_test != nullptr) settings.side_test->reject_wrong_sides(state, settings.limits, batch);
    block_rejected(state.mesh, batch, blocked);
    commit_flips(state, batch);
    if (settings.room != nullptr) settings.room->measure(batch, state);
    if (settings.coverage != nullptr) settings.coverage->commit(batch);
    counts.flips_tried += batch.size();
    counts.flips += batch.count(Verdict::accepted);
  }
}

}  // namespace prcage
