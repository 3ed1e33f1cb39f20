// Small solids for tests, and what can be done to them: moved, merged, turned inside out, compared.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "core/prcage.h"

namespace prcage::testing {

// Axis-aligned cube with 8 vertices and 12 faces, outward.
inline Mesh cube(double size = 1, std::array<double, 3> centre = {0, 0, 0}) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back({centre[0] + ((i & 1) != 0 ? 0.5 : -0.5) * size,
                              centre[1] + ((i & 2) != 0 ? 0.5 : -0.5) * size,
                              centre[2] + ((i & 4) != 0 ? 0.5 : -0.5) * size});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

inline Mesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
}

// Octahedron, each face cut into four `levels` times, vertices on the sphere: 8 * 4^levels faces.
inline Mesh sphere(int levels, double radius = 1, std::array<double, 3> centre = {0, 0, 0}) {
  Mesh mesh{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
            {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoints;
    const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
      const auto [it, is_new] = midpoints.emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.positions.size()));
      if (is_new) {
        std::array<double, 3> m;
        for (std::size_t k = 0; k < 3; ++k) m[k] = mesh.positions[a][k] + mesh.positions[b][k];
        const double length = std::sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
        for (double& x : m) x /= length;
        mesh.positions.push_back(m);
      }
      return it->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (auto& p : mesh.positions)
    for (std::size_t k = 0; k < 3; ++k) p[k] = centre[k] + radius * p[k];
  return mesh;
}

// Torus round the z axis.
inline Mesh torus(std::uint32_t around = 24, std::uint32_t across = 12, double radius = 1, double thickness = 0.3) {
  Mesh mesh;
  const double turn = 2 * std::acos(-1.0);
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const double u = turn * i / around, v = turn * j / across;
      const double r = radius + thickness * std::cos(v);
      mesh.positions.push_back({r * std::cos(u), r * std::sin(u), thickness * std::sin(v)});
    }
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const std::uint32_t i1 = (i + 1) % around, j1 = (j + 1) % across;
      const std::uint32_t a = i * across + j, b = i1 * across + j, c = i1 * across + j1, d = i * across + j1;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

inline Mesh inside_out(Mesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

inline Mesh merge(Mesh a, const Mesh& b) {
  const auto offset = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  return a;
}

inline Mesh scaled(Mesh mesh, double factor) {
  for (auto& p : mesh.positions)
    for (double& x : p) x *= factor;
  return mesh;
}

// Faces in random order, corners of each turned at random.
inline Mesh shuffled(Mesh mesh, unsigned seed) {
  std::mt19937 random(seed);
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
  for (auto& t : mesh.triangles) std::rotate(t.begin(), t.begin() + static_cast<int>(random() % 3), t.end());
  return mesh;
}

}  // namespace prcage::testing
