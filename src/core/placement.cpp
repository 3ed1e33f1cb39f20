#include "core/placement.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/star_planes.h"

namespace prcage {
namespace {

// Without shrinking: the arrays of a batch keep the size of the largest one.
template <class Values>
void make_room(Values& values, std::size_t size) {
  if (values.size() < size) values.resize(size + size / 2);
}

StarFrame frame_of(const CornerTable& mesh, const EdgeStar& star, const PlacementSettings& settings,
                   const PlacementBatch& batch) {
  const Position& a = mesh.position[mesh.origin(star.halfedge())];
  const Position& b = mesh.position[mesh.target(star.halfedge())];
  StarFrame frame;
  for (std::size_t k = 0; k < 3; ++k) {
    frame.origin[k] = 0.5 * (a[k] + b[k]);
    frame.tail[k] = a[k];
    frame.head[k] = b[k];
  }
  frame.scale = std::max((vec(b) - vec(a)).norm(), settings.min_scale);
  frame.first_corner = static_cast<std::uint32_t>(batch.corner_count);
  frame.first_row = static_cast<std::uint32_t>(batch.row_numbers);
  frame.faces = static_cast<std::uint32_t>(star.faces().size());
  frame.tail_faces = static_cast<std::uint32_t>(star.tail_faces());
  return frame;
}

void make_problems(const PlacementSettings& settings, PlacementBatch& batch) {
  make_room(batch.rows, batch.row_numbers + star_padding);
  batch.form.resize(batch.size());
  batch.linear.resize(batch.size());
  batch.constant.resize(batch.size());
  const StarArrays arrays{batch.size(),
                          batch.frame.data(),
                          {batch.corner_x.data(), batch.corner_y.data(), batch.corner_z.data()},
                          batch.lower.data(),
                          batch.upper.data(),
                          settings.margin,
                          settings.absolute_margin,
                          settings.height_fraction,
                          batch.rows.data(),
                          &batch.form[0].xx,
                          batch.linear[0].data(),
                          batch.constant.data()};
  make_star_planes(arrays, settings.simd);
}

// The problem that the solver gets: scaled to unit trace, so that its tolerances mean the same for every star. Stars
// without area have a form of zero, which it does not solve.
void scale_problem(const PlacementSettings& settings, PlacementBatch& batch, std::size_t i) {
  const Symmetric3& form = batch.form[i];
  const double trace = form.trace();
  const double weight = trace > 0 ? 1 / trace : 0;
  const double ridge = trace > 0 ? settings.regularization / 3 : 0;
  batch.scaled_form[i] = {form.xx * weight + ridge, form.xy * weight, form.xz * weight,
                          form.yy * weight + ridge, form.yz * weight, form.zz * weight + ridge};
  batch.scaled_linear[i] = batch.linear[i] * weight;
}

void read_solution(const PlacementSettings& settings, PlacementBatch& batch, std::size_t i) {
  batch.cost[i] = std::numeric_limits<double>::infinity();
  if (batch.status[i] != QpStatus::solved) return;
  const Vec3& x = batch.x[i];
  const StarFrame& frame = batch.frame[i];
  const Vec3 p = Vec3(frame.origin[0], frame.origin[1], frame.origin[2]) + frame.scale * x;
  batch.solution[i] = settings.float_positions ? round_to_floats(p) : position(p);
  const double error = x.dot(0.5 * (batch.form[i] * x) + batch.linear[i]) + batch.constant[i];
  // Among equally good collapses (flat regions) the short edge goes first.
  const double s2 = frame.scale * frame.scale;
  batch.cost[i] = (std::max(0.0, 2 * error) + 1e-9) * s2 * s2;
}

}  // namespace

void PlacementBatch::clear() {
  halfedge.clear();
  frame.clear();
  corner_count = 0;
  first_row.clear();
  row_length.clear();
  row_numbers = 0;
}

void gather_placement(const CornerTable& mesh, const FaceHeights& heights, const EdgeStar& star,
                      const PlacementSettings& settings, PlacementBatch& batch) {
  const auto vertices = star.vertices();
  const auto faces = star.faces();
  const std::size_t first = batch.corner_count;
  batch.frame.push_back(frame_of(mesh, star, settings, batch));
  batch.halfedge.push_back(star.halfedge());
  batch.first_row.push_back(batch.frame.back().first_row);
  batch.row_length.push_back(static_cast<std::uint32_t>(row_length(faces.size())));
  batch.row_numbers += slab_rows * batch.row_length.back();
  batch.corner_count += vertices.size();
  for (auto* values : {&batch.corner_x, &batch.corner_y, &batch.corner_z, &batch.lower, &batch.upper})
    make_room(*values, batch.corner_count + star_padding);
  double* const x = &batch.corner_x[first];
  double* const y = &batch.corner_y[first];
  double* const z = &batch.corner_z[first];
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Position& p = mesh.position[vertices[i]];
    x[i] = p[0];
    y[i] = p[1];
    z[i] = p[2];
  }
  double* const lower = &batch.lower[first];
  double* const upper = &batch.upper[first];
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const double distance = heights.distance[faces[i]];
    const HeightInterval height =
        heights.room == nullptr ? settings.band(distance) : settings.band(distance, (*heights.room)[faces[i]]);
    lower[i] = height.lower;
    upper[i] = height.upper;
  }
}

void gather_placement(const CornerTable& mesh, const FaceHeights& heights, std::uint32_t halfedge,
                      const PlacementSettings& settings, PlacementBatch& batch) {
  EdgeStar star;
  star.walk(mesh, halfedge);
  gather_placement(mesh, heights, star, settings, batch);
}

void solve_placements(const PlacementSettings& settings, PlacementBatch& batch) {
  const std::size_t n = batch.size();
  for (auto* values : {&batch.scaled_linear, &batch.x}) values->resize(n);
  batch.scaled_form.resize(n);
  batch.status.resize(n);
  batch.solution.resize(n);
  batch.cost.resize(n);
  if (n == 0) return;
  make_problems(settings, batch);
  if (!settings.constrained) std::fill(batch.row_length.begin(), batch.row_length.end(), 0);
  for (std::size_t i = 0; i < n; ++i) scale_problem(settings, batch, i);
  const Qp3Batch problems{batch.scaled_form, batch.scaled_linear, batch.first_row, batch.row_length, batch.rows};
  solve_qp3_batch(problems, 1e-10, batch.x, batch.status, settings.simd);
  for (std::size_t i = 0; i < n; ++i) read_solution(settings, batch, i);
}

}  // namespace prcage
