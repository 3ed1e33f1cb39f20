#include "core/placement.h"

#include <cmath>
#include <limits>

namespace prcage {
namespace {

// A face of a star in the local frame of its edge.
struct LocalFace {
  Vec3 normal;    // unit
  double offset;  // normal . centroid, local
  double area;    // local
};

// False for faces too thin to have a reliable normal: they carry no linear constraint, the exact tests carry them.
bool local_face(const Vec3& a, const Vec3& b, const Vec3& c, LocalFace& face) {
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 n = ab.cross(ac);
  const double length = n.norm();
  const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (c - b).squaredNorm()});
  if (!(length > 1e-9 * longest)) return false;
  face.normal = n / length;
  face.area = 0.5 * length;
  face.offset = face.normal.dot(a + b + c) / 3;
  return true;
}

class Gatherer {
 public:
  Gatherer(const CornerTable& mesh, const std::vector<float>& face_distance, const PlacementSettings& settings,
           PlacementBatch& batch, std::uint32_t halfedge)
      : mesh_(mesh), face_distance_(face_distance), settings_(settings), batch_(batch) {
    const Vec3 a = mesh.vec_at(mesh.origin(halfedge));
    const Vec3 b = mesh.vec_at(mesh.target(halfedge));
    origin_ = 0.5 * (a + b);
    scale_ = std::max((b - a).norm(), settings.min_scale);
    margin_ = settings.margin + settings.absolute_margin / scale_;
  }

  // The face of outgoing halfedge g. Its slab constraint, its quadric and, unless it dies, its orientation constraint.
  void add_face(std::uint32_t g, bool dies) {
    const Vec3 moving = local(mesh_.origin(g));
    const Vec3 v1 = local(mesh_.target(g));
    const Vec3 v2 = local(mesh_.apex(g));
    LocalFace face;
    if (!local_face(moving, v1, v2, face)) return;
    const HeightInterval height = settings_.band(face_distance_[g / 3]);
    add_plane(face.normal, face.offset + height.lower / scale_ + margin_);
    add_plane(-face.normal, -(face.offset + height.upper / scale_));
    form_.add_outer(face.normal, face.area);
    linear_ -= face.area * face.offset * face.normal;
    constant_ += 0.5 * face.area * face.offset * face.offset;
    if (!dies) add_orientation(face, v1, v2);
  }

  void finish(std::uint32_t halfedge) {
    batch_.halfedge.push_back(halfedge);
    batch_.first_plane.push_back(static_cast<std::uint32_t>(batch_.nx.size()));
    batch_.form.push_back(form_);
    batch_.linear.push_back(linear_);
    batch_.constant.push_back(constant_);
    batch_.origin.push_back(origin_);
    batch_.scale.push_back(scale_);
  }

 private:
  Vec3 local(std::uint32_t v) const { return (mesh_.vec_at(v) - origin_) / scale_; }

  void add_plane(const Vec3& n, double offset) {
    batch_.nx.push_back(n.x());
    batch_.ny.push_back(n.y());
    batch_.nz.push_back(n.z());
    batch_.offset.push_back(offset);
  }

  // Eq. 5, divided by the length of the edge v1 v2: the height of p over that edge, in the plane of the face.
  void add_orientation(const LocalFace& face, const Vec3& v1, const Vec3& v2) {
    const Vec3 edge = v2 - v1;
    const double length = edge.norm();
    const Vec3 inward = face.normal.cross(edge) / length;
    const double height = 2 * face.area / length;
    add_plane(inward, inward.dot(v1) + settings_.height_fraction * height);
  }

  const CornerTable& mesh_;
  const std::vector<float>& face_distance_;
  const PlacementSettings& settings_;
  PlacementBatch& batch_;
  Vec3 origin_;
  double scale_;
  double margin_;
  Symmetric3 form_;
  Vec3 linear_ = Vec3::Zero();
  double constant_ = 0;
};

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
  const Vec3 p = batch.origin[i] + batch.scale[i] * x;
  batch.solution[i] = settings.float_positions ? round_to_floats(p) : position(p);
  const double error = x.dot(0.5 * (batch.form[i] * x) + batch.linear[i]) + batch.constant[i];
  // Among equally good collapses (flat regions) the short edge goes first.
  const double s2 = batch.scale[i] * batch.scale[i];
  batch.cost[i] = (std::max(0.0, 2 * error) + 1e-9) * s2 * s2;
}

}  // namespace

void PlacementBatch::clear() {
  halfedge.clear();
  first_plane.clear();
  for (auto* plane : {&nx, &ny, &nz, &offset}) plane->clear();
  form.clear();
  linear.clear();
  constant.clear();
  origin.clear();
  scale.clear();
}

void gather_placement(const CornerTable& mesh, const std::vector<float>& face_distance, std::uint32_t halfedge,
                      const PlacementSettings& settings, PlacementBatch& batch) {
  if (batch.first_plane.empty()) batch.first_plane.push_back(0);
  Gatherer gatherer(mesh, face_distance, settings, batch, halfedge);
  const std::uint32_t twin = mesh.twin[halfedge];
  for (const std::uint32_t side : {halfedge, twin}) {
    // Around the origin of `side`: its own face first, then all others up to the face of the other side, which the
    // second pass adds.
    std::uint32_t g = side;
    do {
      if (g / 3 != mesh.twin[side] / 3) gatherer.add_face(g, g == side);
      g = mesh.next_around(g);
    } while (g != side);
  }
  gatherer.finish(halfedge);
}

void solve_placements(const PlacementSettings& settings, PlacementBatch& batch) {
  const std::size_t n = batch.size();
  for (auto* values : {&batch.scaled_linear, &batch.x}) values->resize(n);
  batch.scaled_form.resize(n);
  batch.status.resize(n);
  batch.solution.resize(n);
  batch.cost.resize(n);
  if (n == 0) return;
  for (std::size_t i = 0; i < n; ++i) scale_problem(settings, batch, i);
  const Qp3Batch problems{batch.scaled_form, batch.scaled_linear, batch.first_plane, batch.nx, batch.ny,
                          batch.nz,          batch.offset};
  solve_qp3_batch(problems, 1e-10, batch.x, batch.status, settings.simd);
  for (std::size_t i = 0; i < n; ++i) read_solution(settings, batch, i);
}

}  // namespace prcage
