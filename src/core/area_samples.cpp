#include "core/area_samples.h"

#include <algorithm>
#include <cmath>

namespace prcage {

AreaSamples::AreaSamples(std::span<const Position> positions, std::span<const Triangle> triangles, std::size_t count,
                         const CounterRandom& random)
    : positions_(positions), triangles_(triangles), count_(count), random_(random) {
  area_up_to_.reserve(triangles.size());
  double sum = 0;
  for (const Triangle& t : triangles) {
    const Vec3 a = vec(positions[t[0]]);
    sum += 0.5 * (vec(positions[t[1]]) - a).cross(vec(positions[t[2]]) - a).norm();
    area_up_to_.push_back(sum);
  }
}

// Faces without area are never found: the sum does not rise at them.
std::uint32_t AreaSamples::face_at(double area) const {
  const double last = std::nextafter(area_up_to_.back(), 0.0);  // rounding may reach the end
  const auto face = std::upper_bound(area_up_to_.begin(), area_up_to_.end(), std::min(area, last));
  return static_cast<std::uint32_t>(face - area_up_to_.begin());
}

AreaSamples::Sample AreaSamples::operator[](std::size_t i) const {
  const auto random = [&](std::size_t k) { return random_.uniform(3 * i + k); };
  const double fraction = (static_cast<double>(i) + random(0)) / static_cast<double>(count_);
  const std::uint32_t face = face_at(fraction * area_up_to_.back());
  const double r = std::sqrt(random(1));  // the strip between r and r + dr, parallel to the side bc, has area ~ r dr
  const double s = random(2);
  const Triangle& t = triangles_[face];
  return {(1 - r) * vec(positions_[t[0]]) + r * (1 - s) * vec(positions_[t[1]]) + r * s * vec(positions_[t[2]]), face};
}

}  // namespace prcage
