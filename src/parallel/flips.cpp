#include "parallel/flips.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/predicates.h"
#include "parallel/commit.h"
#include "parallel/conflicts.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

// Rounds end by themselves, since every flip raises an angle; this bounds the slow tail.
constexpr int max_rounds = 64;
constexpr double smallest_gain = 1e-6;  // radians
// Cosine of the angle that a new face may turn against the old ones: flips across sharp features are no polish.
constexpr double smallest_normal_cosine = 0.2;
constexpr float no_gain = std::numeric_limits<float>::infinity();

double min_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto cosine = [](const Vec3& u, const Vec3& v) {
    const double norms = std::sqrt(u.squaredNorm() * v.squaredNorm());
    return norms > 0 ? u.dot(v) / norms : 1.0;
  };
  const double largest = std::max({cosine(b - a, c - a), cosine(a - b, c - b), cosine(a - c, b - c)});
  return std::acos(std::clamp(largest, -1.0, 1.0));
}

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

// How much the smallest angle would rise; not positive if the flip is not allowed.
double flip_gain(const CornerTable& mesh, Sides sides, std::uint32_t h) {
  const std::uint32_t va = mesh.origin(h), vb = mesh.target(h), vc = mesh.apex(h), vd = mesh.apex(mesh.twin[h]);
  const Vec3 a = mesh.vec_at(va), b = mesh.vec_at(vb), c = mesh.vec_at(vc), d = mesh.vec_at(vd);
  const double before = std::min(min_angle(a, b, c), min_angle(b, a, d));
  const double gain = std::min(min_angle(d, c, a), min_angle(c, d, b)) - before;
  if (gain <= smallest_gain) return 0;
  const Vec3 old1 = unit_normal(a, b, c), old2 = unit_normal(b, a, d);
  const Vec3 new1 = unit_normal(d, c, a), new2 = unit_normal(c, d, b);
  const double turn = std::min({new1.dot(old1), new1.dot(old2), new2.dot(old1), new2.dot(old2)});
  if (turn < smallest_normal_cosine) return 0;
  if (mesh.valence(va, 4) <= 3 || mesh.valence(vb, 4) <= 3 || joined(mesh, vc, vd)) return 0;
  return sides == Sides::both || exact::orient3d(a.data(), b.data(), c.data(), d.data()) >= 0 ? gain : 0;
}

// Flips worth trying, the largest gain with the lowest key. Blocked edges failed an exact test in this stage already.
std::vector<Candidate> find_flips(const CornerTable& mesh, const std::vector<std::uint8_t>& blocked,
                                  const FlipSettings& settings) {
  return parallel_gather<Candidate>(mesh.corner_vertex.size(), 1u << 12,
                                    [&](std::size_t begin, std::size_t end, auto& list) {
                                      for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
                                        if (!represents_edge(mesh, h) || blocked[h]) continue;
                                        const double gain = flip_gain(mesh, settings.limits.sides, h);
                                        if (gain <= 0) continue;
                                        const auto rank = static_cast<float>(std::numbers::pi - gain);
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

void block_rejected(const CornerTable& mesh, const PatchBatch& batch, std::vector<std::uint8_t>& blocked) {
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (batch.alive(i) || batch.verdict[i] == Verdict::conflict) continue;
    const std::uint32_t h = batch.candidate[i].halfedge;
    blocked[h] = blocked[mesh.twin[h]] = 1;
  }
}

}  // namespace

void flip_edges(CageState& state, const FlipSettings& settings, const UnitFrame& frame, const TreeDevice& device,
                DistanceBand& band, Control* control, Counts& counts) {
  std::vector<std::uint8_t> blocked(state.mesh.corner_vertex.size(), 0);
  for (int round = 0; round < max_rounds; ++round) {
    if (control != nullptr && control->stopped()) return;
    const std::vector<Candidate> selected =
        select_independent_flips(state.mesh, find_flips(state.mesh, blocked, settings));
    if (selected.empty()) return;
    PatchBatch batch = build_flips(state, frame, selected);
    test_patches_locally(state, batch, settings.limits.sides);
    test_patches_against_band(state, band, settings.limits, batch);
    test_flips_at_samples(state, band, settings.limits.centroids, batch);
    if (settings.obstacle != nullptr) settings.obstacle->reject_sweeps(state, batch);
    if (state.components > 1) reject_sweeps_of_components(state, device, batch);
    reject_hits_on_cage(state, device, batch);
    reject_conflicts(state, device, batch);
    if (settings.coverage != nullptr) settings.coverage->test(state, settings.limits.centroids, batch);
    if (settings.side_test != nullptr) settings.side_test->reject_wrong_sides(state, settings.limits, batch);
    block_rejected(state.mesh, batch, blocked);
    commit_flips(state, batch);
    if (settings.coverage != nullptr) settings.coverage->commit(batch);
    counts.flips_tried += batch.size();
    counts.flips += batch.count(Verdict::accepted);
  }
}

}  // namespace prcage
