#include "parallel/misfit.h"

#include <cmath>

namespace prcage {

double misfit(const DistanceBand& band, const Corners& p, std::uint32_t hint, double unit) {
  constexpr Barycentric samples[] = {{1 / 3.0, 1 / 3.0, 1 / 3.0},
                                     {2 / 3.0, 1 / 6.0, 1 / 6.0},
                                     {1 / 6.0, 2 / 3.0, 1 / 6.0},
                                     {1 / 6.0, 1 / 6.0, 2 / 3.0}};
  const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
  double sum = 0;
  for (const Barycentric& weights : samples) {
    const DistanceBand::Near near = band.nearest(at(p, weights), hint);
    hint = near.face;
    const Vec3 wanted = band.area_normal(hint);
    const double units = near.distance / unit;
    sum += std::atan2(normal.cross(wanted).norm(), normal.dot(wanted)) + misfit_of_unit * units * units;
  }
  return 0.5 * normal.norm() * sum / std::size(samples);
}

}  // namespace prcage
