#include "parallel/cage_weights.h"

#include <cmath>

#include "core/surface.h"
#include "parallel/certify.h"

namespace prcage {
namespace {

// As many halfedges in one direction as in the other.
bool balanced(const Mesh& mesh, const EdgeGroups& edges, std::size_t e) {
  const std::span<const std::uint32_t> halfedges = edges[e];
  const auto ascends = [&](std::uint32_t h) {
    const Triangle& t = mesh.triangles[h / 3];
    return t[h % 3] < t[(h + 1) % 3];
  };
  return 2 * static_cast<std::size_t>(std::count_if(halfedges.begin(), halfedges.end(), ascends)) == halfedges.size();
}

std::size_t open_edges(const Mesh& mesh, const EdgeGroups& edges) {
  std::size_t count = 0;
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (!balanced(mesh, edges, e)) ++count;
  return count;
}

}  // namespace

std::string BoundCage::build(const Mesh& cage) {
  SubMesh used;
  if (!well_formed(cage, used) || !std::all_of(cage.positions.begin(), cage.positions.end(), within_limits)) {
    return "nothing can be bound to the cage: it has no faces, a face that does not name three existing vertices, or "
           "coordinates that are not finite or out of range";
  }
  const Mesh& mesh = used.mesh;
  const EdgeGroups edges = group_edges(mesh.triangles, mesh.positions.size());
  if (const std::size_t open = open_edges(mesh, edges); open > 0)
    return "nothing can be bound to the cage: it is not closed, " + std::to_string(open) +
           " of its edges lack a face or have one that is turned over";

  row_size_ = cage.positions.size();
  column_ = used.vertex_of;
  corner_ = mesh.triangles;
  opposite_.resize(corner_.size());
  edge_.resize(edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    for (const std::uint32_t h : edges[e]) {
      opposite_[h / 3][previous_halfedge(h) % 3] = static_cast<std::uint32_t>(e);
      edge_[e] = {corner_[h / 3][h % 3], corner_[h / 3][(h + 1) % 3]};
    }
  }
  scale_ = std::ldexp(1.0, -std::ilogb(extent(mesh.positions).diagonal()));
  position_ = mesh.positions;
  for (Position& p : position_)
    for (double& x : p) x *= scale_;
  return {};
}

MeanValueCage BoundCage::arrays() const {
  return {position_.size(),     edge_.size(),           corner_.size(),          position_.front().data(),
          edge_.front().data(), corner_.front().data(), opposite_.front().data()};
}

std::vector<double> BoundCage::weights_of(std::span<const Position> points) const {
  const MeanValueCage cage = arrays();
  std::vector<double> rows(points.size() * row_size_);
  std::vector<ScratchRow> scratch(mean_value_scratch_rows(cage));
  std::vector<Position> scaled(points.begin(), points.end());
  for (Position& p : scaled)
    for (double& x : p) x *= scale_;
  find_mean_values(
      {&cage, points.size(), scaled.front().data(), rows.data(), row_size_, column_.data(), scratch.front().number});
  return rows;
}

CagePose::CagePose(std::span<const Position> positions) {
  const Extent box = extent(positions);
  centre_ = position(0.5 * box.lower + 0.5 * box.upper);
  for (std::size_t k = 0; k < 3; ++k) {
    coordinate_[k].resize(positions.size());
    for (std::size_t v = 0; v < positions.size(); ++v) coordinate_[k][v] = positions[v][k] - centre_[k];
  }
}

}  // namespace prcage
