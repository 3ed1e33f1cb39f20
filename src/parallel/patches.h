// Stage 3 of a round: the triangles that would replace the star of each selected edge (or the pair of faces of each
// flip), and the exact tests that need nothing but the patch itself.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/lattice.h"
#include "core/triangle_pair.h"
#include "parallel/cage_state.h"
#include "parallel/candidates.h"
#include "parallel/distance_band.h"
#include "parallel/parallel_for.h"

namespace prcage {

enum class Verdict : std::uint8_t {
  accepted,
  sweeps_inward,   // exact orientation: the cage would move inside one of its faces
  turns_over,      // a new face would look away from those that it replaces or from the input: bands on both sides
  fits_worse,      // the new faces would fit the input worse: moves that are to polish the cage
  degenerate,      // a new face is degenerate, or the patch meets itself
  beyond_tau,      // not proved to be within tau of the input
  hits_cage,       // meets the rest of the cage
  hits_input,      // meets the input, or might leave a component of it outside: inward moves only
  wrong_side,      // not proved to keep to what is allowed on each side of the input
  uncovers_input,  // would leave samples of the input farther from the cage than the bound
  conflict,        // meets a cheaper patch of the same round
};

// Patches, in the order of the candidates. Patch i replaces the faces removed[first_removed[i] ..) by the triangles
// [first_face[i] ..); triangle t takes the number face[t] when the patch is committed.
struct PatchBatch {
  std::vector<Candidate> candidate;
  std::vector<std::uint32_t> moved;  // vertex that moves to `point`, or none
  std::vector<Position> point;
  std::vector<Verdict> verdict;

  std::vector<std::uint32_t> first_removed;
  std::vector<std::uint32_t> removed;

  std::vector<std::uint32_t> first_face;
  std::vector<std::uint32_t> face;
  std::vector<Triangle> triangle;
  std::vector<std::uint32_t> patch_of;   // of each triangle
  std::vector<Box> box;                  // of each triangle
  std::vector<Normal> normal;            // of each triangle
  std::vector<DistanceBand::Near> near;  // of each triangle: an input face near by; as CageState::face_distance
  std::vector<double> reach;             // of each triangle: upper bound of the distance of its points to M
  std::vector<Vec3> direction;           // of each patch: unit vector that its faces and those it removes face, or zero
                                         // (condition 1 in core/projection.h)
  std::vector<std::uint8_t> unproved;    // of each patch: the projection does not prove it free of contacts

  std::size_t size() const { return candidate.size(); }
  // A collapse has two faces fewer afterwards, a flip moves no vertex.
  bool is_flip(std::size_t i) const { return moved[i] == none; }
  bool is_move(std::size_t i) const {
    return !is_flip(i) && first_removed[i + 1] - first_removed[i] == first_face[i + 1] - first_face[i];
  }
  std::span<const std::uint32_t> removed_faces(std::size_t i) const {
    return std::span(removed).subspan(first_removed[i], first_removed[i + 1] - first_removed[i]);
  }
  std::span<const Box> boxes(std::size_t i) const {
    return std::span(box).subspan(first_face[i], first_face[i + 1] - first_face[i]);
  }
  std::span<const Normal> normals(std::size_t i) const {
    return std::span(normal).subspan(first_face[i], first_face[i + 1] - first_face[i]);
  }
  bool alive(std::size_t i) const { return verdict[i] == Verdict::accepted; }
  std::size_t count(Verdict v) const;
};

// Triangle t of the batch with the positions that it would have.
TriangleRef patch_triangle(const CornerTable& mesh, const PatchBatch& batch, std::size_t t);
Corners patch_corners(const CornerTable& mesh, const PatchBatch& batch, std::size_t t);

// Is the patch still in the race, while other threads may be rejecting it?
inline bool alive(PatchBatch& batch, std::uint32_t patch) {
  return std::atomic_ref(batch.verdict[patch]).load(std::memory_order_relaxed) == Verdict::accepted;
}

// Boxes of the selected patches and of the faces that they would remove, empty ones for the rest.
template <class Selected>
std::vector<Box> patch_boxes(const CageState& state, const PatchBatch& batch, const Selected& selected) {
  std::vector<Box> boxes(batch.size());
  parallel_each(batch.size(), default_grain, [&](std::size_t i) {
    if (!selected(i)) return;
    for (const Box& box : batch.boxes(i)) boxes[i].unite(box);
    for (const std::uint32_t f : batch.removed_faces(i)) boxes[i].unite(state.face_box[f]);
  });
  return boxes;
}

// The boxes and normals of the triangles for the present positions.
void set_bounds(const CornerTable& mesh, const UnitFrame& frame, PatchBatch& batch);

// Patches of the collapses of independent edges.
PatchBatch build_collapses(const CageState& state, const UnitFrame& frame, const PlacedCollapses& placed);

// Patches of edge flips with disjoint quadrilaterals.
PatchBatch build_flips(const CageState& state, const UnitFrame& frame, const std::vector<Candidate>& selected);

// Patches that move the origins of the given halfedges, of which no two are neighbours, to `points`.
PatchBatch build_moves(const CageState& state, const UnitFrame& frame, const std::vector<Candidate>& selected,
                       std::vector<Position> points);

// Exact: p of each collapse is on the outer side of, or on, every face of its star; a flip adds volume outside; no
// new face is degenerate; no patch meets itself. Sets `direction` where there is one. Moves of single vertices, and
// flips if `inward`, may go either way: what they must not touch is up to others.
//
// A surface with a band on both sides may move inward, but no face may turn over: the new faces must be one to one with
// their projection along a direction. That is one that the removed faces face, too, wherever there is one; removed
// faces that fold so much that there is none are replaced by a patch that faces the vector area of the patch's rim,
// which is that of the removed faces as well.
void test_patches_locally(const CageState& state, PatchBatch& batch, Sides sides = Sides::outer, bool inward = false);

// The band of a cycle.
struct BandLimits {
  double centroids = 0;                                    // tau_k: what eq. 4 grants the centroids of faces
  double reach = std::numeric_limits<double>::infinity();  // what every point of the cage is proved to be within
  Sides sides = Sides::outer;                              // both: distances of centroids are signed
  double outer = std::numeric_limits<double>::infinity();  // of reach, what is allowed outside of M
  double inner = std::numeric_limits<double>::infinity();  // and inside, if there are two sides
  // Share of tau_k up to which the distance of a centroid may be to a face near by instead of the nearest one. What it
  // is too large by is lost for eq. 4.
  double near_enough = 0.25;
};

// Finds an input face near each new centroid, and rejects patches that are not proved to be within reach; in a band on
// both sides also those with a face that looks away from all of the input that is known near it.
void test_patches_against_band(const CageState& state, DistanceBand& band, const BandLimits& limits, PatchBatch& batch);

}  // namespace prcage
