#include "tools/pose.h"

#include <cmath>
#include <numbers>

#include "core/surface.h"

namespace prcage {
namespace {

// The box of a mesh with its sides in the order in which the deformations use them.
struct Frame {
  Vec3 centre;
  Eigen::Index along, toward, across;  // numbers of the axes
  double length;                       // of the side along

  Frame(const Mesh& mesh, const std::optional<std::size_t>& axis) {
    const Extent box = extent(mesh.positions);
    const Vec3 size = box.upper - box.lower;
    centre = 0.5 * (box.lower + box.upper);
    size.maxCoeff(&along);
    if (axis) along = static_cast<Eigen::Index>(*axis);
    toward = (along + 1) % 3;
    across = (along + 2) % 3;
    if (size[across] < size[toward]) std::swap(toward, across);
    length = size[along];
  }
};

constexpr double radians(double degrees) { return degrees * (std::numbers::pi / 180); }

// `at`: how far along the axis, from -1/2 to 1/2.
void twist(const Frame& frame, double angle, double at, Vec3& p) {
  const double c = std::cos(angle * at), s = std::sin(angle * at);
  const double x = p[frame.toward], y = p[frame.across];
  p[frame.toward] = c * x - s * y;
  p[frame.across] = s * x + c * y;
}

void bend(const Frame& frame, double angle, double at, Vec3& p) {
  const double radius = frame.length / angle;
  const double from_centre = radius - p[frame.toward];
  p[frame.along] = from_centre * std::sin(angle * at);
  p[frame.toward] = radius - from_centre * std::cos(angle * at);
}

}  // namespace

Mesh posed(Mesh mesh, const PoseOptions& options) {
  if (mesh.positions.empty()) return mesh;
  const Frame frame(mesh, options.axis);
  if (!(frame.length > 0)) return mesh;
  for (Position& q : mesh.positions) {
    Vec3 p = vec(q) - frame.centre;
    const double at = p[frame.along] / frame.length;
    if (options.twist != 0) twist(frame, radians(options.twist), at, p);
    if (options.bend != 0) bend(frame, radians(options.bend), at, p);
    q = position(frame.centre + p);
  }
  return mesh;
}

}  // namespace prcage
