// Good cages are certified, and cages broken on purpose are refused, each for the reason for which it was broken.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "core/prcage.h"
#include "solids.h"

namespace prcage {
namespace {

using testing::cube;
using testing::inside_out;
using testing::merge;
using testing::sphere;

// The claims that do not hold.
std::string refused(const Certificate& c) {
  std::string names;
  const auto add = [&](bool holds, const char* name) {
    if (!holds) names += (names.empty() ? "" : " ") + std::string(name);
  };
  add(c.closed, "closed");
  add(c.manifold, "manifold");
  add(c.oriented, "oriented");
  add(c.no_degenerate_face, "degenerate");
  add(c.self_intersection_free, "self_intersection");
  add(c.no_contact, "contact");
  add(c.encloses, "encloses");
  add(c.euler_characteristic_equal, "euler");
  add(c.component_count_equal, "components");
  EXPECT_EQ(c.valid(), names.empty());
  return names;
}

std::string refused(const Mesh& input, const Mesh& cage) { return refused(certify(input, cage, 2)); }

TEST(Certify, GoodCages) {
  EXPECT_EQ(refused(sphere(3), cube(2.5)), "");
  EXPECT_EQ(refused(cube(1), cube(1 + 1e-15)), "");
  EXPECT_EQ(refused(testing::torus(48, 24, 1, 0.2), testing::torus(12, 6, 1, 0.4)), "");
  const Certificate c = certify(sphere(3), cube(2.5));
  EXPECT_EQ(c.components, 1u);
  EXPECT_EQ(c.euler_characteristic, 2);
  EXPECT_EQ(c.contacts + c.self_intersections, 0u);
}

TEST(Certify, GoodCagesOfSeveralComponents) {
  const Mesh pair = merge(sphere(2), sphere(2, 1, {5, 0, 0}));
  EXPECT_EQ(refused(pair, merge(cube(2.5), cube(2.5, {5, 0, 0}))), "");
  EXPECT_EQ(refused(pair, merge(cube(2.5, {5, 0, 0}), cube(2.5))), "");
  // A hollow solid: the cage of the cavity lies within it.
  const Mesh hollow = merge(cube(10), inside_out(cube(6)));
  EXPECT_EQ(refused(hollow, merge(cube(11), inside_out(cube(5)))), "");
  // An island in the cavity, with a cage between the two.
  const Mesh island = merge(hollow, cube(2));
  EXPECT_EQ(refused(island, merge(merge(cube(11), inside_out(cube(5))), cube(3))), "");
}

TEST(Certify, Open) {
  Mesh cage = cube(3);
  cage.triangles.pop_back();
  EXPECT_EQ(refused(sphere(2), cage), "closed encloses euler");
}

TEST(Certify, NotOriented) {
  Mesh cage = cube(3);
  std::swap(cage.triangles[2][0], cage.triangles[2][1]);
  EXPECT_EQ(refused(sphere(2), cage), "oriented encloses");
}

TEST(Certify, NonManifoldVertex) {
  // Two cages that share a corner: the same components and Euler characteristic one less.
  const Mesh input = merge(sphere(2, 0.4), sphere(2, 0.4, {1, 1, 1}));
  Mesh cage = merge(cube(1), cube(1, {1, 1, 1}));
  std::uint32_t u = 0;
  std::uint32_t v = 8;
  for (std::uint32_t i = 0; i < 8; ++i)
    for (std::uint32_t j = 8; j < 16; ++j)
      if (cage.positions[i] == cage.positions[j]) u = i, v = j;
  ASSERT_EQ(refused(input, cage), "self_intersection encloses");  // one position, two vertices: contact
  for (auto& t : cage.triangles) std::replace(t.begin(), t.end(), v, u);
  EXPECT_EQ(refused(input, cage), "manifold encloses euler");
}

TEST(Certify, NonManifoldEdge) {
  Mesh cage = cube(3);
  const auto [a, b, c] = cage.triangles[0];
  static_cast<void>(c);
  cage.positions.push_back({0, 0, -9});
  cage.triangles.push_back({a, b, 8});
  cage.triangles.push_back({b, a, 8});
  EXPECT_EQ(refused(sphere(2), cage), "manifold self_intersection encloses euler");
}

TEST(Certify, DegenerateFace) {
  // A vertex in the middle of an edge, used on one side only, with a zero-area face between.
  Mesh cage = cube(4);
  const auto [a, b, c] = cage.triangles[4];
  std::array<double, 3> m;
  for (std::size_t k = 0; k < 3; ++k) m[k] = 0.5 * (cage.positions[a][k] + cage.positions[b][k]);
  cage.positions.push_back(m);
  cage.triangles[4] = {a, 8, c};
  cage.triangles.push_back({8, b, c});
  cage.triangles.push_back({a, b, 8});
  const Certificate certificate = certify(sphere(2), cage);
  EXPECT_FALSE(certificate.no_degenerate_face);
  EXPECT_FALSE(certificate.self_intersection_free);
  EXPECT_TRUE(certificate.closed && certificate.manifold && certificate.oriented && certificate.encloses);
}

TEST(Certify, SelfIntersection) {
  Mesh cage = sphere(2, 3);
  cage.positions[0] = {-9, 0, 0};  // pulled through the other side, round the input
  const Certificate c = certify(sphere(2, 0.1, {0, 2, 0}), cage);
  EXPECT_FALSE(c.self_intersection_free);
  EXPECT_GT(c.self_intersections, 4u);
}

TEST(Certify, Contact) {
  EXPECT_EQ(refused(cube(1), cube(1)), "contact encloses");
  EXPECT_EQ(refused(sphere(2), sphere(2, 0.99)), "encloses");
  const Certificate cut = certify(sphere(2), cube(1.9));
  EXPECT_GT(cut.contacts, 0u);
  EXPECT_EQ(refused(cut), "contact encloses");
  // One vertex of the input on a face of the cage.
  EXPECT_EQ(refused(sphere(2), cube(2)), "contact encloses");
  EXPECT_EQ(certify(sphere(2), cube(std::nextafter(2.0, 3.0))).contacts, 0u);
}

TEST(Certify, DoesNotEnclose) {
  EXPECT_EQ(refused(sphere(2), cube(3, {9, 0, 0})), "encloses");
  EXPECT_EQ(refused(sphere(2), cube(0.1)), "encloses");
  EXPECT_EQ(refused(sphere(2), inside_out(cube(3))), "encloses");
  // One of two components stays outside.
  const Mesh pair = merge(sphere(2), sphere(2, 1, {9, 0, 0}));
  EXPECT_EQ(refused(pair, merge(cube(3), cube(3, {20, 0, 0}))), "encloses");
}

TEST(Certify, NestedCages) {
  const Mesh pair = merge(sphere(2, 1, {-1.5, 0, 0}), sphere(2, 1, {1.5, 0, 0}));
  // Two layers round both: the winding number is two.
  EXPECT_EQ(refused(pair, merge(cube(8), cube(9))), "encloses");
  // One cage round both and a second one that holds nothing, or a cavity that holds nothing.
  EXPECT_EQ(refused(pair, merge(cube(8), cube(1, {20, 0, 0}))), "");
  EXPECT_EQ(refused(pair, merge(cube(8), inside_out(cube(0.5, {0, 3, 0})))), "");
  // A cavity round one of the components takes it out of the cage.
  EXPECT_EQ(refused(pair, merge(cube(8), inside_out(cube(2.5, {1.5, 0, 0})))), "encloses");
  // A hole in the cage within the input's solid.
  EXPECT_EQ(refused(pair, merge(cube(8), inside_out(cube(0.5, {1.5, 0, 0})))), "encloses");
}

TEST(Certify, EulerAndComponents) {
  EXPECT_EQ(refused(sphere(2, 0.2, {1, 0, 0}), testing::torus(24, 12, 1, 0.4)), "euler");
  EXPECT_EQ(refused(testing::torus(), cube(4)), "euler");
  const Mesh pair = merge(sphere(2), sphere(2, 1, {5, 0, 0}));
  EXPECT_EQ(refused(pair, cube(20)), "euler components");
  // A sphere and a torus for two things of the Euler characteristic of one.
  EXPECT_EQ(refused(sphere(2), merge(cube(3), testing::torus(24, 12, 20, 1))), "components");
}

TEST(Certify, UnreferencedVerticesDoNotMatter) {
  Mesh input = sphere(2);
  Mesh cage = cube(3);
  input.positions.push_back({std::nan(""), 0, 0});
  cage.positions.push_back({1e300, 0, 0});
  EXPECT_EQ(refused(input, cage), "");
}

TEST(Certify, MalformedMeshesAreNotCertified) {
  const std::string all = "closed manifold oriented degenerate self_intersection contact encloses euler components";
  EXPECT_EQ(refused(sphere(2), Mesh{}), all);
  EXPECT_EQ(refused(Mesh{}, cube(3)), all);
  EXPECT_EQ(refused(certify(MeshView{}, MeshView{})), all);
  Mesh bad = cube(3);
  bad.triangles[0][0] = 99;
  EXPECT_EQ(refused(sphere(2), bad), all);
  EXPECT_EQ(refused(bad, cube(9)), all);
  bad = cube(3);
  bad.triangles[0][0] = bad.triangles[0][1];
  EXPECT_EQ(refused(sphere(2), bad), all);
  for (const double x : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300}) {
    bad = cube(3);
    bad.positions[5][0] = x;
    EXPECT_EQ(refused(sphere(2), bad), all);
    EXPECT_EQ(refused(bad, cube(9)), all);
  }
}

// An open input has no inside.
TEST(Certify, OpenInputIsNotEnclosed) {
  Mesh input = sphere(2);
  input.triangles.pop_back();
  EXPECT_EQ(refused(input, cube(3)), "encloses euler");
}

TEST(Certify, ScalesFarApart) {
  EXPECT_EQ(refused(testing::scaled(sphere(2), 1e-50), cube(1e14)), "");
  EXPECT_EQ(refused(testing::scaled(sphere(2), 1e-50), cube(1e14, {1e14, 0, 0})), "encloses");
}

}  // namespace
}  // namespace prcage
