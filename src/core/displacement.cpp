#include "core/displacement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/predicates.h"
#include "core/qp3.h"

namespace prcage {
namespace {

// The normals of faces whose height is below this fraction of their longest edge are computed exactly.
constexpr double thinnest_face = 1e-9;
// Faces whose height is below this fraction of the step are cleared with their neighbours, if need be.
constexpr double lowest_face = 0.1;

// Vertices of up to so many faces need no memory from the heap, or little.
constexpr std::size_t usual_valence = 16;

struct AreaVector {
  Vec3 doubled;  // zero if the face has no area
  double height;
};

AreaVector area_vector(const CornerTable& mesh, std::uint32_t h) {
  const Vec3 a = mesh.vec_at(mesh.origin(h)), b = mesh.vec_at(mesh.target(h)), c = mesh.vec_at(mesh.apex(h));
  const Vec3 n = (b - a).cross(c - a);
  const double longest = std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()});
  const double area = std::max(n.norm(), std::numeric_limits<double>::min());
  const double height = area / std::sqrt(longest);
  if (area > thinnest_face * longest) return {n, height};
  Vec3 unit;
  exact::unit_normal(mesh.point(mesh.origin(h)), mesh.point(mesh.target(h)), mesh.point(mesh.apex(h)), unit.data());
  return {area * unit, height};
}

}  // namespace

Vec3 unit_normal(const CornerTable& mesh, std::uint32_t h) { return area_vector(mesh, h).doubled.normalized(); }

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

bool displacement_direction(const CornerTable& mesh, std::uint32_t vertex, double step, Vec3& direction) {
  std::vector<Vec3> normals, of_low_faces;
  normals.reserve(usual_valence);
  Vec3 mean = Vec3::Zero();
  for_each_outgoing(mesh, vertex, [&](std::uint32_t h) {
    const auto [n, height] = area_vector(mesh, h);
    if (n.isZero(0)) return;
    (height < lowest_face * step ? of_low_faces : normals).push_back(n.normalized());
    mean += n;
  });
  const std::size_t others = normals.size();
  normals.insert(normals.end(), of_low_faces.begin(), of_low_faces.end());
  if (clearing_direction(normals, direction)) return true;
  normals.resize(others);
  if (!of_low_faces.empty() && clearing_direction(normals, direction)) return true;
  const double length = mean.norm();
  direction = length > 0 ? Vec3(mean / length) : Vec3(Vec3::UnitX());
  return false;
}

}  // namespace prcage
