// The gyroid: a wall of high genus, contoured on a lattice.
#include "tools/shape_parts.h"

#include <numeric>

namespace prcage::shape {
namespace {

// A gyroid sheet thickened to a wall and cut by the unit ball, sampled on a cubic lattice. Negative inside.
class GyroidWall {
 public:
  GyroidWall(double spacing, double periods, std::uint64_t seed) : spacing_(spacing) {
    nodes_ = static_cast<std::size_t>(std::ceil(2 / spacing)) + 3;
    waves_per_unit_ = periods / 2;
    Random random(seed);
    for (auto& wave : waves_) {
      const double phase = random.uniform(0, 1);
      for (std::size_t i = 0; i < nodes_; ++i) wave.push_back(turn(waves_per_unit_ * coordinate(i) + phase));
    }
  }

  std::size_t nodes() const { return nodes_; }  // along each axis

  double coordinate(std::size_t i) const {
    return (static_cast<double>(i) - static_cast<double>(nodes_ - 1) / 2) * spacing_;
  }

  double operator()(std::size_t i, std::size_t j, std::size_t k) const {
    constexpr double half_wall = 0.8;  // as a value of the gyroid function, whose slope is about 1.3 wave numbers
    const CosSin &x = waves_[0][i], &y = waves_[1][j], &z = waves_[2][k];
    const double wall = std::abs(x.sin * y.cos + y.sin * z.cos + z.sin * x.cos) - half_wall;
    const Vec3 p(coordinate(i), coordinate(j), coordinate(k));
    return rounded_maximum(wall / (1.3 * 2 * pi * waves_per_unit_), p.norm() - 1, 0.1 / waves_per_unit_);
  }

 private:
  // Intersection of two solids with the edge rounded off, where a lattice would leave teeth.
  static double rounded_maximum(double a, double b, double rounding) {
    const double overlap = std::max(rounding - std::abs(a - b), 0.0);
    return std::max(a, b) + overlap * overlap / (4 * rounding);
  }

  double spacing_, waves_per_unit_;
  std::size_t nodes_;
  std::array<std::vector<CosSin>, 3> waves_;
};

// Marching tetrahedra on the Kuhn subdivision of a cubic lattice, slice by slice, so that memory beyond the result
// is that of two slices. A vertex lies strictly inside an edge of the lattice and a tetrahedron holds one triangle
// or one quad, so the result is closed, manifold and free of self-intersections for any field.
class Contour {
 public:
  explicit Contour(const GyroidWall& field) : field_(field), n_(field.nodes()) {
    for (Slice& slice : slices_) {
      slice.values.resize(n_ * n_);
      slice.vertices.resize(7 * n_ * n_, none);
    }
  }

  Mesh run() {
    sample(0);
    for (std::size_t k = 0; k + 1 < n_; ++k) {
      sample(k + 1);
      for (std::size_t j = 0; j + 1 < n_; ++j) {
        for (std::size_t i = 0; i + 1 < n_; ++i) contour_cube(i, j, k);
      }
    }
    return std::move(mesh_);
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;

  struct Slice {
    std::vector<double> values;
    std::vector<std::uint32_t> vertices;  // by node and direction of the lattice edge that begins there
    std::vector<std::size_t> used;        // entries of `vertices` that are set
  };

  struct Node {
    std::size_t i, j, k;
  };

  // A node is named by its corner of the cube: bits 0, 1, 2 step along x, y, z.
  static Node node(const Node& cube, unsigned corner) {
    return {cube.i + (corner & 1), cube.j + ((corner >> 1) & 1), cube.k + (corner >> 2)};
  }

  double value(const Node& p) const { return slices_[p.k & 1].values[p.j * n_ + p.i]; }

  void sample(std::size_t k) {
    Slice& slice = slices_[k & 1];
    for (std::size_t entry : slice.used) slice.vertices[entry] = none;
    slice.used.clear();
    tbb::parallel_for(std::size_t{0}, n_, [&](std::size_t j) {
      for (std::size_t i = 0; i < n_; ++i) slice.values[j * n_ + i] = field_(i, j, k);
    });
  }

  void contour_cube(std::size_t i, std::size_t j, std::size_t k) {
    const Node cube{i, j, k};
    unsigned inside = 0;
    for (unsigned corner = 0; corner < 8; ++corner) inside |= unsigned{value(node(cube, corner)) < 0} << corner;
    if (inside == 0 || inside == 0xff) return;
    // The six monotone paths from corner 0 to corner 7; the first three are even permutations of the axes.
    static constexpr unsigned paths[6][2] = {{1, 3}, {2, 6}, {4, 5}, {1, 5}, {2, 3}, {4, 6}};
    for (unsigned t = 0; t < 6; ++t) contour_tetrahedron(cube, {0, paths[t][0], paths[t][1], 7}, inside, t < 3);
  }

  void contour_tetrahedron(const Node& cube, const std::array<unsigned, 4>& corners, unsigned inside, bool positive) {
    unsigned which = 0;
    for (unsigned c = 0; c < 4; ++c) which |= ((inside >> corners[c]) & 1) << c;
    if (which == 0 || which == 15) return;
    // Even orders of the corners, by the set that is inside: the corner or the pair that is cut off comes first.
    static constexpr unsigned orders[16][4] = {
        {},           {0, 1, 2, 3}, {1, 0, 3, 2}, {0, 1, 2, 3}, {2, 0, 1, 3}, {0, 2, 3, 1}, {1, 2, 0, 3}, {3, 0, 2, 1},
        {3, 0, 2, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}, {2, 0, 1, 3}, {2, 3, 0, 1}, {1, 0, 3, 2}, {0, 1, 2, 3}, {}};
    const auto crossing = [&](unsigned a, unsigned b) {
      return vertex(cube, corners[orders[which][a]], corners[orders[which][b]]);
    };
    const bool pair = which == 3 || which == 5 || which == 6 || which == 9 || which == 10 || which == 12;
    if (pair) {
      const std::uint32_t a = crossing(0, 2), b = crossing(0, 3), c = crossing(1, 3), d = crossing(1, 2);
      add_triangle(a, b, c, positive);
      add_triangle(a, c, d, positive);
    } else {
      const bool three_inside = which == 7 || which == 11 || which == 13 || which == 14;
      add_triangle(crossing(0, 1), crossing(0, 2), crossing(0, 3), positive != three_inside);
    }
  }

  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool positive) {
    mesh_.triangles.push_back(positive ? Triangle{a, b, c} : Triangle{a, c, b});
  }

  // The vertex on the edge between two corners of a cube, one of which has all the bits of the other.
  std::uint32_t vertex(const Node& cube, unsigned corner_a, unsigned corner_b) {
    const unsigned low = std::min(corner_a, corner_b), high = std::max(corner_a, corner_b);
    const Node a = node(cube, low), b = node(cube, high);
    Slice& slice = slices_[a.k & 1];
    const std::size_t entry = 7 * (a.j * n_ + a.i) + (high ^ low) - 1;
    std::uint32_t& known = slice.vertices[entry];
    if (known == none) {
      known = index(mesh_.positions.size());
      slice.used.push_back(entry);
      mesh_.positions.push_back(position(crossing_point(a, b)));
    }
    return known;
  }

  // Kept away from the nodes by a share of the edge: no slivers there, and rounding cannot undo the proof above.
  Vec3 crossing_point(const Node& a, const Node& b) const {
    const double share = std::clamp(value(a) / (value(a) - value(b)), 0.04, 0.96);
    const Vec3 p(field_.coordinate(a.i), field_.coordinate(a.j), field_.coordinate(a.k));
    const Vec3 q(field_.coordinate(b.i), field_.coordinate(b.j), field_.coordinate(b.k));
    return p + share * (q - p);
  }

  const GyroidWall& field_;
  std::size_t n_;
  std::array<Slice, 2> slices_;
  Mesh mesh_;
};

// For every vertex the lowest vertex of its component.
std::vector<std::uint32_t> component_roots(const Mesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Triangle& t : mesh.triangles) {
    const std::uint32_t a = root(t[0]), b = root(t[1]), c = root(t[2]);
    parent[a] = parent[b] = parent[c] = std::min({a, b, c});
  }
  for (std::uint32_t v = 0; v < parent.size(); ++v) parent[v] = root(v);
  return parent;
}

// Keeps the component with the most faces, in the order in which it was.
void keep_largest_component(Mesh& mesh) {
  const std::vector<std::uint32_t> roots = component_roots(mesh);
  std::vector<std::uint32_t> faces(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles) ++faces[roots[t[0]]];
  const auto largest = std::max_element(faces.begin(), faces.end());
  const std::uint32_t kept = index(static_cast<std::size_t>(largest - faces.begin()));

  std::vector<std::uint32_t>& renumbered = faces;
  std::uint32_t vertices = 0;
  for (std::uint32_t v = 0; v < roots.size(); ++v) {
    if (roots[v] != kept) continue;
    mesh.positions[vertices] = mesh.positions[v];
    renumbered[v] = vertices++;
  }
  mesh.positions.resize(vertices);
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return roots[t[0]] != kept; });
  for (Triangle& t : mesh.triangles) t = {renumbered[t[0]], renumbered[t[1]], renumbered[t[2]]};
}

// As many periods as leave two lattice cells in the thickness of the wall.
double gyroid_periods(std::size_t faces) {
  if (faces < 12000) return 1;
  if (faces < 40000) return 1.5;
  return faces < 150000 ? 2 : 3;
}

}  // namespace

// The number of faces goes with the inverse square of the spacing, nearly: `factor` is their product. It is measured
// on a mesh of moderate size first, then on the result, until the count is within one percent. Where the count jumps
// (coarse lattices), halving the interval of the factor finds the jump.
Mesh make_gyroid(std::size_t faces, std::uint64_t seed) {
  const double target = static_cast<double>(faces), periods = gyroid_periods(faces);
  const auto contour = [&](double spacing) {
    const GyroidWall field(spacing, periods, seed);
    Mesh mesh = Contour(field).run();
    keep_largest_component(mesh);
    return mesh;
  };
  const auto count = [](const Mesh& mesh) { return static_cast<double>(mesh.triangles.size()); };

  double factor = 40 + 130 * periods;
  if (faces > 400000) {
    const double spacing = std::sqrt(factor / 200000);
    factor = count(contour(spacing)) * spacing * spacing;
  }
  double low = 0, high = HUGE_VAL;
  Mesh best;
  for (int attempt = 0; attempt < 16; ++attempt) {
    const double spacing = std::min(std::sqrt(factor / target), 0.4);
    Mesh mesh = contour(spacing);
    const double faces_here = count(mesh);
    if (std::abs(faces_here - target) < std::abs(count(best) - target)) best = std::move(mesh);
    if (std::abs(count(best) - target) <= 0.01 * target) break;
    (faces_here > target ? low : high) = factor;
    const double measured = faces_here * spacing * spacing;
    factor = low < measured && measured < high ? measured : (low + high) / 2;
  }
  return best;
}

}  // namespace prcage::shape
