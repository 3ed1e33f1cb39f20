// Contender: the baseline of the paper's sec. 4.3 (Fig. 14). An outer offset surface of the input, then edge collapses
// by quadric error (Garland and Heckbert 1997) in the order of one priority queue; a collapse is discarded if a new
// face would touch the input. Built of prcage's own parts: OpenVDB for the offset, the corner table with its link
// condition, Embree's trees and the exact predicates. As in the paper, nothing keeps the topology of the input, nor
// the surface from meeting itself.
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

#include "core/corner_table.h"
#include "core/surface.h"
#include "parallel/arena.h"
#include "parallel/intersections.h"
#include "perf/rival.h"

namespace prcage::perf {
namespace {

// ---------------------------------------------------------------------------------------------- the offset

// Half the offset, but neither too coarse for the shape nor finer than somebody would wait for.
double voxel_size(double offset, double diagonal) { return std::clamp(offset / 2, diagonal / 250, diagonal / 100); }

Mesh offset_surface(const Mesh& input, double offset, double voxel) {
  std::vector<openvdb::Vec3s> points;
  for (const auto& p : input.positions)
    points.emplace_back(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& t : input.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  std::vector<openvdb::Vec4I> quads;
  const auto band = static_cast<float>(offset / voxel) + 3;
  const auto grid = openvdb::tools::meshToSignedDistanceField<openvdb::FloatGrid>(
      *openvdb::math::Transform::createLinearTransform(voxel), points, triangles, quads, band, 3);
  points.clear();
  triangles.clear();
  openvdb::tools::volumeToMesh(*grid, points, triangles, quads, offset);
  Mesh surface;
  for (const openvdb::Vec3s& p : points) surface.positions.push_back({p.x(), p.y(), p.z()});
  for (const openvdb::Vec4I& q : quads) {  // clockwise seen from outside
    surface.triangles.push_back({q[0], q[2], q[1]});
    surface.triangles.push_back({q[0], q[3], q[2]});
  }
  return surface;
}

// -------------------------------------------------------------------------------------------------- quadric

// x^T a x - 2 b^T x + c: weighted squared distances to planes.
struct Quadric {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Vec3 b = Vec3::Zero();
  double c = 0;

  void add_plane(const Vec3& normal, const Vec3& point, double weight) {
    const double d = normal.dot(point);
    a += weight * normal * normal.transpose();
    b += weight * d * normal;
    c += weight * d * d;
  }
  Quadric& operator+=(const Quadric& other) {
    a += other.a;
    b += other.b;
    c += other.c;
    return *this;
  }
  double operator()(const Vec3& x) const { return std::max(0.0, x.dot(a * x - 2 * b) + c); }

  // The minimum, near `start` where the planes leave it open.
  Vec3 minimum(const Vec3& start) const {
    constexpr double regularization = 1e-6;
    const Eigen::Matrix3d form = a + regularization * (a.trace() + 1e-300) * Eigen::Matrix3d::Identity();
    const Vec3 step = form.ldlt().solve(b - a * start);
    return start + step;
  }
};

// ------------------------------------------------------------------------------------------------ the input

// Says whether triangles touch the input.
class Forbidden {
 public:
  explicit Forbidden(const Mesh& input) : tree_(device_) {
    tree_.build(unit_frame(input.positions), input.positions, input.triangles);
  }

  bool touched_by(const Position& a, const Position& b, const Position& c) const {
    Query query{this, {a.data(), b.data(), c.data()}, bounding_box(tree_.frame(), {a.data(), b.data(), c.data()})};
    RTCPointQuery ball{};
    float squared = 0;
    float* const centre[3] = {&ball.x, &ball.y, &ball.z};
    for (int k = 0; k < 3; ++k) {
      *centre[k] = 0.5f * (query.box.lower[k] + query.box.upper[k]);
      const float half = query.box.upper[k] - *centre[k];
      squared += half * half;
    }
    ball.radius = std::sqrt(squared) * 1.0001f + 1e-6f;
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(tree_.runs().tree().scene(), &ball, &context, visit, &query);
    return query.hit;
  }

 private:
  struct Query {
    const Forbidden* forbidden;
    const double* corners[3];
    Box box;
    bool hit = false;
  };

  // Embree calls this for runs of faces whose box may be in the ball.
  static bool visit(RTCPointQueryFunctionArguments* args) {
    auto& query = *static_cast<Query*>(args->userPtr);
    if (query.hit) return false;
    const SurfaceTree& tree = query.forbidden->tree_;
    tree.runs().for_each_overlap(args->primID, query.box, [&](std::uint32_t f) {
      query.hit = query.hit || touch(query.corners, tree.triangle(f).p);
    });
    if (query.hit) args->query->radius = 0;  // nothing more to look for
    return query.hit;
  }

  TreeDevice device_;
  SurfaceTree tree_;
};

// --------------------------------------------------------------------------------------------- simplification

class Simplifier {
 public:
  Simplifier(const Mesh& surface, const Forbidden& forbidden)
      : mesh_(CornerTable::from_mesh(surface)),
        forbidden_(forbidden),
        faces_(surface.triangles.size()),
        quadric_(surface.positions.size()),
        version_(surface.positions.size()) {
    for (std::uint32_t h = 0; h < mesh_.corner_vertex.size(); h += 3) add_quadrics(h);
    for (std::uint32_t h = 0; h < mesh_.corner_vertex.size(); ++h)
      if (h < mesh_.twin[h]) push(h);
  }

  Mesh run(std::size_t target_faces) && {
    while (faces_ > target_faces && !queue_.empty()) {
      const Collapse collapse = queue_.top();
      queue_.pop();
      if (up_to_date(collapse) && allowed(collapse)) commit(collapse);
    }
    return mesh_.to_mesh();
  }

 private:
  struct Collapse {
    double cost;
    std::uint32_t halfedge;
    std::array<std::uint32_t, 2> ends;
    std::array<std::uint32_t, 2> versions;
    Position point;

    bool operator>(const Collapse& o) const { return cost != o.cost ? cost > o.cost : halfedge > o.halfedge; }
  };

  void add_quadrics(std::uint32_t h) {
    const Vec3 a = mesh_.vec_at(mesh_.origin(h)), b = mesh_.vec_at(mesh_.target(h)), c = mesh_.vec_at(mesh_.apex(h));
    const Vec3 normal = (b - a).cross(c - a);
    if (normal.squaredNorm() == 0) return;
    for (const std::uint32_t corner : {h, h + 1, h + 2})
      quadric_[mesh_.origin(corner)].add_plane(normal.normalized(), a, normal.norm() / 6);
  }

  void push(std::uint32_t h) {
    const std::uint32_t a = mesh_.origin(h), b = mesh_.target(h);
    Quadric sum = quadric_[a];
    sum += quadric_[b];
    const Vec3 point = sum.minimum(0.5 * (mesh_.vec_at(a) + mesh_.vec_at(b)));
    queue_.push({sum(point), h, {a, b}, {version_[a], version_[b]}, position(point)});
  }

  // Halfedges keep their numbers, but may come to lie on other edges or die.
  bool up_to_date(const Collapse& c) const {
    return mesh_.corner_vertex[c.halfedge] == c.ends[0] && mesh_.target(c.halfedge) == c.ends[1] &&
           version_[c.ends[0]] == c.versions[0] && version_[c.ends[1]] == c.versions[1];
  }

  bool allowed(const Collapse& c) const {
    if (!link_condition(mesh_, c.halfedge)) return false;
    bool free = true;
    for (const std::uint32_t end : c.ends) {
      for_each_outgoing(mesh_, end, [&](std::uint32_t h) {
        const std::uint32_t b = mesh_.target(h), d = mesh_.apex(h);
        const bool dies = b == c.ends[0] || b == c.ends[1] || d == c.ends[0] || d == c.ends[1];
        if (free && !dies)
          free = !folds(h, c.point) && !forbidden_.touched_by(c.point, mesh_.position[b], mesh_.position[d]);
      });
    }
    return free;
  }

  // Would the face turn by more than some 80 degrees, or lose its area?
  bool folds(std::uint32_t h, const Position& point) const {
    const Vec3 a = mesh_.vec_at(mesh_.origin(h)), b = mesh_.vec_at(mesh_.target(h)), c = mesh_.vec_at(mesh_.apex(h));
    const Vec3 before = (b - a).cross(c - a), after = (b - vec(point)).cross(c - vec(point));
    return after.dot(before) <= 0.2 * after.norm() * before.norm();
  }

  void commit(const Collapse& c) {
    collapse_edge(mesh_, c.halfedge, c.point);
    faces_ -= 2;
    const std::uint32_t v = c.ends[0];
    quadric_[v] += quadric_[c.ends[1]];
    ++version_[v];
    ++version_[c.ends[1]];
    for_each_outgoing(mesh_, v, [&](std::uint32_t h) { push(h); });
  }

  CornerTable mesh_;
  const Forbidden& forbidden_;
  std::size_t faces_;
  std::vector<Quadric> quadric_;
  std::vector<std::uint32_t> version_;
  std::priority_queue<Collapse, std::vector<Collapse>, std::greater<>> queue_;
};

// A closed manifold, which is what the corner table takes.
bool usable(const Mesh& surface) {
  if (surface.triangles.empty()) return false;
  const EdgeGroups edges = group_edges(surface.triangles, surface.positions.size());
  EdgeDefects defects;
  pair_halfedges(surface.triangles, edges, defects);
  return defects.empty() && non_manifold_vertices(surface.triangles, surface.positions.size(), edges).empty();
}

class Baseline {
 public:
  Baseline(const Mesh& input, std::size_t faces)
      : input_(input), faces_(faces), diagonal_(extent(input.positions).diagonal()), forbidden_(input) {}

  Attempt attempt(double relative_offset) const {
    const double offset = relative_offset * diagonal_, voxel = voxel_size(offset, diagonal_);
    const auto start = std::chrono::steady_clock::now();
    Attempt attempt;
    const Mesh surface = offset_surface(input_, offset, voxel);
    if (usable(surface)) attempt.cage = Simplifier(surface, forbidden_).run(faces_);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    attempt.seconds = seconds.count();
    attempt.settings = {
        {"offset", relative_offset}, {"voxel", voxel / diagonal_}, {"offset_faces", surface.triangles.size()}};
    return attempt;
  }

 private:
  const Mesh& input_;
  std::size_t faces_;
  double diagonal_;
  Forbidden forbidden_;
};

Search search_offsets(const Mesh& input, std::size_t faces) {
  openvdb::initialize();
  Search search;
  Arena(1).run([&] {
    const Baseline baseline(input, faces);
    search = tightest_attempt(input, faces, [&](double offset) { return baseline.attempt(offset); });
  });
  return search;
}

}  // namespace
}  // namespace prcage::perf

int main(int argc, char** argv) { return prcage::perf::rival_main(argc, argv, prcage::perf::search_offsets); }
