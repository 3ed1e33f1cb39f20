#include "parallel/patches.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <limits>

#include "core/predicates.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

constexpr std::size_t patch_grain = 16;
// Share of tau below which a distance is near enough to the true one: eq. 4 loses at most this share of its room.
constexpr double near_enough = 0.1;

// Offsets of consecutive runs of the given lengths, one more than there are runs.
template <class Length>
std::vector<std::uint32_t> offsets(std::size_t n, const Length& length) {
  std::vector<std::uint32_t> first(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i) first[i + 1] = first[i] + length(i);
  return first;
}

PatchBatch empty_patches(const std::vector<Candidate>& selected) {
  PatchBatch batch;
  batch.candidate = selected;
  batch.moved.assign(selected.size(), none);
  batch.point.resize(selected.size());
  batch.verdict.assign(selected.size(), Verdict::accepted);
  return batch;
}

void allocate_faces(PatchBatch& batch) {
  batch.removed.resize(batch.first_removed.back());
  const std::size_t triangles = batch.first_face.back();
  batch.face.resize(triangles);
  batch.triangle.resize(triangles);
  batch.patch_of.resize(triangles);
  batch.near.resize(triangles);
}

void place_collapses(const CageState& state, const PlacementSettings& settings, PatchBatch& batch) {
  tbb::enumerable_thread_specific<PlacementBatch> scratch;
  parallel_chunks(batch.size(), patch_grain, [&](std::size_t begin, std::size_t end) {
    PlacementBatch& problems = scratch.local();
    problems.clear();
    for (std::size_t i = begin; i < end; ++i)
      gather_placement(state.mesh, state.face_distance, batch.candidate[i].halfedge, settings, problems);
    solve_placements(settings, problems);
    std::copy(problems.solution.begin(), problems.solution.end(),
              batch.point.begin() + static_cast<std::ptrdiff_t>(begin));
  });
}

// The star of an edge: the two faces that die first, then those around the origin, then those around the target.
void list_collapse(const CornerTable& mesh, PatchBatch& batch, std::size_t i) {
  const std::uint32_t h = batch.candidate[i].halfedge;
  const std::uint32_t t = mesh.twin[h];
  const std::uint32_t a = mesh.origin(h);
  std::uint32_t* removed = &batch.removed[batch.first_removed[i]];
  std::size_t next = batch.first_face[i];
  *removed++ = h / 3;
  *removed++ = t / 3;
  for (const std::uint32_t v : {a, mesh.target(h)}) {
    for_each_outgoing(mesh, v, [&](std::uint32_t g) {
      const std::uint32_t f = g / 3;
      if (f == h / 3 || f == t / 3) return;
      *removed++ = f;
      // Rotated as stored, so that the triangle is the face's after the collapse.
      const std::uint32_t* old = &mesh.corner_vertex[3 * std::size_t{f}];
      batch.triangle[next] = {old[0] == v ? a : old[0], old[1] == v ? a : old[1], old[2] == v ? a : old[2]};
      batch.face[next] = f;
      batch.patch_of[next] = static_cast<std::uint32_t>(i);
      ++next;
    });
  }
}

void list_flip(const CornerTable& mesh, PatchBatch& batch, std::size_t i) {
  const std::uint32_t h = batch.candidate[i].halfedge;
  const std::uint32_t t = mesh.twin[h];
  const std::uint32_t c = mesh.apex(h), d = mesh.apex(t);
  const std::size_t r = batch.first_removed[i];
  const std::size_t n = batch.first_face[i];
  batch.removed[r] = batch.face[n] = h / 3;
  batch.removed[r + 1] = batch.face[n + 1] = t / 3;
  batch.triangle[n] = {d, c, mesh.origin(h)};
  batch.triangle[n + 1] = {c, d, mesh.target(h)};
  batch.patch_of[n] = batch.patch_of[n + 1] = static_cast<std::uint32_t>(i);
}

// Sign test of the swept tetrahedra: none is negative.
bool sweeps_outward(const CornerTable& mesh, const PatchBatch& batch, std::size_t i) {
  const auto faces = batch.removed_faces(i);
  if (batch.moved[i] == none) {  // flip: the far corner of the second face against the first face
    const std::uint32_t h = batch.candidate[i].halfedge;
    return exact::orient3d(mesh.point(mesh.origin(h)), mesh.point(mesh.target(h)), mesh.point(mesh.apex(h)),
                           mesh.point(mesh.apex(mesh.twin[h]))) >= 0;
  }
  return std::all_of(faces.begin(), faces.end(), [&](std::uint32_t f) {
    const std::uint32_t* v = &mesh.corner_vertex[3 * std::size_t{f}];
    return exact::orient3d(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), batch.point[i].data()) >= 0;
  });
}

bool proper_patch(const CornerTable& mesh, const PatchBatch& batch, std::size_t i) {
  const std::size_t first = batch.first_face[i];
  const std::size_t last = batch.first_face[i + 1];
  for (std::size_t t = first; t < last; ++t) {
    const TriangleRef triangle = patch_triangle(mesh, batch, t);
    if (exact::collinear(triangle.p[0], triangle.p[1], triangle.p[2])) return false;
    for (std::size_t s = first; s < t; ++s)
      if (improper_contact(triangle, patch_triangle(mesh, batch, s))) return false;
  }
  return true;
}

Vec3 corner(const TriangleRef& t, int i) { return {t.p[i][0], t.p[i][1], t.p[i][2]}; }

// The input face nearest to x among those known for the faces that new face t replaces: itself and the faces next to it
// in the star, and the two that die.
DistanceBand::Near near_by_star(const CageState& state, const DistanceBand& band, const PatchBatch& batch,
                                std::size_t t, const Vec3& x) {
  const auto removed = batch.removed_faces(batch.patch_of[t]);
  const auto own = static_cast<std::size_t>(std::find(removed.begin(), removed.end(), batch.face[t]) - removed.begin());
  DistanceBand::Near best{none, std::numeric_limits<double>::infinity()};
  std::uint32_t last = none;
  for (const std::size_t i : {own, own - 1, own + 1, std::size_t{0}, std::size_t{1}}) {
    if (i >= removed.size()) continue;
    const std::uint32_t face = state.face_near[removed[i]];
    if (face == last || face == best.face) continue;
    last = face;
    if (const double d = band.distance_to_face(x, face); d < best.distance) best = {face, d};
  }
  return best;
}

// Is new face t within tau for sure, and which input face is near its centroid? What the star knows answers while faces
// are small against tau; the band answers the rest.
bool measure_face(const CageState& state, DistanceBand& band, double tau, TauMode mode, PatchBatch& batch,
                  std::size_t t) {
  const TriangleRef triangle = patch_triangle(state.mesh, batch, t);
  const std::array<Vec3, 3> corners{corner(triangle, 0), corner(triangle, 1), corner(triangle, 2)};
  const Vec3 centroid = (corners[0] + corners[1] + corners[2]) / 3;
  DistanceBand::Near& near = batch.near[t];
  near = near_by_star(state, band, batch, t, centroid);
  const auto beside_near = [&](const Vec3& x) { return band.distance_to_face(x, near.face) <= tau; };
  if (mode == TauMode::strict && !std::all_of(corners.begin(), corners.end(), beside_near) &&
      !band.within(corners[0], corners[1], corners[2], tau))
    return false;
  if (near.distance > near_enough * tau) {
    if (const DistanceBand::Near found = band.near(centroid); found.distance < near.distance) near = found;
  }
  return true;
}

}  // namespace

std::size_t PatchBatch::count(Verdict v) const {
  return static_cast<std::size_t>(std::count(verdict.begin(), verdict.end(), v));
}

TriangleRef patch_triangle(const CornerTable& mesh, const PatchBatch& batch, std::size_t t) {
  const std::uint32_t patch = batch.patch_of[t];
  const Triangle& v = batch.triangle[t];
  const auto at = [&](std::uint32_t u) { return u == batch.moved[patch] ? batch.point[patch].data() : mesh.point(u); };
  return {{at(v[0]), at(v[1]), at(v[2])}, {v[0], v[1], v[2]}};
}

PatchBatch build_collapses(const CageState& state, const PlacementSettings& settings,
                           const std::vector<Candidate>& selected) {
  const CornerTable& mesh = state.mesh;
  PatchBatch batch = empty_patches(selected);
  std::vector<std::uint32_t> star_size(selected.size());
  parallel_each(selected.size(), default_grain, [&](std::size_t i) {
    const std::uint32_t h = selected[i].halfedge;
    batch.moved[i] = mesh.origin(h);
    star_size[i] = mesh.valence(mesh.origin(h)) + mesh.valence(mesh.target(h)) - 2;
  });
  batch.first_removed = offsets(selected.size(), [&](std::size_t i) { return star_size[i]; });
  batch.first_face = offsets(selected.size(), [&](std::size_t i) { return star_size[i] - 2; });
  allocate_faces(batch);
  place_collapses(state, settings, batch);
  parallel_each(selected.size(), patch_grain, [&](std::size_t i) { list_collapse(mesh, batch, i); });
  return batch;
}

PatchBatch build_flips(const CageState& state, const std::vector<Candidate>& selected) {
  PatchBatch batch = empty_patches(selected);
  batch.first_removed = offsets(selected.size(), [](std::size_t) { return 2u; });
  batch.first_face = batch.first_removed;
  allocate_faces(batch);
  parallel_each(selected.size(), default_grain, [&](std::size_t i) { list_flip(state.mesh, batch, i); });
  return batch;
}

void test_patches_locally(const CageState& state, PatchBatch& batch) {
  parallel_each(batch.size(), patch_grain, [&](std::size_t i) {
    if (!sweeps_outward(state.mesh, batch, i))
      batch.verdict[i] = Verdict::sweeps_inward;
    else if (!proper_patch(state.mesh, batch, i))
      batch.verdict[i] = Verdict::degenerate;
  });
}

void test_patches_against_band(const CageState& state, DistanceBand& band, double tau, TauMode mode,
                               PatchBatch& batch) {
  parallel_each(batch.size(), patch_grain, [&](std::size_t i) {
    if (!batch.alive(i)) return;
    for (std::size_t t = batch.first_face[i]; t < batch.first_face[i + 1]; ++t) {
      if (measure_face(state, band, tau, mode, batch, t)) continue;
      batch.verdict[i] = Verdict::beyond_tau;
      return;
    }
  });
  band.absorb();
}

}  // namespace prcage
