// Points spread over a triangle for questions that a few samples answer: those with barycentric coordinates in
// quarters.
#pragma once

#include <array>

#include "core/vec3.h"

namespace prcage {

using Barycentric = std::array<double, 3>;
using Corners = std::array<Vec3, 3>;

constexpr int lattice_steps = 4;
constexpr int lattice_points = (lattice_steps + 1) * (lattice_steps + 2) / 2;

inline Vec3 at(const Corners& p, const Barycentric& w) { return w[0] * p[0] + w[1] * p[1] + w[2] * p[2]; }

// visit(barycentric coordinates)
template <class Visit>
void for_each_lattice_point(const Visit& visit) {
  constexpr double step = 1.0 / lattice_steps;
  for (int i = 0; i <= lattice_steps; ++i)
    for (int j = 0; i + j <= lattice_steps; ++j) visit(Barycentric{i * step, j * step, (lattice_steps - i - j) * step});
}

}  // namespace prcage
