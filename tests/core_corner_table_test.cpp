// The corner table against sets of triangles: whatever legal collapses and flips are done to it, in whatever order, it
// is the closed manifold that the same operations on plain triples give.
#include "core/corner_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "test_meshes.h"

namespace prcage {
namespace {

using testing::topology;
using testing::Topology;

// A triangle turned so that its smallest vertex comes first: equal for equal oriented faces.
Triangle canonical(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

using Faces = std::set<Triangle>;

Faces faces_of(const CornerTable& mesh) {
  Faces faces;
  for (std::uint32_t f = 0; f < mesh.face_slots(); ++f)
    if (mesh.face_alive(f))
      faces.insert(
          canonical({mesh.corner_vertex[3 * f], mesh.corner_vertex[3 * f + 1], mesh.corner_vertex[3 * f + 2]}));
  return faces;
}

Faces collapsed(const Faces& faces, std::uint32_t a, std::uint32_t b) {
  Faces result;
  for (Triangle t : faces) {
    std::replace(t.begin(), t.end(), b, a);
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) result.insert(canonical(t));
  }
  return result;
}

Mesh as_mesh(const Faces& faces, std::size_t vertices) {
  return {std::vector<Position>(vertices), std::vector<Triangle>(faces.begin(), faces.end())};
}

// Every pointer of the table is what its comment says.
void expect_consistent(const CornerTable& mesh) {
  for (std::uint32_t h = 0; h < mesh.corner_vertex.size(); ++h) {
    if (mesh.corner_vertex[h] == none) {
      ASSERT_EQ(mesh.twin[h], none);
      continue;
    }
    ASSERT_LT(mesh.twin[h], mesh.corner_vertex.size());
    ASSERT_NE(mesh.corner_vertex[mesh.twin[h]], none);
    ASSERT_EQ(mesh.twin[mesh.twin[h]], h);
    ASSERT_EQ(mesh.origin(h), mesh.target(mesh.twin[h]));
    ASSERT_NE(mesh.vertex_halfedge[mesh.origin(h)], none);
  }
  for (std::uint32_t v = 0; v < mesh.vertex_slots(); ++v)
    ASSERT_TRUE(mesh.vertex_halfedge[v] == none || mesh.origin(mesh.vertex_halfedge[v]) == v);
}

// ------------------------------------------------------------------------------------------ link condition

using Edge = std::pair<std::uint32_t, std::uint32_t>;

struct Link {
  std::set<std::uint32_t> vertices;
  std::set<Edge> edges;
};

Link link_of_vertex(const Faces& faces, std::uint32_t v) {
  Link link;
  for (const Triangle& t : faces) {
    const auto at = std::find(t.begin(), t.end(), v);
    if (at == t.end()) continue;
    const auto i = static_cast<std::size_t>(at - t.begin());
    const std::uint32_t p = t[(i + 1) % 3], q = t[(i + 2) % 3];
    link.vertices.insert({p, q});
    link.edges.insert(std::minmax(p, q));
  }
  return link;
}

// Lk(a) and Lk(b) have exactly Lk(ab) in common, which on a closed surface is two vertices and no edge.
bool brute_link_condition(const Faces& faces, std::uint32_t a, std::uint32_t b) {
  const Link la = link_of_vertex(faces, a), lb = link_of_vertex(faces, b);
  std::set<std::uint32_t> opposite;
  for (const Triangle& t : faces)
    if (std::count(t.begin(), t.end(), a) != 0 && std::count(t.begin(), t.end(), b) != 0)
      for (const std::uint32_t v : t)
        if (v != a && v != b) opposite.insert(v);
  std::set<std::uint32_t> common;
  std::set_intersection(la.vertices.begin(), la.vertices.end(), lb.vertices.begin(), lb.vertices.end(),
                        std::inserter(common, common.end()));
  std::vector<Edge> common_edges;
  std::set_intersection(la.edges.begin(), la.edges.end(), lb.edges.begin(), lb.edges.end(),
                        std::back_inserter(common_edges));
  return common == opposite && opposite.size() == 2 && common_edges.empty();
}

void expect_link_conditions_agree(const CornerTable& mesh) {
  const Faces faces = faces_of(mesh);
  for (std::uint32_t h = 0; h < mesh.corner_vertex.size(); ++h) {
    if (mesh.corner_vertex[h] == none) continue;
    ASSERT_EQ(link_condition(mesh, h), brute_link_condition(faces, mesh.origin(h), mesh.target(h)));
  }
}

// Two tetrahedra glued at a face: the edges of that face separate.
Mesh bipyramid() {
  return {{{1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}, {0, 0, 1}, {0, 0, -1}},
          {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}}};
}

// Moebius' torus of seven vertices, each pair of them joined: nothing can be collapsed.
Mesh seven_vertex_torus() {
  Mesh mesh;
  mesh.positions.resize(7);
  for (std::uint32_t i = 0; i < 7; ++i) {
    mesh.triangles.push_back({i, (i + 1) % 7, (i + 3) % 7});
    mesh.triangles.push_back({i, (i + 3) % 7, (i + 2) % 7});
  }
  return mesh;
}

TEST(CornerTable, LinkConditionOfTheSmallestComplexes) {
  struct Case {
    Mesh mesh;
    std::size_t collapsible;  // edges
  };
  const Case cases[] = {
      {testing::tetrahedron(), 0}, {bipyramid(), 6}, {testing::sphere(0), 12}, {seven_vertex_torus(), 0}};
  for (const Case& c : cases) {
    ASSERT_TRUE(topology(c.mesh).closed_manifold);
    const CornerTable table = CornerTable::from_mesh(c.mesh);
    expect_link_conditions_agree(table);
    std::size_t collapsible = 0;
    for (std::uint32_t h = 0; h < table.corner_vertex.size(); ++h)
      collapsible += h < table.twin[h] && link_condition(table, h) ? 1 : 0;
    EXPECT_EQ(collapsible, c.collapsible);
  }
}

// ------------------------------------------------------------------------------------------ random operations

struct RunOfOperations {
  CornerTable mesh;
  Faces model;  // the same operations on plain triples
  std::mt19937_64 random;
  std::size_t collapses = 0;
  std::size_t flips = 0;

  RunOfOperations(const Mesh& start, std::uint64_t seed) : mesh(CornerTable::from_mesh(start)), random(seed) {
    model = faces_of(mesh);
  }

  std::uint32_t random_halfedge() {
    std::uint32_t h = 0;
    do h = static_cast<std::uint32_t>(random() % mesh.corner_vertex.size());
    while (mesh.corner_vertex[h] == none);
    return h;
  }

  void try_collapse(std::uint32_t h) {
    const std::uint32_t a = mesh.origin(h), b = mesh.target(h);
    if (!link_condition(mesh, h)) return;
    const Position p{static_cast<double>(random() % 100), 1, 2};
    collapse_edge(mesh, h, p);
    model = collapsed(model, a, b);
    EXPECT_EQ(mesh.position[a], p);
    EXPECT_EQ(mesh.vertex_halfedge[b], none);
    ++collapses;
  }

  void try_flip(std::uint32_t h) {
    const std::uint32_t a = mesh.origin(h), b = mesh.target(h), c = mesh.apex(h), d = mesh.apex(mesh.twin[h]);
    if (mesh.valence(a) <= 3 || mesh.valence(b) <= 3 || link_of_vertex(model, c).vertices.contains(d)) return;
    flip_edge(mesh, h);
    model.erase(canonical({a, b, c}));
    model.erase(canonical({b, a, d}));
    model.insert(canonical({d, c, a}));
    model.insert(canonical({c, d, b}));
    EXPECT_EQ((std::set{mesh.origin(h), mesh.target(h)}), (std::set{c, d}));
    ++flips;
  }
};

void expect_operations_keep(const Mesh& start, std::uint64_t seed, int steps) {
  const Topology before = topology(start);
  ASSERT_TRUE(before.closed_manifold);
  RunOfOperations run(start, seed);
  for (int step = 0; step < steps; ++step) {
    const std::uint32_t h = run.random_halfedge();
    if (run.random() % 2 == 0)
      run.try_collapse(h);
    else
      run.try_flip(h);
    if (step % 16 == 15) {
      ASSERT_EQ(faces_of(run.mesh), run.model);
      ASSERT_EQ(topology(as_mesh(run.model, start.positions.size())), before);
      ASSERT_NO_FATAL_FAILURE(expect_consistent(run.mesh));
      ASSERT_NO_FATAL_FAILURE(expect_link_conditions_agree(run.mesh));
    }
    if (step % 50 == 49) {
      const Mesh plain = run.mesh.to_mesh();
      renumber(run.mesh, live_elements(run.mesh));
      run.model = faces_of(run.mesh);
      ASSERT_TRUE(testing::same(run.mesh.to_mesh(), plain));
      ASSERT_EQ(run.mesh.face_slots(), plain.triangles.size());
      ASSERT_EQ(run.mesh.vertex_slots(), plain.positions.size());
      ASSERT_NO_FATAL_FAILURE(expect_consistent(run.mesh));
    }
  }
  EXPECT_GT(run.flips, 0u);
}

TEST(CornerTableSlow, CollapsesAndFlipsKeepAClosedManifoldOfTheSameTopology) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    expect_operations_keep(testing::sphere(2), seed, 300);
    expect_operations_keep(testing::torus(8, 6), seed, 300);
    expect_operations_keep(testing::merge(testing::sphere(1), testing::torus(5, 5)), seed, 300);
  }
  expect_operations_keep(testing::shape("gyroid", 400), 1, 400);
  expect_operations_keep(testing::shape("bracket", 100), 1, 300);
}

TEST(CornerTable, CollapsesEndWhereNothingIsLegal) {
  for (const Mesh& start : {testing::sphere(2), testing::torus(8, 6)}) {
    RunOfOperations run(start, 7);
    bool progress = true;
    while (progress) {
      const std::size_t before = run.collapses;
      for (std::uint32_t h = 0; h < run.mesh.corner_vertex.size(); ++h)
        if (run.mesh.corner_vertex[h] != none) run.try_collapse(h);
      progress = run.collapses > before;
    }
    const Topology end = topology(as_mesh(run.model, start.positions.size()));
    EXPECT_EQ(end, topology(start));
    EXPECT_EQ(run.model.size(), start.triangles.size() - 2 * run.collapses);
    EXPECT_LE(run.model.size(), end.euler == 2 ? 4u : 40u);  // the tetrahedron; a small torus
  }
}

// Valences beyond what the fast path of the link condition holds, of one endpoint and of both.
TEST(CornerTable, LinkConditionOfHubs) {
  for (const std::uint32_t ring : {31u, 32u, 33u, 40u, 200u})
    expect_link_conditions_agree(CornerTable::from_mesh(testing::saddle_cone(ring, 0.1)));
  RunOfOperations run(testing::sphere(3), 5);
  const std::array<std::uint32_t, 2> hubs{0, 1};
  for (int i = 0; i < 4000 && std::min(run.mesh.valence(0), run.mesh.valence(1)) < 40; ++i) {
    const std::uint32_t v = hubs[static_cast<std::size_t>(i % 2)];
    std::uint32_t h = run.mesh.vertex_halfedge[v];
    for (auto turns = run.random() % 50; turns > 0; --turns) h = run.mesh.next_around(h);
    const std::uint32_t target = run.mesh.target(h);
    if (target != 0 && target != 1 && run.mesh.valence(target) < 7) run.try_collapse(h);
  }
  ASSERT_GE(std::min(run.mesh.valence(0), run.mesh.valence(1)), 40u);
  expect_consistent(run.mesh);
  expect_link_conditions_agree(run.mesh);
}

TEST(CornerTable, RenumberingKeepsTheOrderItIsGiven) {
  RunOfOperations run(testing::sphere(2), 3);
  for (int i = 0; i < 60; ++i) run.try_collapse(run.random_halfedge());
  const CornerTable old = run.mesh;
  const Numbering kept = live_elements(run.mesh);
  renumber(run.mesh, kept);
  ASSERT_EQ(kept.faces.size(), run.mesh.face_slots());
  ASSERT_EQ(kept.vertices.size(), run.mesh.vertex_slots());
  EXPECT_TRUE(std::is_sorted(kept.faces.begin(), kept.faces.end()));
  EXPECT_TRUE(std::is_sorted(kept.vertices.begin(), kept.vertices.end()));
  for (std::size_t v = 0; v < kept.vertices.size(); ++v)
    EXPECT_EQ(run.mesh.position[v], old.position[kept.vertices[v]]);
  for (std::size_t f = 0; f < kept.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(kept.vertices[run.mesh.corner_vertex[3 * f + k]],
                old.corner_vertex[3 * std::size_t{kept.faces[f]} + k]);
}

TEST(CornerTable, ValenceCountsEdgesUpToTheLimit) {
  const CornerTable cone = CornerTable::from_mesh(testing::saddle_cone(10, 0.1));
  EXPECT_EQ(cone.valence(0), 10u);
  EXPECT_EQ(cone.valence(0, 4), 4u);
  EXPECT_EQ(cone.valence(0, 10), 10u);
  EXPECT_EQ(cone.valence(2), 4u);
}

}  // namespace
}  // namespace prcage
