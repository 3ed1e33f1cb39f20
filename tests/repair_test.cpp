// Zero-area faces made on purpose, and what their removal must keep: the point set, the volume to the last bit,
// connectivity, Euler characteristic.
#include "core/repair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "core/adjacency.h"
#include "parallel/arena.h"
#include "parallel/validate.h"
#include "solids.h"

namespace prcage {
namespace {

std::vector<std::uint32_t> find_degenerate(const Mesh& mesh) {
  std::vector<std::uint32_t> found;
  Arena(1).run([&] { found = degenerate_faces(mesh.positions, mesh.triangles); });
  return found;
}

Repair repair(const Mesh& mesh) {
  EdgeDefects defects;
  auto twin = pair_halfedges(mesh.triangles, mesh.positions.size(), defects);
  EXPECT_TRUE(defects.empty());
  return remove_degenerate_faces(mesh, std::move(twin), find_degenerate(mesh));
}

std::set<Position> points(const Mesh& mesh) { return {mesh.positions.begin(), mesh.positions.end()}; }

long long euler(const Mesh& mesh) {
  return static_cast<long long>(mesh.positions.size()) + static_cast<long long>(mesh.triangles.size()) -
         static_cast<long long>(group_edges(mesh.triangles, mesh.positions.size()).size());
}

// What holds for every repair, complete or not.
void expect_same_solid(const Mesh& before, const Repair& result) {
  const Mesh& after = result.surface.mesh;
  EXPECT_EQ(points(after), points(before));
  EXPECT_EQ(euler(after), euler(before));
  EXPECT_EQ(result.degenerate, find_degenerate(after));
  EdgeDefects defects;
  pair_halfedges(after.triangles, after.positions.size(), defects);
  EXPECT_TRUE(defects.empty());
  const EdgeGroups edges = group_edges(after.triangles, after.positions.size());
  EXPECT_TRUE(non_manifold_vertices(after.triangles, after.positions.size(), edges).empty());
  EXPECT_TRUE(duplicate_faces(after.triangles, edges).empty());
  EXPECT_NEAR(measure(after.positions, after.triangles).volume, measure(before.positions, before.triangles).volume,
              1e-12);
  EXPECT_EQ(after.triangles.size() + 2 * result.collapses, before.triangles.size());
  for (std::size_t v = 0; v < after.positions.size(); ++v)
    EXPECT_EQ(after.positions[v], before.positions[result.surface.vertex_of[v]]);
}

// Puts a vertex on the edge between two vertices, as part of one of its two faces only, which leaves a cap over the
// edge: (a, b, c) becomes (a, m, c), (m, b, c) and the cap (a, b, m).
std::uint32_t cut_edge_from_one_side(Mesh& mesh, std::size_t face, double at) {
  const auto [a, b, c] = mesh.triangles[face];
  Position p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = (1 - at) * mesh.positions[a][k] + at * mesh.positions[b][k];
  const auto m = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.push_back(p);
  mesh.triangles[face] = {a, m, c};
  mesh.triangles.push_back({m, b, c});
  mesh.triangles.push_back({a, b, m});
  return m;
}

// Splits a vertex in two at one position: the faces round it between two of its neighbours go to the new one, and
// two needles fill the gap.
void duplicate_vertex(Mesh& mesh, std::uint32_t v) {
  EdgeDefects defects;
  const auto twin = pair_halfedges(mesh.triangles, mesh.positions.size(), defects);
  std::uint32_t first = 0;
  while (mesh.triangles[first / 3][first % 3] != v) ++first;
  const auto other = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.push_back(mesh.positions[v]);
  const std::uint32_t second = twin[previous_halfedge(first)];  // next face round v
  const std::uint32_t third = twin[previous_halfedge(second)];
  const std::uint32_t x = mesh.triangles[first / 3][next_halfedge(first) % 3];
  const std::uint32_t y = mesh.triangles[third / 3][next_halfedge(third) % 3];
  mesh.triangles[first / 3][first % 3] = other;
  mesh.triangles[second / 3][second % 3] = other;
  mesh.triangles.push_back({v, x, other});
  mesh.triangles.push_back({v, other, y});
}

TEST(Repair, LeavesAProperMeshAlone) {
  const Mesh mesh = testing::sphere(2);
  const Repair result = repair(mesh);
  EXPECT_EQ(result.surface.mesh.positions, mesh.positions);
  EXPECT_EQ(result.surface.mesh.triangles, mesh.triangles);
  EXPECT_EQ(result.flips + result.collapses, 0u);
}

TEST(Repair, DropsUnreferencedVertices) {
  Mesh mesh = testing::tetrahedron();
  mesh.positions.insert(mesh.positions.begin(), {7, 7, 7});
  for (auto& t : mesh.triangles)
    for (auto& v : t) ++v;
  const Repair result = repair(mesh);
  EXPECT_EQ(result.surface.mesh.positions, testing::tetrahedron().positions);
  EXPECT_EQ(result.surface.mesh.triangles, testing::tetrahedron().triangles);
  EXPECT_EQ(result.surface.vertex_of, (std::vector<std::uint32_t>{1, 2, 3, 4}));
}

TEST(Repair, FlipsACap) {
  Mesh mesh = testing::cube(2);
  cut_edge_from_one_side(mesh, 4, 0.25);
  ASSERT_EQ(find_degenerate(mesh).size(), 1u);
  const Repair result = repair(mesh);
  expect_same_solid(mesh, result);
  EXPECT_EQ(result.flips, 1u);
  EXPECT_TRUE(result.degenerate.empty());
}

// Several vertices on one edge, nested caps over it in every order of removal.
TEST(Repair, FlipsCapsOverCaps) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Mesh mesh = testing::cube(2);
    for (const double at : {0.5, 0.5, 0.25, 0.5, 0.75}) {
      cut_edge_from_one_side(mesh, mesh.triangles.size() - 1, at);
      if (at == 0.5) std::swap(mesh.triangles[4], mesh.triangles.back());
    }
    mesh = testing::shuffled(mesh, seed);
    const auto before = find_degenerate(mesh).size();
    ASSERT_GE(before, 2u);
    const Repair result = repair(mesh);
    expect_same_solid(mesh, result);
    EXPECT_TRUE(result.degenerate.empty()) << seed;
  }
}

// Two caps over the same edge, one from each side, with their corners in either order along it or at one position.
TEST(Repair, FlipsCapsThatShareTheirLongEdge) {
  for (const double other : {0.25, 0.5, 0.75}) {
    Mesh mesh = testing::cube(2);
    const Triangle f = mesh.triangles[0];
    cut_edge_from_one_side(mesh, 0, 0.5);
    for (std::size_t g = 1; g < 12; ++g)
      for (int turn = 0; turn < 3; ++turn) {
        Triangle& t = mesh.triangles[g];
        std::rotate(t.begin(), t.begin() + 1, t.end());
        if (t[0] == f[1] && t[1] == f[0]) {
          cut_edge_from_one_side(mesh, g, 1 - other);
          g = 12;
          break;
        }
      }
    ASSERT_EQ(find_degenerate(mesh).size(), 2u);
    const Repair result = repair(mesh);
    expect_same_solid(mesh, result);
    EXPECT_TRUE(result.degenerate.empty()) << other;
  }
}

TEST(Repair, CollapsesNeedles) {
  Mesh mesh = testing::sphere(2);
  for (const std::uint32_t v : {0u, 3u, 20u, 50u}) duplicate_vertex(mesh, v);
  ASSERT_EQ(find_degenerate(mesh).size(), 8u);
  const Repair result = repair(mesh);
  expect_same_solid(mesh, result);
  EXPECT_EQ(result.collapses, 4u);
  EXPECT_TRUE(result.degenerate.empty());
  EXPECT_EQ(result.surface.mesh.triangles.size(), testing::sphere(2).triangles.size());
}

TEST(Repair, CollapsesFacesOfThreeEqualCorners) {
  Mesh mesh = testing::sphere(2);
  duplicate_vertex(mesh, 0);
  duplicate_vertex(mesh, 0);
  const Repair result = repair(mesh);
  expect_same_solid(mesh, result);
  EXPECT_EQ(result.collapses, 2u);
  EXPECT_TRUE(result.degenerate.empty());
}

// A tetrahedron with an edge of length zero: its collapse would leave two faces on the same three vertices.
TEST(Repair, KeepsATetrahedron) {
  Mesh mesh = testing::tetrahedron();
  mesh.positions[3] = mesh.positions[0];
  ASSERT_EQ(find_degenerate(mesh).size(), 2u);
  const Repair result = repair(mesh);
  EXPECT_EQ(result.surface.mesh.triangles, mesh.triangles);
  EXPECT_EQ(result.degenerate.size(), 2u);
  EXPECT_EQ(result.collapses, 0u);
}

// A flat tetrahedron: the flip of the cap's long edge would double the edge between the other two vertices.
TEST(Repair, KeepsAFlatTetrahedron) {
  Mesh mesh = testing::tetrahedron();
  mesh.positions[3] = {0.5, 0, 0};
  ASSERT_EQ(find_degenerate(mesh).size(), 1u);
  const Repair result = repair(mesh);
  expect_same_solid(mesh, result);
  EXPECT_EQ(result.surface.mesh.triangles, mesh.triangles);
  EXPECT_EQ(result.degenerate.size(), 1u);
}

// A triangular tube with a waist of circumference zero, three vertices at one point: edges of the waist are no
// triangle of the surface, so collapsing one closes off the tube.
TEST(Repair, KeepsAPinchedTube) {
  Mesh mesh;
  for (int ring = 0; ring < 3; ++ring)
    for (int i = 0; i < 3; ++i) {
      const double r = ring == 1 ? 0 : 1;
      mesh.positions.push_back({r * (i == 1), r * (i == 2), 1.0 * ring});
    }
  for (std::uint32_t ring = 0; ring < 2; ++ring)
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t j = (i + 1) % 3, a = 3 * ring + i, b = 3 * ring + j, c = 3 * ring + 3 + j,
                          d = 3 * ring + 3 + i;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  mesh.triangles.push_back({2, 1, 0});
  mesh.triangles.push_back({6, 7, 8});
  const auto before = find_degenerate(mesh);
  ASSERT_EQ(before.size(), 6u);
  const Repair result = repair(mesh);
  expect_same_solid(mesh, result);
  EXPECT_EQ(result.collapses, 0u);
  EXPECT_EQ(result.degenerate, before);
}

// Vertices snapped to a coarse grid: needles, caps and collapsed regions in every arrangement, part of which cannot be
// removed without a change of topology.
TEST(Repair, SnappedMeshes) {
  for (int cells = 2; cells < 9; ++cells)
    for (unsigned seed = 0; seed < 3; ++seed) {
      Mesh mesh = testing::shuffled(seed == 0 ? testing::torus(96, 48) : testing::sphere(4), seed);
      for (auto& p : mesh.positions)
        for (double& x : p) x = std::round(x * cells) / 8;  // exact in binary
      const auto before = find_degenerate(mesh).size();
      ASSERT_GT(before, 0u);
      const Repair result = repair(mesh);
      expect_same_solid(mesh, result);
      EXPECT_LT(result.degenerate.size(), before) << cells << ' ' << seed;
    }
}

// All vertices of a polar cap at one position, so that a single vertex of very high valence remains.
TEST(Repair, AHubOfHighValence) {
  const std::uint32_t n = 100000;
  Mesh mesh;
  const double turn = 2 * std::acos(-1.0) / n;
  for (std::uint32_t i = 0; i < n; ++i) mesh.positions.push_back({std::cos(turn * i), std::sin(turn * i), 0});
  for (std::uint32_t i = 0; i < n; ++i) mesh.positions.push_back({0, 0, 1});
  mesh.positions.push_back({0, 0, 2});
  mesh.positions.push_back({0, 0, -1});
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    mesh.triangles.push_back({i, j, n + j});
    mesh.triangles.push_back({i, n + j, n + i});
    mesh.triangles.push_back({n + i, n + j, 2 * n});
    mesh.triangles.push_back({j, i, 2 * n + 1});
  }
  const Repair result = repair(mesh);
  expect_same_solid(mesh, result);
  EXPECT_EQ(result.collapses, n - 3);  // three more would close the ring: the stalk below the tip stays a tube
}

TEST(Repair, ManyDegenerateFacesOnALargeMesh) {
  Mesh mesh = testing::sphere(6);
  const auto faces = mesh.triangles.size();
  for (std::size_t f = 0; f < faces; f += 5) cut_edge_from_one_side(mesh, f, 0.5);
  const auto degenerate = find_degenerate(mesh);
  const Repair result = repair(mesh);
  EXPECT_GT(degenerate.size(), 100u);
  expect_same_solid(mesh, result);
  EXPECT_TRUE(result.degenerate.empty());
}

}  // namespace
}  // namespace prcage
