// The built-in shapes. See shapes.h for what they promise.
//
// Contents: deterministic numbers and trigonometry; the grid on the surface of a box, from which all star-shaped
// bodies and plates are made; one section per shape; the table of shapes at the end.
#include "tools/shapes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "core/vec3.h"

namespace prcage {
namespace {

constexpr double pi = 3.14159265358979323846;

// ------------------------------------------------------------------------------------- deterministic numbers

// Finaliser of SplitMix64 (Steele, Lea, Flood 2014): a bijection of 64 bits without visible structure.
std::uint64_t mix(std::uint64_t x) {
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
CosSin turn(double t) {
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

std::uint32_t index(std::size_t i) { return static_cast<std::uint32_t>(i); }

std::size_t at_least(std::size_t low, double x) {
  return x <= static_cast<double>(low) ? low : static_cast<std::size_t>(std::floor(x + 0.5));
}

// ----------------------------------------------------------------------------------------- grids and building

// Replaces every position by map(position), in parallel: map is pure.
template <class Map>
void map_positions(Mesh& mesh, const Map& map) {
  tbb::parallel_for(std::size_t{0}, mesh.positions.size(),
                    [&](std::size_t v) { mesh.positions[v] = position(map(vec(mesh.positions[v]))); });
}

void add_quad(Mesh& mesh, std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
  mesh.triangles.push_back({index(a), index(b), index(c)});
  mesh.triangles.push_back({index(a), index(c), index(d)});
}

// Turns a body inside out: the boundary of a hollow.
void reverse_orientation(Mesh& mesh) {
  for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

void append(Mesh& mesh, const Mesh& other) {
  const std::uint32_t first = index(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  mesh.triangles.reserve(mesh.triangles.size() + other.triangles.size());
  for (const Triangle& t : other.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

using Cells = std::array<std::size_t, 3>;

// Cells along x, y, z of a box with these side lengths, roughly square, so that the surface has about `faces`
// triangles. The last one is solved for, which brings the count within half a row of cells.
Cells box_cells(std::size_t faces, const Vec3& sides) {
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

void set_box_positions(const Cells& n, const BoxSurface& surface, Mesh& mesh) {
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

void add_box_faces(const Cells& n, const BoxSurface& surface, Mesh& mesh) {
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
Mesh cut_cube(const Cells& cells) {
  const BoxSurface surface(cells);
  Mesh mesh;
  set_box_positions(cells, surface, mesh);
  add_box_faces(cells, surface, mesh);
  return mesh;
}

// Maps the surface of the cube one-to-one onto the unit sphere, with cells of similar size everywhere.
Vec3 cube_to_sphere(const Vec3& p) {
  const double x = p.x() * p.x(), y = p.y() * p.y(), z = p.z() * p.z();
  return {p.x() * std::sqrt(1 - y / 2 - z / 2 + y * z / 3), p.y() * std::sqrt(1 - z / 2 - x / 2 + z * x / 3),
          p.z() * std::sqrt(1 - x / 2 - y / 2 + x * y / 3)};
}

Mesh unit_sphere(std::size_t faces) {
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

// ---------------------------------------------------------------------------------------------------- sphere

Mesh make_sphere(std::size_t faces, std::uint64_t) { return unit_sphere(faces); }

// ----------------------------------------------------------------------------------------------------- bumpy

// Gradient noise (Perlin 2002) on the integer lattice, with hashed gradients towards the edges of a cube.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : seed_(mix(seed + 1)) {}

  // Smooth, mean 0, about within [-1, 1].
  double operator()(const Vec3& p) const {
    const Vec3 cell = p.array().floor();
    const Vec3 f = p - cell;
    const Vec3 w = f.unaryExpr([](double t) { return t * t * t * (t * (t * 6 - 15) + 10); });
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 c(corner & 1, (corner >> 1) & 1, corner >> 2);
      const Vec3 weight = c.cwiseProduct(w) + (Vec3::Ones() - c).cwiseProduct(Vec3::Ones() - w);
      sum += weight.x() * weight.y() * weight.z() * slope(cell + c, f - c);
    }
    return sum;
  }

 private:
  double slope(const Vec3& node, const Vec3& offset) const {
    std::uint64_t hash = seed_;
    for (int axis = 0; axis < 3; ++axis) {
      hash = mix(hash + 0x9e3779b97f4a7c15u * static_cast<std::uint64_t>(static_cast<std::int64_t>(node[axis]) + 4096));
    }
    const int axis = static_cast<int>((hash >> 32) % 3);
    const double u = offset[(axis + 1) % 3], v = offset[(axis + 2) % 3];
    return ((hash & 1) != 0 ? u : -u) + ((hash & 2) != 0 ? v : -v);
  }

  std::uint64_t seed_;
};

Mesh make_bumpy(std::size_t faces, std::uint64_t seed) {
  const Noise noise(seed);
  return star_body(faces, [&](const Vec3& direction) {
    double radius = 1;
    double frequency = 1.5, amplitude = 0.4;
    for (int octave = 0; octave < 6; ++octave) {
      radius += amplitude * noise(direction * frequency + Vec3::Constant(17.0 * octave));
      frequency *= 2.1;
      amplitude *= 0.4;
    }
    return std::max(radius, 0.25);
  });
}

// ---------------------------------------------------------------------------------------------------- spikes

enum class Tip { needle, saddle };

struct Spike {
  Vec3 direction, across, along;  // an orthonormal frame: across and along span the tangent plane
  Tip kind;
};

constexpr double spike_width = 0.27;  // radius of a spike's foot on the unit sphere

// A needle is a cusp, a saddle a cone over three ridges and three valleys: no direction leaves all its faces.
double spike_height(const Spike& spike, const Vec3& direction) {
  const Vec3 offset = direction - spike.direction;
  const double d = offset.norm();
  if (d >= spike_width) return 0;
  const double fade = (1 - d / spike_width) * (1 - d / spike_width);
  if (spike.kind == Tip::needle) return 1.3 * fade;
  if (d == 0) return 0;
  const double u = offset.dot(spike.across) / d, v = offset.dot(spike.along) / d;
  return 3 * d * (u * u * u - 3 * u * v * v) * fade;
}

// The vertex of the sphere nearest to a direction: where a tip must be to stay sharp at every size.
Vec3 nearest_vertex(const Mesh& sphere, const Vec3& direction) {
  const Position* best = &sphere.positions.front();
  for (const Position& p : sphere.positions) {
    if (vec(p).dot(direction) > vec(*best).dot(direction)) best = &p;
  }
  return vec(*best);
}

// Tips spread by the golden angle, turned and shaken by the seed, each on a vertex.
std::vector<Spike> make_tips(const Mesh& sphere, std::uint64_t seed) {
  constexpr double golden = 0.38196601125010515;
  Random random(seed);
  const std::size_t count = std::clamp<std::size_t>(sphere.positions.size() / 24, 4, 32);
  const double start = random.uniform(0, 1);
  std::vector<Spike> spikes;
  for (std::size_t i = 0; i < count; ++i) {
    const double y = 1 - (2 * static_cast<double>(i) + random.uniform(0.7, 1.3)) / static_cast<double>(count);
    const double ring = std::sqrt(1 - y * y);
    const CosSin turned = turn(start + golden * static_cast<double>(i) + random.uniform(-0.02, 0.02));
    Spike spike;
    spike.direction = nearest_vertex(sphere, {ring * turned.cos, y, ring * turned.sin});
    const Vec3 helper = std::abs(spike.direction.y()) < 0.7 ? Vec3::UnitY() : Vec3::UnitX();
    spike.across = spike.direction.cross(helper).normalized();
    spike.along = spike.direction.cross(spike.across);
    spike.kind = i % 3 == 2 ? Tip::saddle : Tip::needle;
    spikes.push_back(spike);
  }
  return spikes;
}

Mesh make_spikes(std::size_t faces, std::uint64_t seed) {
  Mesh mesh = unit_sphere(faces);
  const std::vector<Spike> spikes = make_tips(mesh, seed);
  map_positions(mesh, [&](const Vec3& direction) -> Vec3 {
    double radius = 1;
    for (const Spike& spike : spikes) radius += spike_height(spike, direction);
    return direction * std::max(radius, 0.4);
  });
  return mesh;
}

// ------------------------------------------------------------------------------------------------------ knot

// A tube around the (2, 3) torus knot. The normal of the torus is perpendicular to the knot, so it closes the
// frame of the tube without any correction.
class KnotTube {
 public:
  explicit KnotTube(std::uint64_t seed) {
    Random random(seed);
    phase_ = random.uniform(0, 1);
    ripple_ = random.uniform(0.02, 0.08);
  }

  // s: turns along the knot, a: turns around the tube.
  Vec3 operator()(double s, double a) const {
    const CosSin p = turn(windings_around_axis * s), q = turn(windings_around_core * s), around = turn(a);
    const double distance = major_radius + minor_radius * q.cos;
    const Vec3 centre(distance * p.cos, distance * p.sin, minor_radius * q.sin);
    const Vec3 outward(q.cos * p.cos, q.cos * p.sin, q.sin);
    const Vec3 radial(p.cos, p.sin, 0), circular(-p.sin, p.cos, 0);
    const Vec3 tangent = (windings_around_axis * distance * circular -
                          windings_around_core * minor_radius * (q.sin * radial - q.cos * Vec3::UnitZ()))
                             .normalized();
    const double radius = tube_radius * (1 + ripple_ * turn(ripples * s + phase_).cos);
    return centre + radius * (around.cos * outward + around.sin * tangent.cross(outward));
  }

 private:
  static constexpr double windings_around_axis = 2, windings_around_core = 3, ripples = 18;
  // The strands of the knot keep a distance of 1.6; the tube with its ripple needs less than 1.1.
  static constexpr double major_radius = 2, minor_radius = 1, tube_radius = 0.48;
  double phase_ = 0, ripple_ = 0;
};

Mesh make_knot(std::size_t faces, std::uint64_t seed) {
  constexpr double length_by_girth = 10.5;
  const double quads = static_cast<double>(faces) / 2;
  const std::size_t around = at_least(3, std::sqrt(quads / length_by_girth));
  const std::size_t along = at_least(24, quads / static_cast<double>(around));
  const KnotTube tube(seed);
  Mesh mesh;
  mesh.positions.resize(along * around);
  tbb::parallel_for(std::size_t{0}, along, [&](std::size_t s) {
    for (std::size_t a = 0; a < around; ++a) {
      mesh.positions[s * around + a] = position(tube(static_cast<double>(s) / static_cast<double>(along),
                                                     static_cast<double>(a) / static_cast<double>(around)));
    }
  });
  mesh.triangles.reserve(2 * along * around);
  for (std::size_t s = 0; s < along; ++s) {
    const std::size_t here = s * around, next = (s + 1) % along * around;
    for (std::size_t a = 0; a < around; ++a) {
      const std::size_t b = (a + 1) % around;
      add_quad(mesh, here + a, here + b, next + b, next + a);
    }
  }
  return mesh;
}

// ---------------------------------------------------------------------------------------------------- gyroid

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

// --------------------------------------------------------------------------------------------------- bracket

using Loop = std::vector<std::uint32_t>;

// Cuts a plane polygon with round holes into triangles, as exporters of CAD programs do: no new vertices, hence
// long thin triangles. Holes are joined to the outer loop by bridges, then ears are clipped.
class PolygonCutter {
 public:
  // Counterclockwise is seen from the positive side of the axis, or from the negative side.
  PolygonCutter(const Mesh& mesh, std::size_t axis, bool positive)
      : mesh_(mesh), u_((axis + (positive ? 1 : 2)) % 3), v_((axis + (positive ? 2 : 1)) % 3) {}

  std::vector<Triangle> cut(Loop outer, std::vector<Loop> holes) const {
    orient(outer, true);
    for (Loop& hole : holes) orient(hole, false);
    while (!holes.empty()) bridge_nearest(outer, holes);
    return clip_ears(std::move(outer));
  }

 private:
  double coordinate(std::uint32_t vertex, std::size_t axis) const { return mesh_.positions[vertex][axis]; }

  // Twice the signed area of a triangle.
  double area(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return (coordinate(b, u_) - coordinate(a, u_)) * (coordinate(c, v_) - coordinate(a, v_)) -
           (coordinate(b, v_) - coordinate(a, v_)) * (coordinate(c, u_) - coordinate(a, u_));
  }

  double squared_distance(std::uint32_t a, std::uint32_t b) const {
    return (vec(mesh_.positions[a]) - vec(mesh_.positions[b])).squaredNorm();
  }

  void orient(Loop& loop, bool counterclockwise) const {
    double sum = 0;
    for (std::size_t i = 1; i + 1 < loop.size(); ++i) sum += area(loop[0], loop[i], loop[i + 1]);
    if ((sum > 0) != counterclockwise) std::reverse(loop.begin(), loop.end());
  }

  // Joins the hole that is nearest to the outer loop. Holes are round and no smaller than the gaps between their
  // corners, so nothing lies between the two nearest vertices.
  void bridge_nearest(Loop& outer, std::vector<Loop>& holes) const {
    struct {
      std::size_t hole = 0, inner = 0, outer = 0;
      double distance = HUGE_VAL;
    } best;
    for (std::size_t h = 0; h < holes.size(); ++h) {
      for (std::size_t i = 0; i < holes[h].size(); ++i) {
        for (std::size_t o = 0; o < outer.size(); ++o) {
          const double distance = squared_distance(holes[h][i], outer[o]);
          if (distance < best.distance) best = {h, i, o, distance};
        }
      }
    }
    Loop& hole = holes[best.hole];
    std::rotate(hole.begin(), hole.begin() + static_cast<std::ptrdiff_t>(best.inner), hole.end());
    hole.push_back(hole.front());
    hole.push_back(outer[best.outer]);
    outer.insert(outer.begin() + static_cast<std::ptrdiff_t>(best.outer) + 1, hole.begin(), hole.end());
    holes.erase(holes.begin() + static_cast<std::ptrdiff_t>(best.hole));
  }

  // Can the corner be cut off? Not if another vertex lies in it or on its rim. The margin is far above rounding and
  // far below any triangle of the part.
  bool is_ear(const Loop& loop, std::size_t corner) const {
    constexpr double margin = 1e-9;
    const std::uint32_t a = loop[(corner + loop.size() - 1) % loop.size()], b = loop[corner],
                        c = loop[(corner + 1) % loop.size()];
    if (area(a, b, c) <= margin) return false;
    return std::none_of(loop.begin(), loop.end(), [&](std::uint32_t p) {
      if (p == a || p == b || p == c) return false;
      return area(a, b, p) >= -margin && area(b, c, p) >= -margin && area(c, a, p) >= -margin;
    });
  }

  std::vector<Triangle> clip_ears(Loop loop) const {
    std::vector<Triangle> triangles;
    std::size_t corner = 0, misses = 0;
    while (loop.size() >= 3 && misses < loop.size()) {
      corner %= loop.size();
      if (!is_ear(loop, corner)) {
        ++corner;
        ++misses;
        continue;
      }
      const std::size_t before = (corner + loop.size() - 1) % loop.size();
      triangles.push_back({loop[before], loop[corner], loop[(corner + 1) % loop.size()]});
      loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(corner));
      misses = 0;
    }
    return triangles;
  }

  const Mesh& mesh_;
  std::size_t u_, v_;
};

// An angle bracket: two plates, two bolt holes in the foot, a boss with a bore in the upright. The outline lies in
// the x-y plane and is extruded along z. Three holes through it: genus 3.
class Bracket {
 public:
  Bracket(std::size_t segments, std::uint64_t seed) : segments_(segments) {
    Random random(seed);
    phase_ = random.uniform(0, 1);
    bolt_ = random.uniform(0.42, 0.55);
    bore_ = random.uniform(0.6, 0.8);
    boss_height_ = random.uniform(0.5, 0.8);
  }

  Mesh make() {
    add_outline();
    const Loop bolts_bottom[] = {circle(1, {2.4, 0, 1.2}, bolt_), circle(1, {4.0, 0, 2.9}, bolt_)};
    const Loop bolts_top[] = {circle(1, {2.4, 1, 1.2}, bolt_), circle(1, {4.0, 1, 2.9}, bolt_)};
    const double face = 1 + boss_height_;
    const Loop bore_back = circle(0, {0, 3, 2}, bore_), bore_face = circle(0, {face, 3, 2}, bore_);
    const Loop boss_foot = circle(0, {1, 3, 2}, bore_ + 0.45), boss_face = circle(0, {face, 3, 2}, bore_ + 0.45);

    add_plane(1, false, {front(0), front(1), back(1), back(0)}, {bolts_bottom[0], bolts_bottom[1]});
    add_plane(1, true, {front(3), front(2), back(2), back(3)}, {bolts_top[0], bolts_top[1]});
    add_plane(0, false, {front(0), front(5), back(5), back(0)}, {bore_back});
    add_plane(0, true, {front(3), front(4), back(4), back(3)}, {boss_foot});
    add_plane(0, true, boss_face, {bore_face});
    add_plane(0, true, {front(1), front(2), back(2), back(1)}, {});
    add_plane(1, true, {front(4), front(5), back(5), back(4)}, {});
    add_plane(2, false, {front(0), front(1), front(2), front(3), front(4), front(5)}, {});
    add_plane(2, true, {back(0), back(1), back(2), back(3), back(4), back(5)}, {});
    add_wall(boss_foot, boss_face);
    add_wall(bore_face, bore_back);
    for (int i = 0; i < 2; ++i) add_wall(bolts_top[i], bolts_bottom[i]);
    return std::move(mesh_);
  }

  static constexpr std::size_t face_count(std::size_t segments) { return 16 * segments + 32; }

 private:
  static constexpr std::size_t outline_size = 6;

  static std::uint32_t front(std::uint32_t corner) { return corner; }
  static std::uint32_t back(std::uint32_t corner) { return corner + outline_size; }

  void add_outline() {
    static constexpr double outline[outline_size][2] = {{0, 0}, {5.2, 0}, {5.2, 1}, {1, 1}, {1, 5}, {0, 5}};
    for (double z : {0.0, 4.0}) {
      for (const auto& p : outline) mesh_.positions.push_back({p[0], p[1], z});
    }
  }

  // A circle around the axis, counterclockwise seen from its positive side.
  Loop circle(int axis, const Vec3& centre, double radius) {
    Loop loop;
    for (std::size_t i = 0; i < segments_; ++i) {
      const CosSin angle = turn(phase_ + static_cast<double>(i) / static_cast<double>(segments_));
      Vec3 p = centre;
      p[(axis + 1) % 3] += radius * angle.cos;
      p[(axis + 2) % 3] += radius * angle.sin;
      loop.push_back(index(mesh_.positions.size()));
      mesh_.positions.push_back(position(p));
    }
    return loop;
  }

  void add_plane(std::size_t axis, bool positive, const Loop& outer, const std::vector<Loop>& holes) {
    const std::vector<Triangle> triangles = PolygonCutter(mesh_, axis, positive).cut(outer, holes);
    mesh_.triangles.insert(mesh_.triangles.end(), triangles.begin(), triangles.end());
  }

  // A band between two circles around one axis. It faces outward if `from` lies below `to`, inward otherwise.
  void add_wall(const Loop& from, const Loop& to) {
    for (std::size_t i = 0; i < segments_; ++i) {
      const std::size_t next = (i + 1) % segments_;
      add_quad(mesh_, from[i], from[next], to[next], to[i]);
    }
  }

  std::size_t segments_;
  double phase_, bolt_, bore_, boss_height_;
  Mesh mesh_;
};

// Cuts every edge of a small mesh into `parts` and every face into parts * parts similar ones.
class Subdivision {
 public:
  Subdivision(const Mesh& base, std::size_t parts) : base_(base), parts_(parts) {}

  Mesh run() {
    mesh_.positions = base_.positions;
    mesh_.triangles.reserve(base_.triangles.size() * parts_ * parts_);
    for (const Triangle& face : base_.triangles) add_face(face);
    return std::move(mesh_);
  }

 private:
  // Differences first: a coordinate that is the same at all corners stays exactly so.
  std::uint32_t add_vertex(const Triangle& face, std::size_t i, std::size_t j) {
    const Vec3 p = vec(base_.positions[face[0]]);
    const double u = static_cast<double>(i) / static_cast<double>(parts_);
    const double v = static_cast<double>(j) / static_cast<double>(parts_);
    const Vec3 q = p + u * (vec(base_.positions[face[1]]) - p) + v * (vec(base_.positions[face[2]]) - p);
    mesh_.positions.push_back(position(q));
    return index(mesh_.positions.size() - 1);
  }

  // Vertex `step` of the way from a to b; the inner ones are made when the edge is first seen.
  std::uint32_t edge_vertex(std::uint32_t a, std::uint32_t b, std::size_t step) {
    if (step == 0) return a;
    if (step == parts_) return b;
    if (a > b) return edge_vertex(b, a, parts_ - step);
    const auto [entry, is_new] = first_on_edge_.try_emplace({a, b}, index(mesh_.positions.size()));
    if (is_new) {
      for (std::size_t i = 1; i < parts_; ++i) add_vertex({a, b, b}, i, 0);
    }
    return entry->second + index(step - 1);
  }

  // Row j of a face runs parallel to the edge from corner 0 to corner 1 and has parts - j cells.
  Loop row(const Triangle& face, std::size_t j) {
    Loop vertices;
    vertices.push_back(edge_vertex(face[0], face[2], j));
    const std::size_t cells = parts_ - j;
    for (std::size_t i = 1; i < cells; ++i) {
      vertices.push_back(j == 0 ? edge_vertex(face[0], face[1], i) : add_vertex(face, i, j));
    }
    if (cells > 0) vertices.push_back(edge_vertex(face[1], face[2], j));
    return vertices;
  }

  void add_face(const Triangle& face) {
    Loop lower = row(face, 0);
    for (std::size_t j = 0; j < parts_; ++j) {
      Loop upper = row(face, j + 1);
      for (std::size_t i = 0; i + 1 < lower.size(); ++i) {
        mesh_.triangles.push_back({lower[i], lower[i + 1], upper[i]});
        if (i + 1 < upper.size()) mesh_.triangles.push_back({lower[i + 1], upper[i + 1], upper[i]});
      }
      lower = std::move(upper);
    }
  }

  const Mesh& base_;
  std::size_t parts_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> first_on_edge_;
  Mesh mesh_;
};

// As many segments a circle as the target allows, up to 64; beyond that all faces are refined.
Mesh make_bracket(std::size_t faces, std::uint64_t seed) {
  const double most = static_cast<double>(Bracket::face_count(64));
  const double parts = std::max(1.0, std::ceil(std::sqrt(static_cast<double>(faces) / most)));
  const double base_faces = static_cast<double>(faces) / (parts * parts);
  const Mesh base = Bracket(at_least(3, (base_faces - 32) / 16), seed).make();
  return Subdivision(base, static_cast<std::size_t>(parts)).run();
}

// ---------------------------------------------------------------------------------------------------- nested

// The cavity has to stay inside the flat faces of a coarse outer sphere: hence the radii and the smallest size.
Mesh make_nested(std::size_t faces, std::uint64_t seed) {
  constexpr double cavity_radius = 0.72, ball_radius = 0.4;
  constexpr double area = 1 + cavity_radius * cavity_radius + ball_radius * ball_radius;
  const auto share = [&](double radius) { return at_least(12, static_cast<double>(faces) * radius * radius / area); };

  Mesh mesh = unit_sphere(share(1));
  Mesh cavity = unit_sphere(share(cavity_radius));
  map_positions(cavity, [&](const Vec3& p) -> Vec3 { return p * cavity_radius; });
  reverse_orientation(cavity);
  append(mesh, cavity);

  Random random(seed);
  const double x = random.uniform(-0.03, 0.03), y = random.uniform(-0.03, 0.03), z = random.uniform(-0.03, 0.03);
  const Vec3 centre(x, y, z);
  Mesh ball = unit_sphere(share(ball_radius));
  map_positions(ball, [&](const Vec3& p) -> Vec3 { return centre + p * ball_radius; });
  append(mesh, ball);
  return mesh;
}

// ----------------------------------------------------------------------------------------------------- slabs

Mesh make_slabs(std::size_t faces, std::uint64_t seed) {
  constexpr double half_thickness = 0.02;
  const double gap = Random(seed).uniform(0.006, 0.012);
  const Vec3 half(1, half_thickness, 0.8);
  Mesh mesh;
  for (double side : {-1.0, 1.0}) {
    Mesh plate = cut_cube(box_cells(faces / 2, half));
    const Vec3 centre(0, side * (half_thickness + gap / 2), 0);
    map_positions(plate, [&](const Vec3& p) -> Vec3 { return centre + p.cwiseProduct(half); });
    append(mesh, plate);
  }
  return mesh;
}

// ----------------------------------------------------------------------------------------------------- table

constexpr ShapeInfo shape_infos[] = {
    {"sphere", "plain unit sphere (the seed changes nothing)", 12, 1, 2},
    {"bumpy", "sphere displaced by six octaves of smooth noise", 12, 1, 2},
    {"spikes", "ball with needles and steep saddle points: hard to displace", 48, 1, 2},
    {"knot", "tube around a torus knot, genus 1", 144, 1, 0},
    {"gyroid", "thick gyroid wall cut by a ball: one body of high genus", 400, 1, std::nullopt},
    {"bracket", "machine part with sharp edges, holes and thin triangles, genus 3", 80, 1, -4},
    {"nested", "hollow ball with a smaller ball in its cavity", 192, 3, 6},
    {"slabs", "two thin plates, a narrow gap apart", 40, 2, 4},
};

constexpr Mesh (*shape_makers[])(std::size_t, std::uint64_t) = {make_sphere, make_bumpy,   make_spikes, make_knot,
                                                                make_gyroid, make_bracket, make_nested, make_slabs};

static_assert(std::size(shape_infos) == std::size(shape_makers));

constexpr std::size_t most_faces = 1000000000;

}  // namespace

std::span<const ShapeInfo> shape_table() { return shape_infos; }

Mesh make_shape(const std::string& name, std::size_t target_faces, std::uint64_t seed, std::string& error) {
  if (target_faces > most_faces) {
    error = "a shape has at most " + std::to_string(most_faces) + " faces";
    return {};
  }
  for (std::size_t i = 0; i < std::size(shape_infos); ++i) {
    if (name == shape_infos[i].name) return shape_makers[i](std::max(target_faces, shape_infos[i].smallest), seed);
  }
  error = "no shape is called \"" + name + "\"; there are";
  for (const ShapeInfo& info : shape_infos) error += std::string(" ") + info.name;
  return {};
}

}  // namespace prcage
