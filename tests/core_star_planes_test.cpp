// The planes and quadrics of stars against their definitions, written down plainly, and for every instruction set of
// this machine against the scalar twin, bit for bit; and the walk round an edge that gathers them.
#include "core/star_planes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <set>
#include <vector>

#include "core/edge_star.h"
#include "core/qp3.h"
#include "core/vec3.h"
#include "random.h"
#include "solids.h"

namespace prcage {
namespace {

using testing::Random;

// What the padding holds, and what the makers may not write beyond it.
constexpr double junk = 1e200;

// Stars in the flat form of the kernels. They need not be parts of a mesh: any corners will do.
struct Stars {
  std::vector<StarFrame> frame;
  std::vector<double> x, y, z, lower, upper;
  std::uint32_t row_numbers = 0;

  void add(const Vec3& tail, const Vec3& head, std::size_t tail_faces, const std::vector<Vec3>& corners,
           const std::vector<double>& low, const std::vector<double>& high) {
    StarFrame f{};
    const Vec3 middle = 0.5 * (tail + head);
    for (Eigen::Index k = 0; k < 3; ++k) {
      f.origin[k] = middle[k];
      f.tail[k] = tail[k];
      f.head[k] = head[k];
    }
    f.scale = (head - tail).norm();
    f.first_corner = static_cast<std::uint32_t>(x.size());
    f.first_row = row_numbers;
    f.faces = static_cast<std::uint32_t>(corners.size() - 1);
    f.tail_faces = static_cast<std::uint32_t>(tail_faces);
    frame.push_back(f);
    row_numbers += static_cast<std::uint32_t>(slab_rows * row_length(f.faces));
    for (const Vec3& c : corners) {
      x.push_back(c.x());
      y.push_back(c.y());
      z.push_back(c.z());
    }
    lower.insert(lower.end(), low.begin(), low.end());
    upper.insert(upper.end(), high.begin(), high.end());
    lower.resize(x.size(), junk);
    upper.resize(x.size(), junk);
  }
};

struct Planes {
  std::vector<double> rows;
  std::vector<double> quadric;  // ten each: form, linear, constant

  // Number k of a row of a star.
  double number(const StarFrame& f, std::size_t row, std::size_t k) const {
    return rows[f.first_row + row * row_length(f.faces) + k];
  }
  Vec3 normal(const StarFrame& f, std::size_t row, std::size_t k) const {
    return {number(f, row, k), number(f, row + 1, k), number(f, row + 2, k)};
  }
};

constexpr double margin = 1e-9, absolute_margin = 1e-7, height_fraction = 1e-2;

Planes planes_by(SimdLevel level, Stars stars) {
  const std::size_t n = stars.frame.size();
  for (auto* values : {&stars.x, &stars.y, &stars.z, &stars.lower, &stars.upper})
    values->resize(values->size() + star_padding, junk);
  Planes p;
  p.rows.assign(stars.row_numbers + star_padding, junk);
  std::vector<double> form(6 * n), linear(3 * n), constant(n);
  make_star_planes({n,
                    stars.frame.data(),
                    {stars.x.data(), stars.y.data(), stars.z.data()},
                    stars.lower.data(),
                    stars.upper.data(),
                    margin,
                    absolute_margin,
                    height_fraction,
                    p.rows.data(),
                    form.data(),
                    linear.data(),
                    constant.data()},
                   level);
  p.rows.resize(stars.row_numbers);
  for (std::size_t i = 0; i < n; ++i) {
    p.quadric.insert(p.quadric.end(), &form[6 * i], &form[6 * i] + 6);
    p.quadric.insert(p.quadric.end(), &linear[3 * i], &linear[3 * i] + 3);
    p.quadric.push_back(constant[i]);
  }
  return p;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

void expect_same_bits(const Stars& stars) {
  const Planes expected = planes_by(SimdLevel::scalar, stars);
  for (const SimdLevel level : available_simd_levels()) {
    const Planes got = planes_by(level, stars);
    EXPECT_TRUE(same_bits(got.rows, expected.rows)) << name_of(level);
    EXPECT_TRUE(same_bits(got.quadric, expected.quadric)) << name_of(level);
  }
}

// A star of `faces` faces somewhere; a share of the faces has no area.
void add_random(Stars& stars, std::size_t faces, double thin, Random& random) {
  const double scale = std::pow(10, random.uniform(-6, 3));
  const Vec3 tail = scale * random.uniform(0, 20) * random.unit();
  const Vec3 head = tail + scale * random.uniform(0.1, 1) * random.unit();
  const std::size_t tail_faces = random.below(faces - 1);
  std::vector<Vec3> corners{tail + scale * random.unit()};
  std::vector<double> low, high;
  for (std::size_t k = 0; k < faces; ++k) {
    const Vec3& moving = k < tail_faces ? tail : head;
    const bool degenerate = random.uniform(0, 1) < thin;
    switch (degenerate ? random.below(3) : 3) {
      case 0:
        corners.push_back(corners.back());
        break;
      case 1:
        corners.push_back(moving);
        break;
      case 2:
        corners.push_back(moving + 1e-12 * (corners.back() - moving));
        break;
      default:
        corners.push_back(moving + scale * random.uniform(0.2, 2) * random.unit());
    }
    low.push_back(scale * random.uniform(-0.1, 0.1));
    high.push_back(low.back() + scale * random.uniform(0, 0.3));
  }
  stars.add(tail, head, tail_faces, corners, low, high);
}

// A star of each size, so that every position of the last face in a vector occurs, several times over.
Stars stars_of_all_sizes(double thin, std::uint64_t seed) {
  Random random(seed);
  Stars stars;
  for (int repeat = 0; repeat < 20; ++repeat)
    for (std::size_t faces = 2; faces <= 40; ++faces) add_random(stars, faces, thin, random);
  return stars;
}

TEST(StarPlanes, SameBitsForEveryInstructionSet) {
  expect_same_bits({});
  for (const double thin : {0.0, 0.2, 1.0})
    for (std::uint64_t seed = 0; seed < 5; ++seed) expect_same_bits(stars_of_all_sizes(thin, seed));
  Stars large;
  Random random(1);
  for (const std::size_t faces : {512u, 3u, 1000u, 2u}) add_random(large, faces, 0.1, random);
  expect_same_bits(large);
}

TEST(StarPlanes, SameBitsWhateverTheNeighbours) {
  const Stars all = stars_of_all_sizes(0.2, 77);
  const Planes together = planes_by(SimdLevel::scalar, all);
  for (std::size_t i = 0; i < all.frame.size(); ++i) {
    Stars one = all;
    one.frame = {all.frame[i]};
    one.frame[0].first_row = 0;
    one.row_numbers = static_cast<std::uint32_t>(slab_rows * row_length(all.frame[i].faces));
    const Planes alone = planes_by(available_simd_levels().back(), one);
    EXPECT_TRUE(std::equal(alone.rows.begin(), alone.rows.end(), together.rows.begin() + all.frame[i].first_row));
    EXPECT_TRUE(std::equal(alone.quadric.begin(), alone.quadric.end(),
                           together.quadric.begin() + static_cast<std::ptrdiff_t>(10 * i)));
  }
}

// ------------------------------------------------------------------------------------------ definitions

struct Face {
  Vec3 moving, v1, v2;  // local

  Vec3 normal() const { return (v1 - moving).cross(v2 - moving).normalized(); }
  double area() const { return 0.5 * (v1 - moving).cross(v2 - moving).norm(); }
  Vec3 centroid() const { return (moving + v1 + v2) / 3; }
  // Nearly degenerate ones amplify rounding.
  double condition() const {
    const double longest = std::max({(v1 - moving).norm(), (v2 - moving).norm(), (v2 - v1).norm()});
    return longest * longest / area();
  }
};

Face local_face(const Stars& stars, const StarFrame& f, std::size_t k) {
  const Vec3 origin(f.origin[0], f.origin[1], f.origin[2]);
  const auto local = [&](const Vec3& p) -> Vec3 { return (p - origin) / f.scale; };
  const auto corner = [&](std::size_t i) { return local({stars.x[i], stars.y[i], stars.z[i]}); };
  const double* moving = k < f.tail_faces ? f.tail : f.head;
  const std::size_t i = f.first_corner + k;
  return {local({moving[0], moving[1], moving[2]}), corner(i), corner(i + 1)};
}

// Heights of a point above the planes of face k, from the definitions and from the planes.
void expect_planes(const Stars& stars, const StarFrame& f, std::size_t k, const Planes& planes) {
  const Face face = local_face(stars, f, k);
  const std::size_t i = f.first_corner + k;
  const double close = 1e-14 * face.condition() * (10 + face.centroid().norm());
  const Vec3 n = planes.normal(f, slab_normal, k);
  for (const Vec3& x : {Vec3(0, 0, 0), Vec3(0.3, -0.2, 0.7)}) {
    const double height = face.normal().dot(x - face.centroid());
    EXPECT_NEAR(n.dot(x) - planes.number(f, slab_lower, k),
                height - stars.lower[i] / f.scale - margin - absolute_margin / f.scale, close);
    EXPECT_NEAR(planes.number(f, slab_upper, k) - n.dot(x), stars.upper[i] / f.scale - height, close);
    if (k + 2 >= f.faces) continue;
    const Vec3 inward = face.normal().cross(face.v2 - face.v1).normalized();
    const double present = inward.dot(face.moving - face.v1);
    EXPECT_NEAR(planes.normal(f, slab_inward, k).dot(x) - planes.number(f, slab_inward_offset, k),
                inward.dot(x - face.v1) - height_fraction * present, close);
  }
}

// Of faces from number k on.
void expect_free(const Planes& planes, const StarFrame& f, std::size_t k) {
  for (; k < row_length(f.faces); ++k) {
    EXPECT_EQ(planes.normal(f, slab_normal, k), Vec3(0, 0, 0));
    EXPECT_EQ(planes.normal(f, slab_inward, k), Vec3(0, 0, 0));
    EXPECT_LT(planes.number(f, slab_lower, k), 0);
    EXPECT_GT(planes.number(f, slab_upper, k), 0);
    EXPECT_LT(planes.number(f, slab_inward_offset, k), 0);
  }
}

TEST(StarPlanes, AreThoseOfTheDefinitions) {
  const Stars stars = stars_of_all_sizes(0, 3);
  const Planes planes = planes_by(SimdLevel::scalar, stars);
  for (const StarFrame& f : stars.frame)
    for (std::size_t k = 0; k < f.faces; ++k) expect_planes(stars, f, k, planes);
}

TEST(StarPlanes, WhatFillsTheRowsConstrainsNothing) {
  const Stars stars = stars_of_all_sizes(0, 6);
  for (const SimdLevel level : available_simd_levels()) {
    const Planes planes = planes_by(level, stars);
    for (const StarFrame& f : stars.frame) {
      expect_free(planes, f, f.faces);
      for (std::size_t k = f.faces - 2; k < f.faces; ++k) EXPECT_EQ(planes.normal(f, slab_inward, k), Vec3(0, 0, 0));
    }
  }
}

TEST(StarPlanes, QuadricIsTheSumOfSquaredDistancesToThePlanes) {
  const Stars stars = stars_of_all_sizes(0, 4);
  const Planes planes = planes_by(SimdLevel::scalar, stars);
  for (std::size_t i = 0; i < stars.frame.size(); ++i) {
    const double* q = &planes.quadric[10 * i];
    const Symmetric3 form{q[0], q[1], q[2], q[3], q[4], q[5]};
    for (const Vec3& x : {Vec3(0, 0, 0), Vec3(0.3, -0.2, 0.7), Vec3(-2, 1, 1)}) {
      double expected = 0, size = 0;
      for (std::size_t k = 0; k < stars.frame[i].faces; ++k) {
        const Face face = local_face(stars, stars.frame[i], k);
        const double height = face.normal().dot(x - face.centroid());
        expected += 0.5 * face.area() * height * height;
        size += face.area() * (x.squaredNorm() + face.centroid().squaredNorm());
      }
      const double got = x.dot(0.5 * (form * x)) + Vec3(q[6], q[7], q[8]).dot(x) + q[9];
      EXPECT_NEAR(got, expected, 1e-12 * size);
    }
  }
}

TEST(StarPlanes, ThinFacesConstrainNothing) {
  Random random(5);
  Stars stars;
  for (std::size_t faces = 2; faces < 30; ++faces) add_random(stars, faces, 1, random);
  for (const SimdLevel level : available_simd_levels()) {
    const Planes planes = planes_by(level, stars);
    for (const StarFrame& f : stars.frame) expect_free(planes, f, 0);
    EXPECT_TRUE(std::all_of(planes.quadric.begin(), planes.quadric.end(), [](double q) { return q == 0; }));
  }
}

// ------------------------------------------------------------------------------------------ the walk

// Every face at an endpoint, once, with its corners in the promised places.
void expect_star(const CornerTable& mesh, std::uint32_t h, const EdgeStar& star) {
  const std::uint32_t a = mesh.origin(h), b = mesh.target(h);
  const auto faces = star.faces();
  const auto vertices = star.vertices();
  ASSERT_EQ(vertices.size(), faces.size() + 1);
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const std::uint32_t f = faces[k];
    const std::uint32_t moving = k < star.tail_faces() ? a : b;
    std::uint32_t g = 3 * f;
    while (mesh.origin(g) != moving && g < 3 * f + 2) ++g;
    EXPECT_EQ(mesh.origin(g), moving);
    EXPECT_EQ(mesh.target(g), vertices[k]);
    EXPECT_EQ(mesh.apex(g), vertices[k + 1]);
  }
  EXPECT_EQ(faces[faces.size() - 2], h / 3);
  EXPECT_EQ(faces[faces.size() - 1], mesh.twin[h] / 3);
  EXPECT_EQ(std::set(faces.begin(), faces.end()).size(), faces.size());
  EXPECT_EQ(faces.size(), mesh.valence(a) + mesh.valence(b) - 2);
}

TEST(EdgeStar, HoldsEveryFaceAtTheEndpoints) {
  EdgeStar star;
  for (const Mesh& input : {testing::shape("bumpy", 300), testing::shape("knot", 300), testing::tetrahedron(),
                            testing::saddle_cone(90, 0.1)}) {
    const CornerTable mesh = CornerTable::from_mesh(input);
    for (std::uint32_t h = 0; h < mesh.corner_vertex.size(); ++h) {
      ASSERT_TRUE(star.walk(mesh, h));
      EXPECT_EQ(star.halfedge(), h);
      expect_star(mesh, h, star);
      const auto size = static_cast<std::uint32_t>(star.faces().size());
      EXPECT_FALSE(star.walk(mesh, h, size - 1));
      EXPECT_TRUE(star.walk(mesh, h, size));
    }
  }
}

}  // namespace
}  // namespace prcage
