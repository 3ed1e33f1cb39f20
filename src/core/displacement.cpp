#include "core/displacement.h"

#include <array>

#include "core/qp3.h"

namespace prcage {
namespace {

// Longer directions belong to vertices whose faces are nearly antiparallel: as good as singular.
constexpr double longest_direction = 50;
// Faces whose height is below this fraction of their longest edge have no reliable normal.
constexpr double thinnest_face = 1e-9;

// Unit normals of the faces at a vertex, with the area-weighted sum.
struct VertexNormals {
  std::vector<double> x, y, z, one;
  Vec3 mean = Vec3::Zero();

  void add(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 n = (b - a).cross(c - a);
    const double length = n.norm();
    const double longest = std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()});
    if (!(length > thinnest_face * longest)) return;
    x.push_back(n.x() / length);
    y.push_back(n.y() / length);
    z.push_back(n.z() / length);
    one.push_back(1);
    mean += n;
  }
  PlaneArrays planes() const { return {x.data(), y.data(), z.data(), one.data(), x.size()}; }
};

}  // namespace

bool displacement_direction(const CornerTable& mesh, std::uint32_t vertex, Vec3& direction) {
  VertexNormals normals;
  for_each_outgoing(mesh, vertex, [&](std::uint32_t h) {
    normals.add(mesh.vec_at(vertex), mesh.vec_at(mesh.target(h)), mesh.vec_at(mesh.apex(h)));
  });
  const Symmetric3 identity{1, 0, 0, 1, 0, 1};
  const QpStatus status = solve_qp3(identity, Vec3::Zero(), normals.planes(), 1e-10, direction);
  if (status == QpStatus::solved && direction.norm() <= longest_direction && !normals.x.empty()) return true;
  const double length = normals.mean.norm();
  direction = length > 0 ? Vec3(normals.mean / length) : Vec3::UnitX();
  return false;
}

}  // namespace prcage
