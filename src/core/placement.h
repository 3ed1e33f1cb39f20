// Where a collapsed edge goes: the constrained quadric problem of an edge (paper eq. 1, 4, 5). The stars of many edges
// are gathered into flat arrays; their problems are made and solved as a batch.
//
// Each problem lives in a local frame with the edge's midpoint as origin and its length as unit, with unit normals, so
// that one tolerance fits all scales.
#pragma once

#include <cstdint>
#include <vector>

#include <tbb/cache_aligned_allocator.h>

#include "core/band.h"
#include "core/corner_table.h"
#include "core/edge_star.h"
#include "core/qp3_batch.h"
#include "core/star_planes_problem.h"

namespace prcage {

struct PlacementSettings {
  Band band;
  // Added to the lower bound of eq. 4, relative to the edge: keeps active constraints on the certain side of their
  // planes under rounding (without it exact orientation rejects half of the candidates).
  double margin = 1e-9;
  // The same in absolute units, for positions that are rounded to floats.
  double absolute_margin = 0;
  // epsilon of eq. 5 as a fraction of the face's present height, so that it never excludes the present vertex.
  double height_fraction = 1e-2;
  // Tikhonov term towards the midpoint, relative to the mean eigenvalue: flat stars have quadrics of rank 1.
  double regularization = 1e-3;
  // Stars with more faces are left alone until collapses around them make them smaller: keeps the cost of a round
  // linear at hubs of thousands of faces.
  std::uint32_t max_star = 512;
  // Shortest unit of a local frame, input's unit: edges of length zero have no frame of their own.
  double min_scale = 0;
  bool float_positions = false;
  // False: the minimum of the quadric, whatever its planes say.
  bool constrained = true;
  // Makes costs free of units: 1 / l^2 for the square root of an area times a squared length.
  double cost_scale = 1;
  SimdLevel simd = simd_level();
};

// Problems and solutions, one entry an edge. Reused between calls; grows to the largest batch.
struct PlacementBatch {
  std::vector<std::uint32_t> halfedge;
  std::vector<StarFrame> frame;

  // The stars as they are gathered, see StarArrays. The first corner_count are in use.
  std::vector<double> corner_x, corner_y, corner_z, lower, upper;
  std::size_t corner_count = 0;

  // The problems, which solve_placements() makes of them. The planes of problem i, local frame, are
  // SlabRows{&rows[first_row[i]], row_length[i]}.
  std::vector<std::uint32_t> first_row, row_length;
  std::vector<double, tbb::cache_aligned_allocator<double>> rows;
  std::size_t row_numbers = 0;   // that are in use
  std::vector<Symmetric3> form;  // 1/2 x^T form x + linear . x + constant: squared distance, weighted
  std::vector<Vec3> linear;
  std::vector<double> constant;

  std::vector<Symmetric3> scaled_form;  // as the solver wants them
  std::vector<Vec3> scaled_linear;
  std::vector<Vec3> x;  // local frame
  std::vector<QpStatus> status;

  std::vector<Position> solution;  // global frame
  std::vector<double> cost;        // area-weighted squared distance at the solution; infinity if infeasible

  std::size_t size() const { return halfedge.size(); }
  void clear();
};

// What the band wants to know of each face: d(c_f, M), and how far it may go outward, unless that is null.
struct FaceHeights {
  // NOLINTNEXTLINE(google-explicit-constructor)
  FaceHeights(const std::vector<float>& d, const std::vector<float>* r = nullptr) : distance(d), room(r) {}
  const std::vector<float>& distance;
  const std::vector<float>* room;
};

// Appends the problem of an edge whose star has been walked.
void gather_placement(const CornerTable& mesh, const FaceHeights& heights, const EdgeStar& star,
                      const PlacementSettings& settings, PlacementBatch& batch);
// The same for an edge by itself.
void gather_placement(const CornerTable& mesh, const FaceHeights& heights, std::uint32_t halfedge,
                      const PlacementSettings& settings, PlacementBatch& batch);

// Makes and solves all problems of the batch.
void solve_placements(const PlacementSettings& settings, PlacementBatch& batch);

}  // namespace prcage
