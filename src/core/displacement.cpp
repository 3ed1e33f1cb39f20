#include "core/displacement.h"

#include <algorithm>
#include <array>
#include <vector>

#include "core/qp3.h"

namespace prcage {
namespace {

// Faces whose height is below this fraction of their longest edge have no reliable normal.
constexpr double thinnest_face = 1e-9;

// Vertices of up to so many faces need no memory from the heap, or little.
constexpr std::size_t usual_valence = 16;

// Twice the area vector of the face of a halfedge; zero if the face is too thin.
Vec3 area_vector(const CornerTable& mesh, std::uint32_t h) {
  const Vec3 a = mesh.vec_at(mesh.origin(h)), b = mesh.vec_at(mesh.target(h)), c = mesh.vec_at(mesh.apex(h));
  const Vec3 n = (b - a).cross(c - a);
  const double longest = std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()});
  return n.norm() > thinnest_face * longest ? n : Vec3(Vec3::Zero());
}

}  // namespace

Vec3 reliable_normal(const CornerTable& mesh, std::uint32_t h) { return area_vector(mesh, h).normalized(); }

bool clearing_direction(std::span<const Vec3> normals, Vec3& direction) {
  if (normals.empty()) return false;
  const std::size_t n = normals.size();
  std::array<double, 4 * usual_valence> few;
  std::vector<double> many;
  if (n > usual_valence) many.resize(4 * n);
  double* const planes = many.empty() ? few.data() : many.data();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < 3; ++k) planes[k * n + i] = normals[i][static_cast<int>(k)];
    planes[3 * n + i] = 1;
  }
  const PlaneArrays arrays{planes, planes + n, planes + 2 * n, planes + 3 * n, n};
  return solve_qp3({1, 0, 0, 1, 0, 1}, Vec3::Zero(), arrays, 1e-10, direction) == QpStatus::solved;
}

bool displacement_direction(const CornerTable& mesh, std::uint32_t vertex, Vec3& direction) {
  std::vector<Vec3> normals;
  normals.reserve(usual_valence);
  Vec3 mean = Vec3::Zero();
  for_each_outgoing(mesh, vertex, [&](std::uint32_t h) {
    const Vec3 n = area_vector(mesh, h);
    if (n.isZero(0)) return;
    normals.push_back(n.normalized());
    mean += n;
  });
  if (clearing_direction(normals, direction)) return true;
  const double length = mean.norm();
  direction = length > 0 ? Vec3(mean / length) : Vec3(Vec3::UnitX());
  return false;
}

}  // namespace prcage
