// How badly faces of a cage fit the input: what the polish of a finished cage lowers. Volume alone would do without it:
// the angle between the normals, and the squares of distances, of which a few large ones count.
#pragma once

#include "core/lattice.h"
#include "parallel/distance_band.h"

namespace prcage {

// A distance of one unit, about the thickness that such a cage needs, is as bad as this angle, radians.
inline constexpr double misfit_of_unit = 3;

// The integral over the triangle, by four samples, of the angle between its normal and the input's and of the square of
// its distance in units. `hint`: a face of the input near by. Thread-safe.
double misfit(const DistanceBand& band, const Corners& p, std::uint32_t hint, double unit);

// The same of samples of the input, each of which stands for `sample_area`: by how much the sum rises if that of the
// squares of their distances rises by `squares`.
inline double misfit_of_samples(double squares, double sample_area, double unit) {
  return misfit_of_unit * sample_area * squares / (unit * unit);
}

}  // namespace prcage
