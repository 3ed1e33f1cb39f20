// Distance from points to a triangle in double precision.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/vec3.h"

namespace prcage {

// A triangle prepared for distance questions from several points. It may be degenerate. Distances are those to a point
// of the closed triangle up to rounding: within some 1e-12 of the triangle's size above or below the true ones.
class TriangleDistance {
 public:
  TriangleDistance(const Vec3& a, const Vec3& b, const Vec3& c) : corner_{a, b, c}, edge_{b - a, c - b, a - c} {
    const Vec3 normal = edge_[2].cross(edge_[0]);
    const double nn = normal.squaredNorm();
    double longest = 0;
    for (int i = 0; i < 3; ++i) {
      const double ee = edge_[i].squaredNorm();
      over_length_[i] = ee > 0 ? 1 / ee : 0;
      longest = std::max(longest, ee);
    }
    // Slivers have no reliable plane; all of their points are near their edges.
    if (!(nn > 1e-8 * longest * longest)) return;
    unit_normal_ = normal / std::sqrt(nn);
    beta_ = normal.cross(edge_[2]) / nn;
    gamma_ = normal.cross(edge_[0]) / nn;
  }

  double squared(const Vec3& x) const {
    const Vec3 ax = x - corner_[0];
    // Barycentric coordinates of b and c; never all positive if there is no plane.
    const double v = beta_.dot(ax);
    const double w = gamma_.dot(ax);
    if (v > 0 && w > 0 && v + w < 1) {
      const double height = unit_normal_.dot(ax);
      return height * height;
    }
    return std::min({squared_to_edge(0, ax), squared_to_edge(1, x - corner_[1]), squared_to_edge(2, x - corner_[2])});
  }

 private:
  double squared_to_edge(int i, const Vec3& from_start) const {
    const double t = std::clamp(from_start.dot(edge_[i]) * over_length_[i], 0.0, 1.0);
    return (from_start - t * edge_[i]).squaredNorm();
  }

  Vec3 corner_[3];
  Vec3 edge_[3];
  double over_length_[3];
  Vec3 unit_normal_ = Vec3::Zero();
  Vec3 beta_ = Vec3::Zero();
  Vec3 gamma_ = Vec3::Zero();
};

}  // namespace prcage
