#include "parallel/patches.h"

#include <algorithm>
#include <array>
#include <limits>

#include "core/patch_gap.h"
#include "core/predicates.h"
#include "core/projection.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

constexpr std::size_t patch_grain = 16;
// Rounding in differences of heights, relative to the extent of what they are of, with much to spare.
constexpr double height_rounding = 1e-14;
constexpr double unknown = std::numeric_limits<double>::infinity();

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
  batch.reach.resize(triangles);
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
      const Triangle old = mesh.face(f);
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

// The star of a vertex.
void list_move(const CornerTable& mesh, PatchBatch& batch, std::size_t i) {
  std::size_t next = batch.first_face[i];
  for_each_outgoing(mesh, batch.moved[i], [&](std::uint32_t h) {
    const std::uint32_t f = h / 3;
    batch.removed[next] = batch.face[next] = f;  // as many old faces as new ones
    batch.triangle[next] = mesh.face(f);
    batch.patch_of[next] = static_cast<std::uint32_t>(i);
    ++next;
  });
}

Vec3 corner(const TriangleRef& t, int i) { return {t.p[i][0], t.p[i][1], t.p[i][2]}; }

// Sign test of the swept tetrahedra: none is negative.
bool sweeps_outward(const CornerTable& mesh, const PatchBatch& batch, std::size_t i) {
  const auto faces = batch.removed_faces(i);
  if (batch.is_flip(i)) {  // the far corner of the second face against the first face
    const std::uint32_t h = batch.candidate[i].halfedge;
    return exact::orient3d(mesh.point(mesh.origin(h)), mesh.point(mesh.target(h)), mesh.point(mesh.apex(h)),
                           mesh.point(mesh.apex(mesh.twin[h]))) >= 0;
  }
  return std::all_of(faces.begin(), faces.end(), [&](std::uint32_t f) {
    const auto [a, b, c] = mesh.face(f);
    return exact::orient3d(mesh.point(a), mesh.point(b), mesh.point(c), batch.point[i].data()) >= 0;
  });
}

Vec3 unit_or_zero(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? Vec3(v / length) : Vec3::Zero();
}

// The mean normal of the new faces; up to rounding that of the removed ones, too, since both have the same rim.
Vec3 mean_normal(const CornerTable& mesh, const PatchBatch& batch, std::size_t i) {
  Vec3 n = Vec3::Zero();
  for (std::size_t t = batch.first_face[i]; t < batch.first_face[i + 1]; ++t) {
    const TriangleRef p = patch_triangle(mesh, batch, t);
    n += (corner(p, 1) - corner(p, 0)).cross(corner(p, 2) - corner(p, 0));
  }
  return unit_or_zero(n);
}

// Is it certain that the new faces face n and wind round the moved vertex once, as `winds` is about to count?
bool new_faces_face(const CornerTable& mesh, const PatchBatch& batch, std::size_t i, const Vec3& n, Winds winds) {
  if (n.isZero(0)) return false;

  for (std::size_t t = batch.first_face[i]; t < batch.first_face[i + 1]; ++t) {
    const TriangleRef p = patch_triangle(mesh, batch, t);
    if (!certainly_faces(n, p.p[0], p.p[1], p.p[2])) return false;
    for (int k = 0; k < 3; ++k)
      if (p.v[k] == batch.moved[i]) winds.add(p.p[(k + 1) % 3], p.p[(k + 2) % 3]);
  }
  return batch.is_flip(i) || winds.certainly_once();
}

bool removed_faces_face(const CornerTable& mesh, const PatchBatch& batch, std::size_t i, const Vec3& n) {
  const auto faces = batch.removed_faces(i);
  return std::all_of(faces.begin(), faces.end(), [&](std::uint32_t f) {
    const auto [a, b, c] = mesh.face(f);
    return certainly_faces(n, mesh.point(a), mesh.point(b), mesh.point(c));
  });
}

// A direction that all new and all removed faces are likely to face, if there is one: the mean of their normals, turned
// towards the one that looks away most until none does.
Vec3 likely_direction(const CageState& state, const PatchBatch& batch, std::size_t i) {
  constexpr int most_turns = 32;
  constexpr double least_cosine = 1e-3;
  std::vector<Vec3> normals;
  const auto add = [&](const Normal& n) {
    if (n != Normal{}) normals.emplace_back(n[0], n[1], n[2]);
  };
  for (const Normal& n : batch.normals(i)) add(n);
  for (const std::uint32_t f : batch.removed_faces(i)) add(state.face_normal[f]);
  Vec3 n = Vec3::Zero();
  for (const Vec3& normal : normals) n += normal / static_cast<double>(normals.size());
  for (int turn = 0; turn < most_turns && !normals.empty(); ++turn) {
    const auto away = std::min_element(normals.begin(), normals.end(),
                                       [&](const Vec3& a, const Vec3& b) { return n.dot(a) < n.dot(b); });
    if (n.dot(*away) > least_cosine * n.norm()) break;
    n += *away;
  }
  return unit_or_zero(n);
}

// The mean normal of the new faces if these and the removed ones face it; else zero.
Vec3 common_direction(const CornerTable& mesh, const PatchBatch& batch, std::size_t i) {
  const Vec3 n = mean_normal(mesh, batch, i);
  const Winds winds(n, batch.point[i].data());
  return new_faces_face(mesh, batch, i, n, winds) && removed_faces_face(mesh, batch, i, n) ? n : Vec3::Zero();
}

// False if the patch turns faces over, see test_patches_locally(). Sets the direction that all faces face, if any.
bool keeps_faces_up(const CageState& state, PatchBatch& batch, std::size_t i) {
  const CornerTable& mesh = state.mesh;
  const auto graph_along = [&](const Vec3& n) {
    const Vec3 odd(0.3141, 0.5926, -0.7422);
    return new_faces_face(mesh, batch, i, n, Winds(n, odd, batch.point[i].data()));
  };
  const Vec3 mean = mean_normal(mesh, batch, i);
  const bool faces_mean = graph_along(mean);
  if (faces_mean && removed_faces_face(mesh, batch, i, mean)) {
    batch.direction[i] = mean;
    return true;
  }
  const Vec3 other = likely_direction(state, batch, i);
  if (removed_faces_face(mesh, batch, i, other) && graph_along(other)) {
    batch.direction[i] = other;
    return true;
  }
  return faces_mean;
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
DistanceBand::Near near_with_hint(const DistanceBand& band, const BandLimits& limits, const Vec3& x,
                                  std::uint32_t hint) {
  const DistanceBand::Near known{hint, band.distance_to_face(x, hint)};
  return known.distance <= limits.near_enough * limits.centroids ? known : band.nearest(x, hint);
}

// Upper bound of the distance of a point of the patch to the faces that it replaces; infinity if unknown.
double gap_to_removed(const CornerTable& mesh, const PatchBatch& batch, std::size_t i) {
  if (batch.direction[i].isZero(0)) return unknown;
  const std::uint32_t h = batch.candidate[i].halfedge;
  const std::uint32_t a = mesh.origin(h), b = mesh.target(h);
  const bool flip = batch.is_flip(i), move = batch.is_move(i);
  const ViewAlong view(batch.direction[i], mesh.point(a));
  GraphDisc before, after;
  for (const std::uint32_t f : batch.removed_faces(i)) {
    const Triangle v = mesh.face(f);
    const std::array<Vec3, 3> p{view(mesh.point(v[0])), view(mesh.point(v[1])), view(mesh.point(v[2]))};
    before.add_face(p[0], p[1], p[2]);
    for (std::size_t k = 0; k < 3 && !flip; ++k)
      if (v[k] == a || (!move && v[k] == b && v[(k + 1) % 3] != a)) before.add_inner_edge(p[k], p[(k + 1) % 3]);
  }
  for (std::size_t t = batch.first_face[i]; t < batch.first_face[i + 1]; ++t) {
    const TriangleRef triangle = patch_triangle(mesh, batch, t);
    const std::array<Vec3, 3> p{view(triangle.p[0]), view(triangle.p[1]), view(triangle.p[2])};
    after.add_face(p[0], p[1], p[2]);
    for (std::size_t k = 0; k < 3 && !flip; ++k)
      if (triangle.v[k] == a) after.add_inner_edge(p[k], p[(k + 1) % 3]);
  }
  if (flip) {
    before.add_inner_edge(view(mesh.point(a)), view(mesh.point(b)));
    after.add_inner_edge(view(mesh.point(mesh.apex(h))), view(mesh.point(mesh.apex(mesh.twin[h]))));
  } else {
    before.add_inner_vertex(view(mesh.point(a)));
    if (!move) before.add_inner_vertex(view(mesh.point(b)));
    after.add_inner_vertex(view(batch.point[i].data()));
  }
  return largest_gap(before, after);
}

// An upper bound of the same that is easily found: how far the corners of both are from each other along the direction
// in which both are graphs.
double height_range(const CornerTable& mesh, const PatchBatch& batch, std::size_t i) {
  const Vec3& n = batch.direction[i];
  if (n.isZero(0)) return unknown;
  const Vec3 origin = mesh.vec_at(mesh.origin(batch.candidate[i].halfedge));
  double low = 0, high = 0, widest = 0;
  const auto add = [&](const Vec3& p) {
    const Vec3 d = p - origin;
    const double height = n.dot(d);
    low = std::min(low, height);
    high = std::max(high, height);
    widest = std::max(widest, d.lpNorm<1>());
  };
  for (const std::uint32_t f : batch.removed_faces(i))
    for (std::size_t k = 0; k < 3; ++k) add(mesh.vec_at(mesh.corner_vertex[3 * std::size_t{f} + k]));
  if (!batch.is_flip(i)) add(vec(batch.point[i]));
  return high - low + height_rounding * widest;
}

// Upper bound of the distance of the faces that a patch replaces to the input.
double removed_reach(const CageState& state, const PatchBatch& batch, std::size_t i) {
  float reach = 0;
  for (const std::uint32_t f : batch.removed_faces(i)) reach = std::max(reach, state.face_reach[f]);
  return reach;
}

void lower_reach(PatchBatch& batch, std::size_t t, double reach) {
  batch.reach[t] = std::min(batch.reach[t], reach);
  batch.near[t].distance = std::min(batch.near[t].distance, batch.reach[t]);
}

// Which input face is near the centroid of new face t? The distances of the corners to it bound that of the face. The
// input face known for a removed face will do if it is near enough.
void measure_face(const CageState& state, const DistanceBand& band, double enough, PatchBatch& batch, std::size_t t) {
  const Corners corners = patch_corners(state.mesh, batch, t);
  const Vec3 centroid = (corners[0] + corners[1] + corners[2]) / 3;
  DistanceBand::Near& near = batch.near[t];
  near.face = state.face_near[batch.face[t]];
  TriangleDistance distance = band.distance_from(near.face);
  near.distance = std::sqrt(distance.squared(centroid));
  if (near.distance > enough) {
    near = band.nearest(centroid, near.face);
    distance = band.distance_from(near.face);
  }
  lower_reach(batch, t, std::sqrt(distance.largest_squared(corners)));
}

// Distances of centroids as a band on both sides wants them: of a face near by, and on the side of its plane.
void sign_distance(const CageState& state, const DistanceBand& band, const BandLimits& limits, PatchBatch& batch,
                   std::size_t t) {
  const auto [a, b, c] = patch_corners(state.mesh, batch, t);
  const Vec3 centroid = (a + b + c) / 3;
  DistanceBand::Near& near = batch.near[t];
  near = near_with_hint(band, limits, centroid, near.face);
  if (band.behind_face(centroid, near.face)) near.distance = -near.distance;
}

// Does the new face look the same way, by less than a right angle, as the face of the input that is closest to one of
// its points at least? As inverted_faces.h counts; nearly always the first point answers.
bool looks_as_the_input(const CageState& state, const DistanceBand& band, const PatchBatch& batch, std::size_t t) {
  const TriangleRef p = patch_triangle(state.mesh, batch, t);
  const Corners corners = patch_corners(state.mesh, batch, t);
  std::uint32_t near = batch.near[t].face;
  bool looks = false;
  for_each_lattice_point([&](const Barycentric& weights) {
    if (looks) return;
    near = band.nearest(at(corners, weights), near).face;
    looks = certainly_faces(band.area_normal(near), p.p[0], p.p[1], p.p[2]);
  });
  return looks;
}

// Is the vertex that moves out of reach for certain? Spares the measuring of faces that cannot be within it.
bool moves_too_far(const CageState& state, const DistanceBand& band, const BandLimits& limits, const PatchBatch& batch,
                   std::size_t i) {
  if (batch.is_flip(i)) return false;
  const std::uint32_t hint = state.face_near[batch.removed_faces(i)[0]];
  return near_with_hint(band, limits, vec(batch.point[i]), hint).distance > limits.reach;
}

// Fills in `near` and `reach` of a patch; not accepted if it is not proved to be within reach. The gap to what the
// patch replaces comes first where it can spare the measuring of faces, else only where that does not prove them.
Verdict measure_patch(const CageState& state, DistanceBand& band, const BandLimits& limits, PatchBatch& batch,
                      std::size_t i) {
  const double enough = limits.near_enough * limits.centroids, removed = removed_reach(state, batch, i);
  double inherited = unknown;  // bound for all faces, by what is known of the old ones
  const auto inherits = [&] {
    inherited = removed + height_range(state.mesh, batch, i);
    if (inherited > enough) inherited = removed + gap_to_removed(state.mesh, batch, i);
    return inherited <= limits.reach || !moves_too_far(state, band, limits, batch, i);
  };
  bool asked = removed <= enough;
  if (asked && !inherits()) return Verdict::beyond_tau;
  for (std::size_t t = batch.first_face[i]; t < batch.first_face[i + 1]; ++t) {
    batch.reach[t] = inherited;
    batch.near[t] = {state.face_near[batch.face[t]], inherited};
    if (inherited > enough) measure_face(state, band, enough, batch, t);
    if (batch.reach[t] > limits.reach && !asked) {
      asked = true;
      if (!inherits()) return Verdict::beyond_tau;
      lower_reach(batch, t, inherited);
    }
    if (batch.reach[t] > limits.reach) {
      const auto [a, b, c] = patch_corners(state.mesh, batch, t);
      lower_reach(batch, t, band.reach(a, b, c, limits.reach, batch.near[t].distance <= limits.reach));
    }
    if (batch.reach[t] > limits.reach) return Verdict::beyond_tau;
    // The constraints of a collapse keep centroids within the thickness of the cycle; nothing else does so for moves.
    if (batch.is_move(i) && batch.near[t].distance > limits.centroids) return Verdict::beyond_tau;
    if (limits.sides == Sides::outer) continue;
    sign_distance(state, band, limits, batch, t);
    if (!looks_as_the_input(state, band, batch, t)) return Verdict::turns_over;
  }
  return Verdict::accepted;
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

Corners patch_corners(const CornerTable& mesh, const PatchBatch& batch, std::size_t t) {
  const TriangleRef triangle = patch_triangle(mesh, batch, t);
  return {corner(triangle, 0), corner(triangle, 1), corner(triangle, 2)};
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

PatchBatch build_moves(const CageState& state, const UnitFrame& frame, const std::vector<Candidate>& selected,
                       std::vector<Position> points) {
  const CornerTable& mesh = state.mesh;
  PatchBatch batch = empty_patches(selected);
  batch.point = std::move(points);
  for (std::size_t i = 0; i < selected.size(); ++i) batch.moved[i] = mesh.origin(selected[i].halfedge);
  batch.first_removed = offsets(selected.size(), [&](std::size_t i) { return mesh.valence(batch.moved[i]); });
  batch.first_face = batch.first_removed;
  allocate_faces(batch);
  parallel_each(selected.size(), patch_grain, [&](std::size_t i) { list_move(mesh, batch, i); });
  set_bounds(mesh, frame, batch);
  return batch;
}

void test_patches_locally(const CageState& state, PatchBatch& batch, Sides sides, bool inward) {
  parallel_each(batch.size(), patch_grain, [&](std::size_t i) {
    if (sides == Sides::both) {
      if (!keeps_faces_up(state, batch, i))
        batch.verdict[i] = Verdict::turns_over;
      else if (batch.direction[i].isZero(0) && !proper_patch(state.mesh, batch, i))
        batch.verdict[i] = Verdict::degenerate;
      return;
    }
    batch.direction[i] = common_direction(state.mesh, batch, i);
    if (!inward && !batch.is_move(i) && !sweeps_outward(state.mesh, batch, i))
      batch.verdict[i] = Verdict::sweeps_inward;
    else if (batch.direction[i].isZero(0) && !proper_patch(state.mesh, batch, i))
      batch.verdict[i] = Verdict::degenerate;
  });
}

void test_patches_against_band(const CageState& state, DistanceBand& band, const BandLimits& limits,
                               PatchBatch& batch) {
  // Few at a time: a large patch takes as long as thousands of small ones.
  parallel_each(batch.size(), 2, [&](std::size_t i) {
    if (batch.alive(i)) batch.verdict[i] = measure_patch(state, band, limits, batch, i);
  });
  band.absorb();
}

}  // namespace prcage
