// The built-in shapes. See shapes.h for what they promise.
//
// One section per shape, the table of shapes at the end; the gyroid and the bracket have files of their own.
#include "tools/shapes.h"

#include "tools/shape_parts.h"

namespace prcage {
namespace {

using namespace shape;

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
