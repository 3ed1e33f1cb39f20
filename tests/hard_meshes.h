// Random meshes of the kinds on which cage generators fail: vertices that no direction clears, sheets that nearly
// touch, faces with hardly any area or none. All are legal inputs, or so nearly that only rounding decides.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "random.h"

namespace prcage::testing {

inline double power_of_ten(Random& random, double low, double high) {
  return std::pow(10.0, random.uniform(low, high));
}

// ------------------------------------------------------------------------------------------- singular vertices

// The faces of a sphere on which a random function of low degree is positive, where they hang together.
inline std::vector<Triangle> random_region(const Mesh& sphere, Random& random) {
  const Vec3 axis = random.unit(), u = axis.cross(random.unit()).normalized(), v = axis.cross(u);
  const int lobes = 2 + static_cast<int>(random.below(3));
  const double level = random.uniform(-0.2, 0.2), swing = random.uniform(0.3, 0.9);
  const auto inside = [&](const Triangle& t) {
    const auto [a, b, c] = corners(sphere, t);
    const Vec3 x = (a + b + c).normalized();
    return x.dot(axis) > level + swing * std::cos(lobes * std::atan2(x.dot(v), x.dot(u)));
  };
  std::vector<Triangle> region;
  std::copy_if(sphere.triangles.begin(), sphere.triangles.end(), std::back_inserter(region), inside);
  return region;
}

// A solid with its apex, vertex 0, at the centre of a sphere and a region of it as its base: for most regions with
// several lobes no direction clears all faces at the apex. Empty if the region is no disc.
inline Mesh cone_over_region(Random& random) {
  const Mesh ball = sphere(2);
  std::vector<Triangle> region = random_region(ball, random);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed;
  for (const auto& [a, b, c] : region)
    for (const auto& edge : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) ++directed[edge];
  Mesh cone;
  cone.positions.push_back({0, 0, 0});
  std::map<std::uint32_t, std::uint32_t> number;
  const auto at = [&](std::uint32_t v) {
    const auto [it, is_new] = number.emplace(v, static_cast<std::uint32_t>(cone.positions.size()));
    if (is_new) cone.positions.push_back(ball.positions[v]);
    return it->second;
  };
  for (const auto& [a, b, c] : region) cone.triangles.push_back({at(a), at(b), at(c)});
  for (const auto& [edge, count] : directed)
    if (!directed.contains({edge.second, edge.first})) cone.triangles.push_back({0, at(edge.second), at(edge.first)});
  const Topology found = topology(cone);
  return found.closed_manifold && found.euler == 2 && found.components == 1 ? cone : Mesh{};
}

// A sphere with vertices pulled far out and pushed far in, none next to another: needles and narrow pits.
inline Mesh needles(Random& random) {
  Mesh mesh = sphere(2);
  std::vector<char> taken(mesh.positions.size());
  for (int tries = 0; tries < 40; ++tries) {
    const std::size_t v = random.below(taken.size());
    if (taken[v] != 0) continue;
    for (const Triangle& t : mesh.triangles)
      if (std::find(t.begin(), t.end(), v) != t.end())
        for (const std::uint32_t w : t) taken[w] = 1;
    const double radius = random.below(2) == 0 ? random.uniform(2, 30) : power_of_ten(random, -4, -0.3);
    for (double& x : mesh.positions[v]) x *= radius;
  }
  return mesh;
}

// A thin sector of more than half a turn whose sheets wave up and down: nearly antiparallel faces meet in its centre.
inline Mesh wavy_sector(Random& random) {
  const double swing = random.uniform(0, 0.5), waves = random.uniform(1, 4);
  const Mesh flat = thin_sector(12 + static_cast<std::uint32_t>(random.below(12)), random.uniform(3.3, 6),
                                power_of_ten(random, -9, -1));
  return mapped(flat, [&](const Vec3& p) -> Vec3 {
    return p + Vec3(0, 0, swing * std::sin(waves * std::atan2(p.y(), p.x()))) * std::min(1.0, p.head<2>().norm());
  });
}

// Several such solids side by side.
inline Mesh singular_mesh(std::uint64_t seed) {
  Random random(seed);
  Mesh all;
  for (int i = 0; i < 4; ++i) {
    Mesh part;
    while (part.triangles.empty()) {
      switch (random.below(4)) {
        case 0:
          part = wavy_sector(random);
          break;
        case 1:
          part = saddle_cone(4 + 2 * static_cast<std::uint32_t>(random.below(5)), power_of_ten(random, -1, 2));
          part = scaled(part, 1 / diagonal_of(part));
          break;
        case 2:
          part = needles(random);
          part = scaled(part, 1 / diagonal_of(part));
          break;
        default:
          part = cone_over_region(random);
      }
    }
    all = merge(all, moved(turned(part, random.engine()()), Vec3(4.0 * i, 0, 0)));
  }
  return all;
}

// ------------------------------------------------------------------------------------------- narrow gaps

// Two sheets, or more, at a distance of `gap` from each other; sizes are about 1.
inline Mesh narrow_mesh(std::uint64_t seed, double gap) {
  Random random(seed);
  Mesh mesh;
  switch (random.below(4)) {
    case 0: {  // plates of different grids, one above the other
      const auto cells = [&] { return 2 + static_cast<std::uint32_t>(random.below(6)); };
      mesh = merge(flat_plate(cells(), 1, -0.2, 0), moved(flat_plate(cells(), 1, gap, 0.3), Vec3(0.1, 0.05, 0)));
      break;
    }
    case 1:  // a ball in the hollow of another
      mesh = merge(sphere(2, 1), merge(inside_out(sphere(2, 0.5)), sphere(2, 0.5 - gap)));
      break;
    case 2:  // layers of a folded strip
      mesh = z_fold(random.uniform(0.02, 0.2), gap);
      break;
    default: {  // a wave over another
      const double a = random.uniform(0, 0.1), b = random.uniform(2, 9);
      const auto wave = [=](double x, double y) { return a * std::sin(b * x) * std::cos(b * y); };
      mesh =
          merge(plate(
                    6, 1, [=](double, double) { return -0.3; }, wave),
                plate(
                    6, 1, [=](double x, double y) { return wave(x, y) + gap; }, [=](double, double) { return 0.4; }));
    }
  }
  return turned(mesh, random.engine()());
}

// ------------------------------------------------------------------------------------------- degenerate faces

// Cuts the edge of corner k of triangle t, from a to b, in m, on the side of t only: a triangle a, b, m of no area, or
// of hardly any, keeps the surface closed. `share` is the place of m between a and b, `lift` moves it off the edge,
// into t and up.
inline void add_cap(Mesh& mesh, std::size_t t, std::size_t k, double share, double lift) {
  const Triangle old = mesh.triangles[t];
  const std::uint32_t a = old[k], b = old[(k + 1) % 3], c = old[(k + 2) % 3];
  const Vec3 pa = vec(mesh.positions[a]), pb = vec(mesh.positions[b]), pc = vec(mesh.positions[c]);
  Vec3 m = pa + share * (pb - pa);
  m += lift * (pc - m) + lift * (pb - pa).cross(pc - pa).normalized() * (pb - pa).norm();
  const auto v = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.push_back(position(m));
  mesh.triangles[t] = {a, v, c};
  mesh.triangles.push_back({v, b, c});
  mesh.triangles.push_back({a, b, v});
}

// A body with integer coordinates, and so with exact midpoints, or a round one, with many such caps.
inline Mesh degenerate_mesh(std::uint64_t seed) {
  Random random(seed);
  const bool exact = random.below(2) == 0;
  Mesh mesh = exact ? flat_plate(4, 16, 0, 8) : (random.below(2) == 0 ? torus(16, 8) : sphere(2));
  if (!exact) mesh = turned(mesh, seed);
  for (std::size_t t = 0, n = mesh.triangles.size(); t < n; ++t) {
    if (random.below(3) != 0) continue;
    const double share = random.below(3) == 0 ? power_of_ten(random, -9, -1) : 0.5;
    const bool flat = exact && random.below(2) == 0;
    add_cap(mesh, t, random.below(3), flat ? 0.5 : share, flat ? 0 : power_of_ten(random, -12, -2));
  }
  return mesh;
}

}  // namespace prcage::testing
