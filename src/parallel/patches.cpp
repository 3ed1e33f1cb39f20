#include "parallel/patches.h"

#include <algorithm>
#include <array>
#include <limits>

#include "core/predicates.h"
#include "core/projection.h"
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
  batch.unproved.assign(selected.size(), 1);
  batch.direction.assign(selected.size(), Vec3::Zero());
  batch.moved_distance.assign(selected.size(), std::numeric_limits<float>::infinity());
  return batch;
}

void allocate_faces(PatchBatch& batch) {
  batch.removed.resize(batch.first_removed.back());
  const std::size_t triangles = batch.first_face.back();
  batch.face.resize(triangles);
  batch.triangle.resize(triangles);
  batch.patch_of.resize(triangles);
  batch.box.resize(triangles);
  batch.normal.resize(triangles);
  batch.near.resize(triangles);
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

Vec3 corner(const TriangleRef& t, int i) { return {t.p[i][0], t.p[i][1], t.p[i][2]}; }

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

// The mean normal of the new faces, if these and the removed ones face it and the new ones wind round the moved vertex
// once; else zero.
Vec3 common_direction(const CornerTable& mesh, const PatchBatch& batch, std::size_t i) {
  Vec3 n = Vec3::Zero();
  for (std::size_t t = batch.first_face[i]; t < batch.first_face[i + 1]; ++t) {
    const TriangleRef p = patch_triangle(mesh, batch, t);
    n += (corner(p, 1) - corner(p, 0)).cross(corner(p, 2) - corner(p, 0));
  }
  const double length = n.norm();
  if (!(length > 0)) return Vec3::Zero();
  n /= length;
  Winds winds(n, batch.point[i].data());
  for (std::size_t t = batch.first_face[i]; t < batch.first_face[i + 1]; ++t) {
    const TriangleRef p = patch_triangle(mesh, batch, t);
    if (!certainly_faces(n, p.p[0], p.p[1], p.p[2])) return Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      if (p.v[k] == batch.moved[i]) winds.add(p.p[(k + 1) % 3], p.p[(k + 2) % 3]);
  }
  if (batch.moved[i] != none && !winds.certainly_once()) return Vec3::Zero();
  for (const std::uint32_t f : batch.removed_faces(i)) {
    const std::uint32_t* v = &mesh.corner_vertex[3 * std::size_t{f}];
    if (!certainly_faces(n, mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]))) return Vec3::Zero();
  }
  return n;
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

// The input face known for a removed face if it is near enough to x, else the nearest one: what is too much in a
// distance is lost for the constraints.
DistanceBand::Near near_with_hint(const DistanceBand& band, const Vec3& x, std::uint32_t hint, double tau) {
  const DistanceBand::Near known{hint, band.distance_to_face(x, hint)};
  return known.distance <= near_enough * tau ? known : band.nearest(x, hint);
}

// Is every point of the triangle within tau since its corners are well within it? A point is no farther from the corner
// in which it has the largest barycentric coordinate than two thirds of the longest edge.
bool within_by_corners(const std::array<Vec3, 3>& corner, double farthest, double tau) {
  if (farthest >= tau) return false;
  const double longest = std::max({(corner[1] - corner[0]).squaredNorm(), (corner[2] - corner[1]).squaredNorm(),
                                   (corner[0] - corner[2]).squaredNorm()});
  const double room = 1.5 * (tau - farthest);
  return longest <= room * room * (1 - 1e-12);
}

// The distance to one face is convex: a triangle whose corners are within tau of it is so as a whole.
bool beside_face(const TriangleDistance& face, const std::array<Vec3, 3>& corner, double tau) {
  return std::all_of(corner.begin(), corner.end(), [&](const Vec3& x) { return face.squared(x) <= tau * tau; });
}

// Is new face t within tau for sure, and which input face is near its centroid? What the corners and the star know
// answers while faces are small against tau; the band answers the rest.
bool measure_face(const CageState& state, DistanceBand& band, double tau, TauMode mode, PatchBatch& batch,
                  std::size_t t) {
  const std::size_t patch = batch.patch_of[t];
  const TriangleRef triangle = patch_triangle(state.mesh, batch, t);
  const std::array<Vec3, 3> corners{corner(triangle, 0), corner(triangle, 1), corner(triangle, 2)};
  const Vec3 centroid = (corners[0] + corners[1] + corners[2]) / 3;
  std::array<double, 3> known;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t v = batch.triangle[t][i];
    known[i] = v == batch.moved[patch] ? batch.moved_distance[patch] : state.vertex_distance[v];
  }
  const DistanceBand::Near near = near_with_hint(band, centroid, state.face_near[batch.face[t]], tau);
  batch.near[t] = near;
  return mode == TauMode::paper || within_by_corners(corners, *std::max_element(known.begin(), known.end()), tau) ||
         beside_face(band.distance_from(near.face), corners, tau) ||
         band.within(corners[0], corners[1], corners[2], tau, near.distance <= tau);
}

void measure_moved(const CageState& state, DistanceBand& band, double tau, PatchBatch& batch, std::size_t i) {
  if (batch.moved[i] == none) return;
  const std::uint32_t hint = state.face_near[batch.removed_faces(i)[0]];
  batch.moved_distance[i] = round_distance_up(near_with_hint(band, vec(batch.point[i]), hint, tau).distance);
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

void set_bounds(const CornerTable& mesh, const UnitFrame& frame, PatchBatch& batch) {
  parallel_each(batch.triangle.size(), default_grain, [&](std::size_t t) {
    const TriangleRef triangle = patch_triangle(mesh, batch, t);
    batch.box[t] = bounding_box(frame, {triangle.p[0], triangle.p[1], triangle.p[2]});
    batch.normal[t] = reliable_normal(triangle.p[0], triangle.p[1], triangle.p[2]);
  });
}

PatchBatch build_collapses(const CageState& state, const UnitFrame& frame, const PlacedCollapses& placed) {
  const CornerTable& mesh = state.mesh;
  const std::vector<Candidate>& selected = placed.candidate;
  PatchBatch batch = empty_patches(selected);
  batch.point = placed.point;
  std::vector<std::uint32_t> star_size(selected.size());
  parallel_each(selected.size(), default_grain, [&](std::size_t i) {
    const std::uint32_t h = selected[i].halfedge;
    batch.moved[i] = mesh.origin(h);
    star_size[i] = mesh.valence(mesh.origin(h)) + mesh.valence(mesh.target(h)) - 2;
  });
  batch.first_removed = offsets(selected.size(), [&](std::size_t i) { return star_size[i]; });
  batch.first_face = offsets(selected.size(), [&](std::size_t i) { return star_size[i] - 2; });
  allocate_faces(batch);
  parallel_each(selected.size(), patch_grain, [&](std::size_t i) { list_collapse(mesh, batch, i); });
  set_bounds(mesh, frame, batch);
  return batch;
}

PatchBatch build_flips(const CageState& state, const UnitFrame& frame, const std::vector<Candidate>& selected) {
  PatchBatch batch = empty_patches(selected);
  batch.first_removed = offsets(selected.size(), [](std::size_t) { return 2u; });
  batch.first_face = batch.first_removed;
  allocate_faces(batch);
  parallel_each(selected.size(), default_grain, [&](std::size_t i) { list_flip(state.mesh, batch, i); });
  set_bounds(state.mesh, frame, batch);
  return batch;
}

void test_patches_locally(const CageState& state, PatchBatch& batch) {
  parallel_each(batch.size(), patch_grain, [&](std::size_t i) {
    batch.direction[i] = common_direction(state.mesh, batch, i);
    if (!sweeps_outward(state.mesh, batch, i))
      batch.verdict[i] = Verdict::sweeps_inward;
    else if (batch.direction[i].isZero(0) && !proper_patch(state.mesh, batch, i))
      batch.verdict[i] = Verdict::degenerate;
  });
}

void test_patches_against_band(const CageState& state, DistanceBand& band, double tau, TauMode mode,
                               PatchBatch& batch) {
  // Few at a time: a large patch takes as long as thousands of small ones.
  parallel_each(batch.size(), 2, [&](std::size_t i) {
    if (!batch.alive(i)) return;
    measure_moved(state, band, tau, batch, i);
    if (mode == TauMode::strict && batch.moved[i] != none && batch.moved_distance[i] > tau) {
      batch.verdict[i] = Verdict::beyond_tau;
      return;
    }
    for (std::size_t t = batch.first_face[i]; t < batch.first_face[i + 1]; ++t) {
      if (measure_face(state, band, tau, mode, batch, t)) continue;
      batch.verdict[i] = Verdict::beyond_tau;
      return;
    }
  });
  band.absorb();
}

}  // namespace prcage
