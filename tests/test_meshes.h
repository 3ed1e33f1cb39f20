// Meshes that make trouble for the engine, and slow, obvious code to judge its answers by: topology from sets of edges,
// distances and winding numbers by loops over all faces. None of it shares code with what it tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/corner_table.h"
#include "core/vec3.h"
#include "solids.h"
#include "tools/shapes.h"

namespace prcage::testing {

inline Mesh shape(const std::string& name, std::size_t faces, std::uint64_t seed = 1) {
  std::string error;
  Mesh mesh = make_shape(name, faces, seed, error);
  EXPECT_EQ(error, "");
  return mesh;
}

inline Mesh mapped(Mesh mesh, const std::function<Vec3(const Vec3&)>& map) {
  for (Position& p : mesh.positions) p = position(map(vec(p)));
  return mesh;
}

inline Mesh moved(const Mesh& mesh, const Vec3& offset) {
  return mapped(mesh, [&](const Vec3& p) -> Vec3 { return p + offset; });
}

inline Vec3 random_unit(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Vec3 v(normal(random), normal(random), normal(random));
  while (!(v.norm() > 1e-3)) v = Vec3(normal(random), normal(random), normal(random));
  return v.normalized();
}

inline Mesh turned(const Mesh& mesh, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const Eigen::Matrix3d m = Eigen::AngleAxisd(2.0, random_unit(random)).toRotationMatrix();
  return mapped(mesh, [&](const Vec3& p) -> Vec3 { return m * p; });
}

inline double diagonal_of(const Mesh& mesh) {
  Vec3 low = vec(mesh.positions[0]), high = low;
  for (const Position& p : mesh.positions) {
    low = low.cwiseMin(vec(p));
    high = high.cwiseMax(vec(p));
  }
  return (high - low).norm();
}

inline bool same(const Mesh& a, const Mesh& b) { return a.positions == b.positions && a.triangles == b.triangles; }

// ---------------------------------------------------------------------------------------------- trouble

// A plate [0, size]^2 of n by n cells with its bottom at `bottom` and its top at height(x, y).
inline Mesh plate(std::uint32_t n, double size, const std::function<double(double, double)>& bottom,
                  const std::function<double(double, double)>& top) {
  Mesh mesh;
  const std::uint32_t side = n + 1;
  for (const auto* height : {&bottom, &top})
    for (std::uint32_t i = 0; i < side; ++i)
      for (std::uint32_t j = 0; j < side; ++j) {
        const double x = size * i / n, y = size * j / n;
        mesh.positions.push_back({x, y, (*height)(x, y)});
      }
  const auto at = [&](int layer, std::uint32_t i, std::uint32_t j) {
    return static_cast<std::uint32_t>(layer) * side * side + i * side + j;
  };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      quad(at(1, i, j), at(1, i + 1, j), at(1, i + 1, j + 1), at(1, i, j + 1));
      quad(at(0, i, j), at(0, i, j + 1), at(0, i + 1, j + 1), at(0, i + 1, j));
    }
  for (std::uint32_t i = 0; i < n; ++i) {
    quad(at(0, i, 0), at(0, i + 1, 0), at(1, i + 1, 0), at(1, i, 0));
    quad(at(0, i + 1, n), at(0, i, n), at(1, i, n), at(1, i + 1, n));
    quad(at(0, 0, i + 1), at(0, 0, i), at(1, 0, i), at(1, 0, i + 1));
    quad(at(0, n, i), at(0, n, i + 1), at(1, n, i + 1), at(1, n, i));
  }
  return mesh;
}

inline Mesh flat_plate(std::uint32_t n, double size, double bottom, double top) {
  return plate(
      n, size, [=](double, double) { return bottom; }, [=](double, double) { return top; });
}

// A disc without a slice that gets thinner towards its centre, where all its faces meet: beyond half a turn no
// direction clears both its upper and its lower side, so that vertex 0 is singular.
inline Mesh thin_sector(std::uint32_t steps, double turn, double half_thickness) {
  Mesh mesh;
  mesh.positions.push_back({0, 0, 0});
  for (std::uint32_t i = 0; i <= steps; ++i) {
    const double angle = turn * i / steps;
    for (const double z : {half_thickness, -half_thickness})
      mesh.positions.push_back({std::cos(angle), std::sin(angle), z});
  }
  const auto upper = [](std::uint32_t i) { return 1 + 2 * i; };
  const auto lower = [](std::uint32_t i) { return 2 + 2 * i; };
  for (std::uint32_t i = 0; i < steps; ++i) {
    mesh.triangles.push_back({0, upper(i), upper(i + 1)});
    mesh.triangles.push_back({0, lower(i + 1), lower(i)});
    mesh.triangles.push_back({lower(i), lower(i + 1), upper(i + 1)});
    mesh.triangles.push_back({lower(i), upper(i + 1), upper(i)});
  }
  mesh.triangles.push_back({0, lower(0), upper(0)});
  mesh.triangles.push_back({0, upper(steps), lower(steps)});
  return mesh;
}

// A pyramid whose apex has `ring` neighbours of alternating heights: a saddle, the steeper the larger `rise`.
inline Mesh saddle_cone(std::uint32_t ring, double rise) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, -2 * rise - 2}};
  for (std::uint32_t i = 0; i < ring; ++i) {
    const double angle = 2 * std::numbers::pi * i / ring;
    mesh.positions.push_back({std::cos(angle), std::sin(angle), i % 2 == 0 ? rise : -rise});
  }
  for (std::uint32_t i = 0; i < ring; ++i) {
    const std::uint32_t a = 2 + i, b = 2 + (i + 1) % ring;
    mesh.triangles.push_back({0, a, b});
    mesh.triangles.push_back({1, b, a});
  }
  return mesh;
}

// A strip folded into a Z of three thin layers of `thickness`, `gap` apart, with sharp hairpin turns.
inline Mesh z_fold(double thickness, double gap) {
  // Outline in the x-z plane, counterclockwise, extruded along y.
  const double pitch = thickness + gap;
  const std::vector<std::array<double, 2>> outline{
      {0, 0},           {1, 0},         {1, pitch + thickness},     {0.2, pitch + thickness},
      {0.2, 2 * pitch}, {1, 2 * pitch}, {1, 2 * pitch + thickness}, {0, 2 * pitch + thickness},
      {0, pitch},       {0.8, pitch},   {0.8, thickness},           {0, thickness}};
  // Ear-free caps: each layer of the Z is a rectangle between these corners of the outline.
  const std::vector<std::array<std::uint32_t, 3>> cap{{0, 1, 10}, {0, 10, 11}, {1, 2, 9}, {1, 9, 10}, {2, 3, 9},
                                                      {3, 8, 9},  {3, 4, 8},   {4, 7, 8}, {4, 5, 6},  {4, 6, 7}};
  Mesh mesh;
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const double y : {0.0, 1.0})
    for (const auto& [x, z] : outline) mesh.positions.push_back({x, y, z});
  for (const auto& [a, b, c] : cap) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({n + a, n + c, n + b});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    mesh.triangles.push_back({i, n + i, n + j});
    mesh.triangles.push_back({i, n + j, j});
  }
  return mesh;
}

// A solid with a short ridge on a rectangle: the collapse of the ridge rises to where the slopes of the two ends meet.
// Its ridge, vertices 4 and 5, points along `up` (+1 or -1) from the base at height z.
inline Mesh wedge(double ridge, double height, double z, int up) {
  Mesh mesh{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {-ridge / 2, 0, height}, {ridge / 2, 0, height}},
            {{0, 2, 1}, {0, 3, 2}, {0, 1, 5}, {0, 5, 4}, {1, 2, 5}, {2, 3, 4}, {2, 4, 5}, {3, 0, 4}}};
  for (Position& p : mesh.positions) p[2] = z + up * p[2];
  return up > 0 ? mesh : inside_out(mesh);
}

// ---------------------------------------------------------------------------------------------- judges

struct Topology {
  bool closed_manifold = false;  // and oriented; unused vertices are legal
  long long euler = 0;
  std::size_t components = 0;

  bool operator==(const Topology&) const = default;
};

// The vertices opposite to v in its faces form one cycle.
inline bool one_fan(const std::vector<std::array<std::uint32_t, 2>>& opposite_edges) {
  std::map<std::uint32_t, std::uint32_t> next;
  for (const auto& [a, b] : opposite_edges)
    if (!next.emplace(a, b).second) return false;
  std::size_t length = 0;
  std::uint32_t v = next.begin()->first;
  do {
    const auto it = next.find(v);
    if (it == next.end()) return false;
    v = it->second;
    ++length;
  } while (v != next.begin()->first && length <= next.size());
  return length == next.size();
}

inline Topology topology(const Mesh& mesh) {
  Topology result;
  std::set<std::pair<std::uint32_t, std::uint32_t>> halfedges;
  std::map<std::uint32_t, std::vector<std::array<std::uint32_t, 2>>> links;
  std::vector<std::uint32_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  bool proper = !mesh.triangles.empty();
  for (const auto& [a, b, c] : mesh.triangles) {
    proper = proper && a != b && b != c && c != a;
    for (const auto& [u, v, w] : {std::array{a, b, c}, std::array{b, c, a}, std::array{c, a, b}}) {
      proper = halfedges.emplace(u, v).second && proper;
      links[u].push_back({v, w});
      parent[root(u)] = root(v);
    }
  }
  for (const auto& [u, v] : halfedges) proper = proper && halfedges.contains({v, u});
  std::set<std::uint32_t> roots;
  for (const auto& [v, link] : links) {
    proper = proper && one_fan(link);
    roots.insert(root(v));
  }
  result.closed_manifold = proper;
  result.euler = static_cast<long long>(links.size()) - static_cast<long long>(halfedges.size() / 2) +
                 static_cast<long long>(mesh.triangles.size());
  result.components = roots.size();
  return result;
}

// Distance from x to the closed triangle: to the plane if the foot is inside, else to the nearest edge.
inline double triangle_distance(const Vec3& x, const std::array<Vec3, 3>& t) {
  const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
  bool inside = n.squaredNorm() > 0;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &p = t[i], &q = t[(i + 1) % 3];
    inside = inside && n.cross(q - p).dot(x - p) >= 0;
    const double s = (x - p).dot(q - p) / std::max((q - p).squaredNorm(), 1e-300);
    best = std::min(best, (x - (p + std::clamp(s, 0.0, 1.0) * (q - p))).norm());
  }
  return inside ? std::abs(n.normalized().dot(x - t[0])) : best;
}

inline std::array<Vec3, 3> corners(const Mesh& mesh, const Triangle& t) {
  return {vec(mesh.positions[t[0]]), vec(mesh.positions[t[1]]), vec(mesh.positions[t[2]])};
}

// Distances to a mesh by a loop over its faces; faces whose bounding sphere is too far are passed over.
class BruteDistance {
 public:
  explicit BruteDistance(const Mesh& mesh) {
    for (const Triangle& t : mesh.triangles) {
      const auto c = corners(mesh, t);
      const Vec3 centre = (c[0] + c[1] + c[2]) / 3;
      faces_.push_back(c);
      centres_.push_back(centre);
      radii_.push_back(std::max({(c[0] - centre).norm(), (c[1] - centre).norm(), (c[2] - centre).norm()}));
    }
  }

  double operator()(const Vec3& x) const { return nearest(x).second; }

  // Lowest face among those at exactly the smallest distance.
  std::pair<std::uint32_t, double> nearest(const Vec3& x) const {
    std::pair<std::uint32_t, double> best{none, std::numeric_limits<double>::infinity()};
    for (std::uint32_t f = 0; f < faces_.size(); ++f) {
      const double reach = best.second + radii_[f] * (1 + 1e-9);
      if ((x - centres_[f]).squaredNorm() > reach * reach * (1 + 1e-9)) continue;
      const double d = triangle_distance(x, faces_[f]);
      if (d < best.second) best = {f, d};
    }
    return best;
  }

 private:
  std::vector<std::array<Vec3, 3>> faces_;
  std::vector<Vec3> centres_;
  std::vector<double> radii_;
};

// Calls visit(x) for the points of a triangle with barycentric coordinates in multiples of 1/n.
inline void for_each_sample(const std::array<Vec3, 3>& t, int n, const std::function<void(const Vec3&)>& visit) {
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) visit((i * t[0] + j * t[1] + (n - i - j) * t[2]) / n);
}

// The largest distance from n-fold samples of the faces of `cage` to `input`.
inline double sampled_distance(const Mesh& cage, const Mesh& input, int n) {
  const BruteDistance distance(input);
  double worst = 0;
  for (const Triangle& t : cage.triangles)
    for_each_sample(corners(cage, t), n, [&](const Vec3& x) { worst = std::max(worst, distance(x)); });
  return worst;
}

// How often the surface winds round x, by the solid angles of its faces.
inline int winding_number(const Mesh& mesh, const Vec3& x) {
  double angle = 0;
  for (const Triangle& t : mesh.triangles) {
    auto [a, b, c] = corners(mesh, t);
    a -= x;
    b -= x;
    c -= x;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return static_cast<int>(std::lround(angle / (4 * std::numbers::pi)));
}

// Does the solid of `outer` contain that of `inner`, common faces allowed? Judged at points just inside `inner`.
inline bool weakly_encloses(const Mesh& outer, const Mesh& inner, double depth) {
  return std::all_of(inner.triangles.begin(), inner.triangles.end(), [&](const Triangle& t) {
    const auto [a, b, c] = corners(inner, t);
    const Vec3 x = (a + b + c) / 3 - depth * (b - a).cross(c - a).normalized();
    return winding_number(inner, x) < 1 || winding_number(outer, x) >= 1;
  });
}

// ---------------------------------------------------------------------------------------------- parameters

struct ShapeCase {
  const char* name;
  std::size_t faces;
  std::uint64_t seed;
};

inline std::string label(const ShapeCase& c) {
  return std::string(c.name) + std::to_string(c.faces) + "seed" + std::to_string(c.seed);
}

inline void PrintTo(const ShapeCase& c, std::ostream* out) { *out << label(c); }

}  // namespace prcage::testing
