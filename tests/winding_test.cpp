// Winding numbers against answers known from the shape, on points that make naive ray casting fail, and the pairs of
// faces that Embree's joins find against all pairs.
#include "parallel/winding.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/predicates.h"
#include "parallel/arena.h"
#include "solids.h"

namespace prcage {
namespace {

// A mesh in a tree, with its components; on one arena for as long as it lives.
struct Scene {
  explicit Scene(Mesh m) : mesh(std::move(m)), tree(device) {
    tree.build(unit_frame(mesh.positions), mesh.positions, mesh.triangles);
    components = face_components(mesh.triangles.size(), group_edges(mesh.triangles, mesh.positions.size()));
  }
  Mesh mesh;
  TreeDevice device;
  SurfaceTree tree;
  Components components;
};

std::vector<int> numbers(const Mesh& mesh, const std::vector<Position>& points) {
  std::vector<int> result;
  Arena(2).run([&] {
    const Scene scene(mesh);
    for (const Winding& w : winding_numbers(scene.device, scene.tree, points))
      result.push_back(w.known ? w.number : 999);
  });
  return result;
}

TEST(Winding, NestedCubes) {
  Mesh mesh = testing::cube(10);
  mesh = testing::merge(mesh, testing::cube(8));
  mesh = testing::merge(mesh, testing::inside_out(testing::cube(4)));
  mesh = testing::merge(mesh, testing::inside_out(testing::cube(1, {100, 0, 0})));
  EXPECT_EQ(numbers(mesh, {{6, 0, 0}, {4.5, 0, 0}, {3, 0, 0}, {0, 0, 0}, {100, 0, 0}, {0, 0, 1000}}),
            (std::vector<int>{0, 1, 2, 1, -1, 0}));
}

TEST(Winding, OnTheSurfaceIsUnknown) {
  const Mesh cube = testing::cube(2);
  const double inside = std::nextafter(1.0, 0.0);
  EXPECT_EQ(numbers(cube, {{1, 1, 1}, {1, 0.5, 0.5}, {1, 0.25, 0.5}, {0, 1, 1}, {inside, 0.25, 0.5}}),
            (std::vector<int>{999, 999, 999, 999, 1}));
}

// Points in the planes of faces, in line with edges and vertices.
TEST(Winding, PointsAlignedWithEverything) {
  Mesh mesh;
  std::vector<Position> points;
  std::vector<int> expected;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) {
        mesh = testing::merge(mesh, testing::cube(2, {4.0 * i, 4.0 * j, 4.0 * k}));
        points.push_back({4.0 * i, 4.0 * j, 4.0 * k});
        expected.push_back(1);
        points.push_back({4.0 * i + 2, 4.0 * j + 1, 4.0 * k + 1});
        expected.push_back(0);
      }
  EXPECT_EQ(numbers(mesh, points), expected);
}

TEST(Winding, RandomPointsRoundATorus) {
  const Mesh mesh = testing::torus(96, 48, 1, 0.3);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> coordinate(-1.4, 1.4);
  std::vector<Position> points;
  std::vector<int> expected;
  while (points.size() < 4000) {
    const Position p{coordinate(random), coordinate(random), 0.3 * coordinate(random)};
    const double d = std::hypot(std::hypot(p[0], p[1]) - 1, p[2]);
    if (d > 0.29 && d < 0.3) continue;  // between the torus and its facets
    points.push_back(p);
    expected.push_back(d < 0.3 ? 1 : 0);
  }
  EXPECT_EQ(numbers(mesh, points), expected);
}

TEST(Winding, ZeroAreaFacesDoNotCount) {
  Mesh mesh = testing::cube(2);
  const Triangle t = mesh.triangles[4];  // split its diagonal from one side only
  const auto m = static_cast<std::uint32_t>(mesh.positions.size());
  Position middle;
  for (std::size_t k = 0; k < 3; ++k) middle[k] = 0.5 * (mesh.positions[t[2]][k] + mesh.positions[t[0]][k]);
  mesh.positions.push_back(middle);
  mesh.triangles[4] = {t[0], t[1], m};
  mesh.triangles.push_back({m, t[1], t[2]});
  mesh.triangles.push_back({m, t[2], t[0]});
  EXPECT_EQ(numbers(mesh, {{0, 0, 0}, {0.5, 0.125, 0.25}, middle}), (std::vector<int>{1, 1, 999}));
}

// Coordinates so coarse that segments start out exactly parallel to an axis: through diagonals of faces, along edges
// and in planes of faces.
TEST(Winding, SegmentsThatMeetEdgesAndVertices) {
  const double far = 9e14;
  Mesh mesh;
  std::vector<Position> points;
  std::vector<int> expected;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) {
        const Position centre{far + 128 * i, far + 128 * j, far + 128 * k};
        mesh = testing::merge(mesh, testing::cube(64, centre));
        mesh = testing::merge(mesh, testing::inside_out(testing::cube(16, centre)));
        points.push_back(centre);
        expected.push_back(0);
        points.push_back({centre[0] + 16, centre[1] + 8, centre[2] + 8});
        expected.push_back(1);
        points.push_back({centre[0] + 64, centre[1] + 32, centre[2] + 32});
        expected.push_back(0);
      }
  EXPECT_EQ(numbers(mesh, points), expected);
}

// Neither the origin nor the scale of the mesh matters.
TEST(Winding, FarAndSmall) {
  for (const double scale : {1e-50, 1e14}) {
    const Mesh mesh =
        testing::scaled(testing::merge(testing::cube(1, {5, 5, 5}), testing::cube(0.5, {5, 5, 5})), scale);
    EXPECT_EQ(numbers(mesh, {{5 * scale, 5 * scale, 5 * scale}, {5.3 * scale, 5 * scale, 5 * scale}}),
              (std::vector<int>{2, 1}));
  }
}

TEST(Nesting, SolidsCavitiesAndIslands) {
  Mesh mesh = testing::cube(10);                                                   // 0: solid
  mesh = testing::merge(mesh, testing::inside_out(testing::cube(8)));              // 1: its cavity
  mesh = testing::merge(mesh, testing::cube(6));                                   // 2: an island in it
  mesh = testing::merge(mesh, testing::cube(1));                                   // 3: inside the island: overlaps it
  mesh = testing::merge(mesh, testing::inside_out(testing::cube(1, {20, 0, 0})));  // 4: a hollow in nothing
  Arena(2).run([&] {
    const Scene scene(mesh);
    const auto nest = nesting(scene.device, scene.tree, scene.components);
    ASSERT_EQ(nest.size(), 5u);
    const int sign[5] = {1, -1, 1, 1, -1};
    const int others[5] = {0, 1, 0, 1, 0};
    const bool legal[5] = {true, true, true, false, false};
    for (std::size_t c = 0; c < 5; ++c) {
      EXPECT_EQ(nest[c].sign, sign[c]) << c;
      EXPECT_TRUE(nest[c].others.known);
      EXPECT_EQ(nest[c].others.number, others[c]) << c;
      EXPECT_EQ(nest[c].bounds_solid(), legal[c]) << c;
      EXPECT_EQ(nest[c].is_cavity(), c == 1);
    }
  });
}

// ------------------------------------------------------------------------------- intersections

// Triangles between points of a small grid: all kinds of contact happen, shared vertices and edges included.
Mesh random_soup(unsigned seed, std::size_t vertices, std::size_t faces) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> coordinate(0, 12);
  Mesh mesh;
  for (std::size_t v = 0; v < vertices; ++v)
    mesh.positions.push_back({0.1 * coordinate(random), 0.1 * coordinate(random), 0.1 * coordinate(random)});
  std::uniform_int_distribution<std::uint32_t> vertex(0, static_cast<std::uint32_t>(vertices - 1));
  while (mesh.triangles.size() < faces) {
    const Triangle t{vertex(random), vertex(random), vertex(random)};
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    if (exact::collinear(mesh.positions[t[0]].data(), mesh.positions[t[1]].data(), mesh.positions[t[2]].data()))
      continue;
    mesh.triangles.push_back(t);
  }
  return mesh;
}

TEST(Intersections, SelfPairsAreThoseOfAllPairs) {
  Arena(2).run([] {
    const Scene scene(random_soup(1, 150, 400));
    std::vector<std::array<std::uint32_t, 2>> expected;
    for (std::uint32_t i = 0; i < 400; ++i)
      for (std::uint32_t j = i + 1; j < 400; ++j)
        if (improper_contact(scene.tree.triangle(i), scene.tree.triangle(j))) expected.push_back({i, j});
    ASSERT_GT(expected.size(), 1000u);
    const FacePairs all = self_intersections(scene.tree);
    EXPECT_EQ(all.count, expected.size());
    EXPECT_EQ(all.pairs, expected);
    for (const std::size_t limit : {0u, 1u, 5u, 200u}) {
      const FacePairs some = self_intersections(scene.tree, limit);
      EXPECT_EQ(some.count, expected.size());
      EXPECT_EQ(some.pairs, decltype(expected)(expected.begin(), expected.begin() + static_cast<long>(limit)));
    }
  });
}

TEST(Intersections, PairsWithAChangedFace) {
  Arena(2).run([] {
    const Scene scene(random_soup(2, 150, 400));
    std::vector<std::uint8_t> is_changed(400, 0);
    for (std::size_t f = 0; f < 400; f += 7) is_changed[f] = is_changed[(f * f) % 400] = 1;
    SurfaceTree changed(scene.device);
    changed.build(scene.tree.frame(), scene.mesh.positions, scene.mesh.triangles, is_changed);
    std::vector<std::array<std::uint32_t, 2>> expected;
    for (const auto& pair : self_intersections(scene.tree).pairs)
      if (is_changed[pair[0]] != 0 || is_changed[pair[1]] != 0) expected.push_back(pair);
    const FacePairs found = self_intersections(scene.tree, changed, is_changed);
    EXPECT_EQ(found.count, expected.size());
    EXPECT_EQ(found.pairs, expected);
  });
}

TEST(Intersections, ContactsAreThoseOfAllPairs) {
  Arena(2).run([] {
    const Scene a(random_soup(3, 100, 200));
    Mesh other = random_soup(4, 100, 200);
    other.triangles.push_back({0, 1, 2});
    other.positions[0] = other.positions[1] = other.positions[2] = a.mesh.positions[a.mesh.triangles[0][0]];
    TreeDevice device;
    SurfaceTree b(device);
    b.build(a.tree.frame(), other.positions, other.triangles);
    std::vector<std::array<std::uint32_t, 2>> expected;
    for (std::uint32_t i = 0; i < a.mesh.triangles.size(); ++i)
      for (std::uint32_t j = 0; j < other.triangles.size(); ++j)
        if (exact::triangles_intersect(a.tree.corner(i, 0), a.tree.corner(i, 1), a.tree.corner(i, 2), b.corner(j, 0),
                                       b.corner(j, 1), b.corner(j, 2)))
          expected.push_back({i, j});
    ASSERT_GT(expected.size(), 1000u);
    const FacePairs found = contacts(a.tree, b);
    EXPECT_EQ(found.count, expected.size());
    EXPECT_EQ(found.pairs, expected);
  });
}

}  // namespace
}  // namespace prcage
