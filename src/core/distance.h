// Distance from points to a triangle in double precision.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/vec3.h"

namespace prcage {

// A triangle prepared for distance questions from several points. It may be degenerate. Distances are those to a point
// of the closed triangle up to rounding: within some 1e-12 of the triangle's size above or below the true ones.
class TriangleDistance {
 public:
  TriangleDistance(const Vec3& a, const Vec3& b, const Vec3& c)
      : corner_{a, b, c}, edge_{b - a, c - b, a - c}, normal_(edge_[2].cross(edge_[0])), nn_(normal_.squaredNorm()) {
    const double longest = std::max({edge_[0].squaredNorm(), edge_[1].squaredNorm(), edge_[2].squaredNorm()});
    // Slivers have no reliable plane; all of their points are near their edges.
    if (!(nn_ > 1e-8 * longest * longest)) nn_ = 0;
    beta_ = normal_.cross(edge_[2]);
    gamma_ = normal_.cross(edge_[0]);
  }

  double squared(const Vec3& x) const {
    const Vec3 ax = x - corner_[0];
    // Barycentric coordinates of b and c, times nn_: never all positive and less than one if there is no plane.
    const double v = beta_.dot(ax);
    const double w = gamma_.dot(ax);
    if (v > 0 && w > 0 && v + w < nn_) {
      const double height = normal_.dot(ax);
      return height * height / nn_;
    }
    return std::min({squared_to_edge(0, ax), squared_to_edge(1, x - corner_[1]), squared_to_edge(2, x - corner_[2])});
  }

  // Barycentric coordinates of the point of the triangle that is nearest to x.
  std::array<double, 3> nearest_weights(const Vec3& x) const {
    const Vec3 ax = x - corner_[0];
    const double v = beta_.dot(ax), w = gamma_.dot(ax);
    if (v > 0 && w > 0 && v + w < nn_) return {(nn_ - v - w) / nn_, v / nn_, w / nn_};
    std::array<double, 3> weights{};
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 from_start = x - corner_[i];
      const double d = squared_to_edge(static_cast<int>(i), from_start);
      if (!(d < least)) continue;
      least = d;
      const double along = from_start.dot(edge_[i]), length = edge_[i].squaredNorm();
      const double share = along > 0 ? std::min(along / length, 1.0) : 0;
      weights = {};
      weights[i] = 1 - share;
      weights[(i + 1) % 3] = share;
    }
    return weights;
  }

  // Of the points of a triangle: the distance to a convex set is largest at a corner.
  double largest_squared(const std::array<Vec3, 3>& corners) const {
    return std::max({squared(corners[0]), squared(corners[1]), squared(corners[2])});
  }

 private:
  double squared_to_edge(int i, const Vec3& from_start) const {
    const double along = from_start.dot(edge_[i]);
    if (!(along > 0)) return from_start.squaredNorm();
    const double length = edge_[i].squaredNorm();
    return (from_start - (along < length ? along / length : 1) * edge_[i]).squaredNorm();
  }

  Vec3 corner_[3];
  Vec3 edge_[3];
  Vec3 normal_;
  double nn_;  // squared length of the normal, zero if there is no plane
  Vec3 beta_;
  Vec3 gamma_;
};

}  // namespace prcage
