// What the built-in shapes are made with: deterministic numbers and trigonometry, and the grid on the surface of a box,
// from which all star-shaped bodies and plates are made. For the sources of the shapes only.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/vec3.h"

namespace prcage::shape {

inline constexpr double pi = 3.14159265358979323846;

// ------------------------------------------------------------------------------------- deterministic numbers

// Finaliser of SplitMix64 (Steele, Lea, Flood 2014): a bijection of 64 bits without visible structure.
inline std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  double uniform(double low, double high) {
    state_ += 0x9e3779b97f4a7c15u;
    return low + (high - low) * (static_cast<double>(mix(state_) >> 11) * 0x1p-53);
  }

 private:
  std::uint64_t state_;
};

struct CosSin {
  double cos, sin;
};

// Cosine and sine of t full turns. Reduced to an eighth of a turn, where the Taylor series is good to the last
// bits; the C library's functions differ in the last bit between machines.
inline CosSin turn(double t) {
  const double quarter = std::floor(4 * t + 0.5);
  const double a = 2 * pi * (t - quarter / 4);
  const double x = a * a;
  double c = 1, s = 1;
  for (int n = 16; n >= 2; n -= 2) {
    c = 1 - c * x / (n * (n - 1));
    s = 1 - s * x / (n * (n + 1));
  }
  s *= a;
  switch (static_cast<long long>(quarter) & 3) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    default:
      return {s, -c};
  }
}

inline std::uint32_t index(std::size_t i) { return static_cast<std::uint32_t>(i); }

inline std::size_t at_least(std::size_t low, double x) {
  return x <= static_cast<double>(low) ? low : static_cast<std::size_t>(std::floor(x + 0.5));
}

// ----------------------------------------------------------------------------------------- grids and building

// Replaces every position by map(position), in parallel: map is pure.
template <class Map>
void map_positions(Mesh& mesh, const Map& map) {
  tbb::parallel_for(std::size_t{0}, mesh.positions.size(),
                    [&](std::size_t v) { mesh.positions[v] = position(map(vec(mesh.positions[v]))); });
}

inline void add_quad(Mesh& mesh, std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
  mesh.triangles.push_back({index(a), index(b), index(c)});
  mesh.triangles.push_back({index(a), index(c), index(d)});
}

// Turns a body inside out: the boundary of a hollow.
inline void reverse_orientation(Mesh& mesh) {
  for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

inline void append(Mesh& mesh, const Mesh& other) {
  const std::uint32_t first = index(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  mesh.triangles.reserve(mesh.triangles.size() + other.triangles.size());
  for (const Triangle& t : other.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

using Cells = std::array<std::size_t, 3>;

// Cells along x, y, z of a box with these side lengths, roughly square, so that the surface has about `faces`
// triangles. The last one is solved for, which brings the count within half a row of cells.
inline Cells box_cells(std::size_t faces, const Vec3& sides) {
  const double squares = static_cast<double>(faces) / 4;
  const double area = sides.x() * sides.y() + sides.y() * sides.z() + sides.z() * sides.x();
  const double scale = std::sqrt(squares / area);
  const std::size_t x = at_least(1, scale * sides.x()), y = at_least(1, scale * sides.y());
  const double xy = static_cast<double>(x * y);
  return {x, y, at_least(1, (squares - xy) / static_cast<double>(x + y))};
}

// Numbering of the lattice points on the surface of a box: the full layer k = 0, the rims of the inner layers,
// the full layer k = c.
class BoxSurface {
 public:
  explicit BoxSurface(const Cells& cells)
      : a_(cells[0]), b_(cells[1]), c_(cells[2]), layer_((a_ + 1) * (b_ + 1)), rim_(2 * (a_ + b_)) {}

  std::size_t vertex_count() const { return 2 * layer_ + (c_ - 1) * rim_; }
  std::size_t face_count() const { return 4 * (a_ * b_ + b_ * c_ + c_ * a_); }

  std::size_t vertex(std::size_t i, std::size_t j, std::size_t k) const {
    if (k == 0) return j * (a_ + 1) + i;
    if (k == c_) return layer_ + (c_ - 1) * rim_ + j * (a_ + 1) + i;
    return layer_ + (k - 1) * rim_ + on_rim(i, j);
  }

 private:
  std::size_t on_rim(std::size_t i, std::size_t j) const {
    if (j == 0) return i;
    if (i == a_) return a_ + j;
    if (j == b_) return a_ + b_ + (a_ - i);
    return 2 * a_ + b_ + (b_ - j);
  }

  std::size_t a_, b_, c_, layer_, rim_;
};

inline void set_box_positions(const Cells& n, const BoxSurface& surface, Mesh& mesh) {
  mesh.positions.resize(surface.vertex_count());
  const auto coordinate = [](std::size_t i, std::size_t cells) {
    return 2 * static_cast<double>(i) / static_cast<double>(cells) - 1;
  };
  for (std::size_t k = 0; k <= n[2]; ++k) {
    for (std::size_t j = 0; j <= n[1]; ++j) {
      const bool whole_row = k == 0 || k == n[2] || j == 0 || j == n[1];
      for (std::size_t i = 0; i <= n[0]; i += whole_row ? 1 : n[0]) {
        mesh.positions[surface.vertex(i, j, k)] = {coordinate(i, n[0]), coordinate(j, n[1]), coordinate(k, n[2])};
      }
    }
  }
}

inline void add_box_faces(const Cells& n, const BoxSurface& surface, Mesh& mesh) {
  mesh.triangles.reserve(surface.face_count());
  // One side of the box: `at(u, v)` numbers its lattice, u x v points outward.
  const auto add_side = [&](std::size_t u_cells, std::size_t v_cells, const auto& at) {
    for (std::size_t v = 0; v < v_cells; ++v) {
      for (std::size_t u = 0; u < u_cells; ++u) add_quad(mesh, at(u, v), at(u + 1, v), at(u + 1, v + 1), at(u, v + 1));
    }
  };
  add_side(n[1], n[0], [&](std::size_t j, std::size_t i) { return surface.vertex(i, j, 0); });
  add_side(n[0], n[1], [&](std::size_t i, std::size_t j) { return surface.vertex(i, j, n[2]); });
  add_side(n[0], n[2], [&](std::size_t i, std::size_t k) { return surface.vertex(i, 0, k); });
  add_side(n[2], n[0], [&](std::size_t k, std::size_t i) { return surface.vertex(i, n[1], k); });
  add_side(n[2], n[1], [&](std::size_t k, std::size_t j) { return surface.vertex(0, j, k); });
  add_side(n[1], n[2], [&](std::size_t j, std::size_t k) { return surface.vertex(n[0], j, k); });
}

// The cube [-1, 1]^3 with its sides cut into cells, two triangles each.
inline Mesh cut_cube(const Cells& cells) {
  const BoxSurface surface(cells);
  Mesh mesh;
  set_box_positions(cells, surface, mesh);
  add_box_faces(cells, surface, mesh);
  return mesh;
}

// Maps the surface of the cube one-to-one onto the unit sphere, with cells of similar size everywhere.
inline Vec3 cube_to_sphere(const Vec3& p) {
  const double x = p.x() * p.x(), y = p.y() * p.y(), z = p.z() * p.z();
  return {p.x() * std::sqrt(1 - y / 2 - z / 2 + y * z / 3), p.y() * std::sqrt(1 - z / 2 - x / 2 + z * x / 3),
          p.z() * std::sqrt(1 - x / 2 - y / 2 + x * y / 3)};
}

inline Mesh unit_sphere(std::size_t faces) {
  Mesh mesh = cut_cube(box_cells(faces, {1, 1, 1}));
  map_positions(mesh, cube_to_sphere);
  return mesh;
}

// A star-shaped body: radius(direction) > 0 moves the vertices of a sphere on their rays, so that whatever the
// radius is, faces cannot meet but where the faces of the sphere do.
template <class Radius>
Mesh star_body(std::size_t faces, const Radius& radius) {
  Mesh mesh = unit_sphere(faces);
  map_positions(mesh, [&](const Vec3& direction) -> Vec3 { return direction * radius(direction); });
  return mesh;
}

// Shapes with a source of their own. See shapes.h.
Mesh make_gyroid(std::size_t faces, std::uint64_t seed);
Mesh make_bracket(std::size_t faces, std::uint64_t seed);

}  // namespace prcage::shape
