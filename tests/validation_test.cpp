// Every kind of defect provoked on purpose, alone and together; nested solids, cavities and overlaps; and the real
// meshes beside the checkout, if they are there.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>

#include "core/mesh_view.h"
#include "core/prcage.h"
#include "io/mesh_file.h"
#include "parallel/arena.h"
#include "parallel/validate.h"
#include "solids.h"

namespace prcage {
namespace {

using testing::cube;
using testing::inside_out;
using testing::merge;
using testing::sphere;
using Kinds = std::map<DefectKind, std::size_t>;

Kinds kinds(const Validation& validation) {
  Kinds found;
  for (const Defect& d : validation.defects) {
    EXPECT_EQ(found.count(d.kind), 0u) << to_string(d.kind) << " reported twice";
    EXPECT_GT(d.count, 0u);
    EXPECT_LE(d.examples.size(), std::min<std::size_t>(d.count, 5));
    found[d.kind] = d.count;
  }
  return found;
}

Kinds kinds(const Mesh& mesh) { return kinds(validate(mesh, 2)); }

const Defect& defect(const Validation& validation, DefectKind kind) {
  const auto it = std::find_if(validation.defects.begin(), validation.defects.end(),
                               [kind](const Defect& d) { return d.kind == kind; });
  if (it == validation.defects.end()) throw std::runtime_error("no such defect");
  return *it;
}

TEST(Validate, ProperSolids) {
  const Validation box = validate(cube(2));
  EXPECT_TRUE(box.valid());
  EXPECT_EQ(box.vertices, 8u);
  EXPECT_EQ(box.faces, 12u);
  EXPECT_EQ(box.components, 1u);
  EXPECT_EQ(box.euler_characteristic, 2);
  EXPECT_DOUBLE_EQ(box.diagonal, std::sqrt(12.0));
  EXPECT_DOUBLE_EQ(box.area, 24);
  EXPECT_DOUBLE_EQ(box.volume, 8);
  EXPECT_EQ(box.cavities + box.degenerate_faces + box.duplicate_vertices + box.unreferenced_vertices, 0u);

  EXPECT_TRUE(validate(sphere(4)).valid());
  const Validation ring = validate(testing::torus());
  EXPECT_TRUE(ring.valid());
  EXPECT_EQ(ring.euler_characteristic, 0);
}

TEST(Validate, NothingAtAll) {
  EXPECT_EQ(kinds(Mesh{}), (Kinds{{DefectKind::no_faces, 1}}));
  EXPECT_EQ(kinds(Mesh{{{0, 0, 0}}, {}}), (Kinds{{DefectKind::no_faces, 1}}));
  EXPECT_EQ(kinds(validate(MeshView{})), (Kinds{{DefectKind::no_faces, 1}}));
}

TEST(Validate, IndexOutOfRange) {
  Mesh mesh = cube();
  mesh.triangles[3][1] = 8;
  mesh.triangles[7][0] = 0xffffffffu;
  const Validation v = validate(mesh);
  EXPECT_EQ(kinds(v), (Kinds{{DefectKind::index_out_of_range, 2}}));
  EXPECT_EQ(v.defects[0].examples[0].faces[0], 3u);
  EXPECT_EQ(v.defects[0].examples[0].vertices[0], 8u);
  EXPECT_EQ(v.defects[0].examples[1].faces[0], 7u);
}

// A face that names a vertex twice is reported as that, and the rest of the mesh is judged without it.
TEST(Validate, RepeatedVertex) {
  Mesh mesh = cube();
  mesh.triangles.insert(mesh.triangles.begin() + 2, {5, 6, 5});
  const Validation v = validate(mesh);
  EXPECT_EQ(kinds(v), (Kinds{{DefectKind::repeated_vertex, 1}}));
  EXPECT_EQ(v.defects[0].examples[0].faces[0], 2u);
  EXPECT_EQ(v.defects[0].examples[0].vertices[0], 5u);

  mesh.triangles.pop_back();
  EXPECT_EQ(kinds(mesh), (Kinds{{DefectKind::repeated_vertex, 1}, {DefectKind::boundary_edge, 3}}));
}

TEST(Validate, NotFinite) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    Mesh mesh = cube();
    mesh.positions[6][1] = bad;
    const Validation v = validate(mesh);
    EXPECT_EQ(kinds(v), (Kinds{{DefectKind::not_finite, 1}}));
    EXPECT_EQ(v.defects[0].examples[0].vertices[0], 6u);
    // What does not need coordinates is still reported.
    mesh.triangles.pop_back();
    EXPECT_EQ(kinds(mesh), (Kinds{{DefectKind::not_finite, 1}, {DefectKind::boundary_edge, 3}}));
  }
}

TEST(Validate, UnreferencedVerticesDoNotMatter) {
  Mesh mesh = cube();
  mesh.positions.push_back({std::nan(""), 0, 0});
  mesh.positions.insert(mesh.positions.begin(), {1e300, 0, 0});
  for (auto& t : mesh.triangles)
    for (auto& i : t) ++i;
  const Validation v = validate(mesh);
  EXPECT_TRUE(v.valid());
  EXPECT_EQ(v.unreferenced_vertices, 2u);
  EXPECT_EQ(v.euler_characteristic, 2);
  EXPECT_DOUBLE_EQ(v.diagonal, std::sqrt(3.0));

  mesh.triangles.pop_back();  // examples are in the numbers of the mesh as given
  const Validation open = validate(mesh);
  EXPECT_EQ(open.defects.at(0).examples.at(0).vertices, (std::array<std::uint32_t, 2>{6, 8}));
}

TEST(Validate, TooLargeAndTooSmall) {
  EXPECT_TRUE(validate(testing::scaled(cube(1), 1e15)).valid());
  EXPECT_EQ(kinds(testing::scaled(cube(1), 2.1e15)), (Kinds{{DefectKind::too_large, 8}}));
  EXPECT_EQ(kinds(testing::scaled(cube(1), 1e300)), (Kinds{{DefectKind::too_large, 8}}));
  EXPECT_TRUE(validate(testing::scaled(sphere(3), 1e-60)).valid());
  EXPECT_EQ(kinds(testing::scaled(cube(1), 1e-61)), (Kinds{{DefectKind::too_large, 1}}));
  EXPECT_EQ(kinds(testing::scaled(cube(1), 0)), (Kinds{{DefectKind::too_large, 1}}));
}

TEST(Validate, BoundaryEdges) {
  Mesh mesh = sphere(2);
  mesh.triangles.erase(mesh.triangles.begin() + 40);
  const Validation v = validate(mesh);
  EXPECT_EQ(kinds(v), (Kinds{{DefectKind::boundary_edge, 3}}));
  ASSERT_EQ(v.defects[0].examples.size(), 3u);
  const auto& example = v.defects[0].examples[0];
  const auto& face = mesh.triangles[example.faces[0]];
  for (const std::uint32_t i : example.vertices) EXPECT_EQ(std::count(face.begin(), face.end(), i), 1);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_DOUBLE_EQ(example.position[k],
                     0.5 * (mesh.positions[example.vertices[0]][k] + mesh.positions[example.vertices[1]][k]));
}

TEST(Validate, AtMostFiveExamples) {
  Mesh mesh = sphere(2);
  for (std::size_t f = 0; f < 10; ++f) mesh.triangles.erase(mesh.triangles.begin() + static_cast<long>(7 * f));
  const Validation v = validate(mesh);
  EXPECT_GT(defect(v, DefectKind::boundary_edge).count, 5u);
  EXPECT_EQ(defect(v, DefectKind::boundary_edge).examples.size(), 5u);
}

// Two cubes that share an edge: four faces on it.
TEST(Validate, NonManifoldEdge) {
  Mesh mesh = cube(2);
  Mesh other = cube(2, {2, 2, 0});
  std::array<std::uint32_t, 2> shared{};
  std::size_t found = 0;
  mesh = merge(mesh, other);
  for (std::uint32_t v = 8; v < 16; ++v)
    for (std::uint32_t u = 0; u < 8; ++u)
      if (mesh.positions[v] == mesh.positions[u]) {
        shared[found++] = u;
        for (auto& t : mesh.triangles) std::replace(t.begin(), t.end(), v, u);
      }
  ASSERT_EQ(found, 2u);
  const Validation v = validate(mesh);
  const Kinds k = kinds(v);
  EXPECT_EQ(k, (Kinds{{DefectKind::non_manifold_edge, 1}}));
  const auto example = v.defects[0].examples.at(0).vertices;
  EXPECT_EQ((std::set<std::uint32_t>(example.begin(), example.end())),
            (std::set<std::uint32_t>(shared.begin(), shared.end())));
}

TEST(Validate, InconsistentEdges) {
  Mesh mesh = sphere(1);
  std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
  const Validation v = validate(mesh);
  EXPECT_EQ(kinds(v), (Kinds{{DefectKind::inconsistent_edge, 3}}));
}

// Two tetrahedra that share one vertex.
TEST(Validate, NonManifoldVertex) {
  Mesh mesh = merge(testing::tetrahedron(), inside_out(testing::scaled(testing::tetrahedron(), -1)));
  for (auto& t : mesh.triangles) std::replace(t.begin(), t.end(), 4u, 0u);
  const Validation v = validate(mesh);
  EXPECT_EQ(kinds(v), (Kinds{{DefectKind::non_manifold_vertex, 1}}));
  EXPECT_EQ(v.defects[0].examples.at(0).vertices[0], 0u);
}

TEST(Validate, DuplicateFaces) {
  Mesh mesh = cube();
  mesh.triangles.push_back({mesh.triangles[4][1], mesh.triangles[4][2], mesh.triangles[4][0]});
  Validation v = validate(mesh);
  EXPECT_EQ(kinds(v), (Kinds{{DefectKind::non_manifold_edge, 3}, {DefectKind::duplicate_face, 1}}));
  EXPECT_EQ(defect(v, DefectKind::duplicate_face).examples.at(0).faces, (std::array<std::uint32_t, 2>{4, 12}));

  mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};  // a pillow without content
  v = validate(mesh);
  EXPECT_EQ(kinds(v), (Kinds{{DefectKind::duplicate_face, 1}}));
}

TEST(Validate, SelfIntersection) {
  const Validation v = validate(merge(cube(2), cube(2, {1, 0.9, 0.8})));
  const Kinds k = kinds(v);
  ASSERT_EQ(k.size(), 1u);
  ASSERT_EQ(k.count(DefectKind::self_intersection), 1u);
  const auto& examples = v.defects[0].examples;
  EXPECT_EQ(examples.size(), 5u);
  for (const DefectExample& e : examples) {
    EXPECT_LT(e.faces[0], 12u);
    EXPECT_GE(e.faces[1], 12u);
    EXPECT_LT(e.faces[1], 24u);
  }
}

// Solids that merely touch, in a face, an edge or a point: not free of self-intersections.
TEST(Validate, TouchingSolidsIntersect) {
  for (const std::array<double, 3> at : {std::array<double, 3>{2, 0, 0}, {2, 2, 0}, {2, 2, 2}}) {
    const Validation touching = validate(merge(cube(2), cube(2, at)));
    EXPECT_EQ(kinds(touching).count(DefectKind::self_intersection), 1u);
    EXPECT_GT(touching.duplicate_vertices, 0u);
  }
  EXPECT_TRUE(validate(merge(cube(2), cube(2, {2 + 1e-15, 0, 0}))).valid());  // a gap of a few ulp
}

TEST(Validate, DuplicateVerticesAreCounted) {
  Mesh mesh = sphere(2);
  EXPECT_EQ(validate(mesh).duplicate_vertices, 0u);
  mesh = merge(mesh, sphere(2));
  EXPECT_EQ(validate(mesh).duplicate_vertices, sphere(2).positions.size());
  mesh = merge(mesh, Mesh{{{-0.0, 3, 0}, {0, 3, 0}, {1, 3, 0}}, {{0, 1, 2}}});
  EXPECT_EQ(validate(mesh).duplicate_vertices, sphere(2).positions.size() + 1);
}

TEST(Validate, IndependentDefectsAreReportedTogether) {
  Mesh mesh = merge(sphere(2), sphere(2, 1, {1, 0, 0}));
  mesh.triangles.pop_back();
  const Kinds k = kinds(mesh);
  EXPECT_EQ(k.size(), 2u);
  EXPECT_EQ(k.at(DefectKind::boundary_edge), 3u);
  EXPECT_GT(k.at(DefectKind::self_intersection), 10u);

  const Kinds inverted = kinds(inside_out(merge(sphere(2), sphere(2, 1, {1, 0, 0}))));
  EXPECT_EQ(inverted.size(), 2u);
  EXPECT_EQ(inverted.count(DefectKind::inside_out), 1u);
  EXPECT_EQ(inverted.count(DefectKind::self_intersection), 1u);
}

// ---------------------------------------------------------------------------- degenerate faces

// Faces (a, m, c), (m, b, c) and the zero-area (a, b, m) for (a, b, c), m in the middle of ab.
void add_cap(Mesh& mesh, std::size_t face) {
  const auto [a, b, c] = mesh.triangles[face];
  const auto m = static_cast<std::uint32_t>(mesh.positions.size());
  Position p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = 0.5 * (mesh.positions[a][k] + mesh.positions[b][k]);
  mesh.positions.push_back(p);
  mesh.triangles[face] = {a, m, c};
  mesh.triangles.push_back({m, b, c});
  mesh.triangles.push_back({a, b, m});
}

std::vector<Position> sorted(std::vector<Position> positions) {
  std::sort(positions.begin(), positions.end());
  return positions;
}

TEST(Validate, DegenerateFacesAreRepaired) {
  Mesh mesh = cube(2);
  add_cap(mesh, 4);
  add_cap(mesh, 9);
  const Validation v = validate(mesh);
  EXPECT_TRUE(v.valid());
  EXPECT_EQ(v.degenerate_faces, 2u);
  EXPECT_DOUBLE_EQ(v.volume, 8);

  Arena(1).run([&] {
    const TreeDevice device;
    const CheckedMesh checked = validate_mesh(mesh, device);
    const Mesh& repaired = checked.valid.surface.mesh;
    EXPECT_EQ(sorted(repaired.positions), sorted(mesh.positions));
    EXPECT_EQ(repaired.triangles.size(), mesh.triangles.size());
    EXPECT_TRUE(degenerate_faces(repaired.positions, repaired.triangles).empty());
    EXPECT_EQ(checked.valid.components.of_face.size(), repaired.triangles.size());
  });
}

TEST(Validate, DegenerateFaceThatStays) {
  Mesh mesh = merge(cube(2), testing::tetrahedron());
  for (std::size_t v = 8; v < 12; ++v) mesh.positions[v][0] += 5;
  mesh.positions[11] = mesh.positions[8];  // a tetrahedron with an edge of length zero: no collapse is possible
  const Validation v = validate(mesh);
  EXPECT_EQ(v.degenerate_faces, 2u);
  const Kinds k = kinds(v);
  EXPECT_EQ(k.at(DefectKind::degenerate_face), 2u);
  for (const DefectExample& e : defect(v, DefectKind::degenerate_face).examples) EXPECT_GE(e.faces[0], 12u);
}

// ------------------------------------------------------------------------ orientation and nesting

TEST(Validate, InsideOut) {
  EXPECT_EQ(kinds(inside_out(cube())), (Kinds{{DefectKind::inside_out, 1}}));
  const Mesh hollow = merge(cube(4), inside_out(cube(2)));
  EXPECT_EQ(kinds(inside_out(hollow)), (Kinds{{DefectKind::inside_out, 1}}));
  EXPECT_EQ(kinds(inside_out(merge(cube(1), cube(1, {3, 0, 0})))), (Kinds{{DefectKind::inside_out, 1}}));
}

TEST(Validate, InsideOutCanBeAccepted) {
  const Mesh hollow = merge(cube(4), inside_out(cube(2)));
  Arena(2).run([&] {
    const TreeDevice device;
    const CheckedMesh turned = validate_mesh(inside_out(hollow), device, true);
    EXPECT_TRUE(turned.validation.valid());
    EXPECT_TRUE(turned.valid.turned);
    EXPECT_EQ(turned.validation.cavities, 1u);
    EXPECT_DOUBLE_EQ(turned.validation.volume, 56);
    EXPECT_TRUE(validate(turned.valid.surface.mesh).valid());
    EXPECT_FALSE(validate_mesh(hollow, device, true).valid.turned);
    // What is wrong either way round stays wrong.
    EXPECT_FALSE(validate_mesh(merge(cube(1), inside_out(cube(1, {3, 0, 0}))), device, true).validation.valid());
  });
}

TEST(Validate, NestingThatIsLegal) {
  const Validation hollow = validate(merge(cube(10), inside_out(cube(8))));
  EXPECT_TRUE(hollow.valid());
  EXPECT_EQ(hollow.components, 2u);
  EXPECT_EQ(hollow.cavities, 1u);
  EXPECT_NEAR(hollow.volume, 1000 - 512, 1e-9);

  const Validation island = validate(merge(merge(cube(10), inside_out(cube(8))), cube(6)));
  EXPECT_TRUE(island.valid());
  EXPECT_EQ(island.cavities, 1u);

  Mesh cheese = cube(20);
  for (int i = -1; i <= 1; ++i) cheese = merge(cheese, inside_out(sphere(2, 2, {6.0 * i, 0, 0})));
  EXPECT_EQ(validate(cheese).cavities, 3u);
  EXPECT_TRUE(validate(cheese).valid());
}

TEST(Validate, NestingThatIsNot) {
  const auto count = [](const Mesh& mesh) {
    const Kinds k = kinds(mesh);
    EXPECT_EQ(k.size(), 1u);
    return k.count(DefectKind::nested_orientation) != 0 ? k.at(DefectKind::nested_orientation) : 0;
  };
  EXPECT_EQ(count(merge(cube(10), cube(8))), 1u);                                          // solid in a solid
  EXPECT_EQ(count(merge(cube(1), inside_out(cube(1, {3, 0, 0})))), 1u);                    // a hollow in nothing
  EXPECT_EQ(count(merge(inside_out(cube(10)), inside_out(cube(8)))), 2u);                  // and inside a hollow
  EXPECT_EQ(count(merge(merge(cube(10), inside_out(cube(8))), inside_out(cube(6)))), 1u);  // a hollow in a hollow
  const Validation v = validate(merge(cube(10), cube(8)));
  EXPECT_GE(v.defects[0].examples.at(0).faces[0], 12u);
}

// Nesting is decided by one point of each component: boxes that enclose each other without the solids doing so.
TEST(Validate, InTheHoleOfATorusIsOutside) {
  EXPECT_TRUE(validate(merge(testing::torus(), sphere(2, 0.5))).valid());
  EXPECT_TRUE(validate(merge(testing::torus(), cube(0.2, {1, 0, 2}))).valid());
  EXPECT_EQ(kinds(merge(testing::torus(), cube(0.2, {1, 0, 0}))), (Kinds{{DefectKind::nested_orientation, 1}}));
}

// Thousands of components: a test per pair of component and face would take minutes.
TEST(Validate, ThousandsOfComponents) {
  Mesh mesh;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j)
      for (int k = 0; k < 10; ++k) {  // appended in place: merge() would copy
        const Mesh next = cube(1, {2.0 * i, 2.0 * j, 2.0 * k});
        const auto offset = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), next.positions.begin(), next.positions.end());
        for (const auto& t : next.triangles) mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
      }
  const Validation v = validate(mesh);
  EXPECT_TRUE(v.valid());
  EXPECT_EQ(v.components, 4000u);
}

// --------------------------------------------------------------------------------- the interface

TEST(Validate, ViewsOfOtherLayouts) {
  struct Vertex {
    float weight;
    float position[3];
  };
  const Mesh mesh = cube(2);
  std::vector<Vertex> vertices;
  for (const auto& p : mesh.positions)
    vertices.push_back({-1, {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])}});
  std::vector<std::array<std::uint32_t, 4>> faces;
  for (const auto& t : mesh.triangles) faces.push_back({t[0], t[1], t[2], 77});
  MeshView view;
  view.positions = vertices[0].position;
  view.vertex_count = vertices.size();
  view.position_stride = sizeof(Vertex);
  view.scalar = Scalar::float32;
  view.triangles = faces[0].data();
  view.triangle_count = faces.size();
  view.triangle_stride = sizeof faces[0];
  EXPECT_EQ(to_mesh(view).positions, mesh.positions);
  EXPECT_EQ(to_mesh(view).triangles, mesh.triangles);
  EXPECT_EQ(to_mesh(mesh).positions, mesh.positions);
  EXPECT_TRUE(validate(view).valid());
}

TEST(Validate, SameAnswerForAnyNumberOfThreads) {
  Mesh mesh = merge(sphere(4), sphere(4, 1, {0.3, 0.2, 0.1}));
  mesh.triangles.resize(mesh.triangles.size() - 3);
  const Validation one = validate(mesh, 1);
  for (const int threads : {2, 4}) {
    const Validation other = validate(mesh, threads);
    ASSERT_EQ(other.defects.size(), one.defects.size());
    for (std::size_t i = 0; i < one.defects.size(); ++i) {
      EXPECT_EQ(other.defects[i].kind, one.defects[i].kind);
      EXPECT_EQ(other.defects[i].count, one.defects[i].count);
      for (std::size_t k = 0; k < one.defects[i].examples.size(); ++k)
        EXPECT_EQ(other.defects[i].examples[k].faces, one.defects[i].examples[k].faces);
    }
  }
}

// The host's floating-point state and thread limits are neither relied on nor changed: the answer hangs on a gap of a
// denormal width while the host flushes denormals to zero.
TEST(Validate, HostThatFlushesDenormals) {
  Mesh mesh = merge(cube(1), cube(1));
  for (std::size_t v = 0; v < 16; ++v) {
    double& x = mesh.positions[v][0];
    x = v < 8 ? (x > 0 ? 0.0 : -1.0) : (x > 0 ? 1.0 : std::numeric_limits<double>::denorm_min());
  }
  mesh = merge(mesh, sphere(5, 1, {0, 0, 5}));  // enough for Embree to build on all threads
  const std::size_t limit = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
#if defined(__SSE2__)
  std::thread([&] {
    const unsigned flushing = _mm_getcsr() | 0x8040u;
    for (int run = 0; run < 3; ++run) {
      _mm_setcsr(flushing);
      const Validation v = validate(mesh, 2);
      const unsigned after = _mm_getcsr();
      _mm_setcsr(flushing & ~0x8040u);
      EXPECT_EQ(after & 0x8040u, flushing & 0x8040u);
      EXPECT_TRUE(v.valid());
    }
  }).join();
#endif
  EXPECT_TRUE(validate(mesh, 1).valid());
  EXPECT_EQ(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism), limit);
}

// --------------------------------------------------------------------------------- real meshes

namespace fs = std::filesystem;

fs::path meshes() { return fs::path(PRCAGE_SHARED_DIR) / "meshes"; }

Mesh read(const fs::path& path) {
  MeshFile file = read_mesh(path.string());
  EXPECT_TRUE(file.ok) << file.error;
  return std::move(file.mesh);
}

TEST(ValidateRealMeshes, AllAreValid) {
  if (!fs::exists(meshes())) GTEST_SKIP() << "no meshes in " << meshes();
  std::size_t count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(meshes())) {
    if (entry.path().extension() != ".ply" || entry.path().parent_path().filename() == "invalid") continue;
    EXPECT_EQ(kinds(read(entry.path())), Kinds{}) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 0u);
}

// The MANIFEST of the invalid meshes says in words what is wrong with each.
TEST(ValidateRealMeshes, InvalidOnesGetTheirDiagnosis) {
  const fs::path directory = meshes() / "invalid";
  if (!fs::exists(directory)) GTEST_SKIP() << "no meshes in " << directory;
  const auto found = [&](const char* name) { return kinds(read(directory / (std::string(name) + ".ply"))); };
  using K = DefectKind;

  EXPECT_EQ(found("open_bunny"), (Kinds{{K::boundary_edge, 223}}));
  EXPECT_EQ(found("many_holes_elephant"), (Kinds{{K::boundary_edge, 1353}, {K::self_intersection, 173}}));
  EXPECT_EQ(validate(read(directory / "many_holes_elephant.ply")).duplicate_vertices, 65u);
  EXPECT_EQ(found("nonmanifold_edge_motor_mount"), (Kinds{{K::non_manifold_edge, 1}, {K::duplicate_face, 1}}));
  EXPECT_EQ(found("nonmanifold_edges_raspberry_cover"), (Kinds{{K::non_manifold_edge, 3}, {K::duplicate_face, 2}}));
  EXPECT_EQ(found("nonmanifold_vertices_actuator"), (Kinds{{K::non_manifold_vertex, 5}, {K::self_intersection, 4186}}));
  EXPECT_EQ(found("self_intersecting_camel"), (Kinds{{K::self_intersection, 20}}));
  EXPECT_EQ(found("overlapping_components_rabbit"), (Kinds{{K::self_intersection, 196}}));
  EXPECT_EQ(found("overlapping_shells_idler"), (Kinds{{K::nested_orientation, 2}}));
  EXPECT_EQ(found("inconsistent_hourglass"), (Kinds{{K::inconsistent_edge, 72}}));
  EXPECT_EQ(found("inside_out_ellipsoid"), (Kinds{{K::inside_out, 1}}));
  EXPECT_EQ(found("quads_fandisk"), Kinds{});

  const Validation doors = validate(read(directory / "degenerate_faces_doors.ply"));
  EXPECT_EQ(doors.degenerate_faces, 2u);
  EXPECT_EQ(kinds(doors).count(K::self_intersection), 1u);

  Mesh capsule_mesh = read(directory / "unwelded_capsule.ply");
  const Validation capsule = validate(capsule_mesh);
  EXPECT_EQ(kinds(capsule).at(K::boundary_edge), 302u);
  EXPECT_EQ(capsule.degenerate_faces, 200u);
  EXPECT_EQ(capsule.duplicate_vertices, 250u);
}

}  // namespace
}  // namespace prcage
