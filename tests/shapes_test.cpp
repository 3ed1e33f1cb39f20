// The built-in shapes are legal inputs at every size and for every seed, and the same bits every time.
//
// Topology is counted here from the triangle list alone, so that a fault in the library's own validation cannot
// hide one in the shapes. Self-intersections and nesting are left to that validation, which is exact.
#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/prcage.h"

namespace prcage {
namespace {

using Index = std::uint32_t;
using DirectedEdge = std::pair<Index, Index>;

// For every directed edge the third corner of its face. Empty if two faces pass an edge in the same direction.
std::map<DirectedEdge, Index> opposite_corners(const Mesh& mesh) {
  std::map<DirectedEdge, Index> corners;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (!corners.emplace(DirectedEdge{t[i], t[(i + 1) % 3]}, t[(i + 2) % 3]).second) return {};
    }
  }
  return corners;
}

bool every_edge_has_two_faces(const std::map<DirectedEdge, Index>& corners) {
  return !corners.empty() && std::all_of(corners.begin(), corners.end(), [&](const auto& entry) {
    return corners.count({entry.first.second, entry.first.first}) == 1;
  });
}

// Do the faces of every vertex form one fan? Walks round each vertex once and counts the faces met.
bool every_vertex_has_one_fan(const Mesh& mesh, const std::map<DirectedEdge, Index>& corners) {
  std::vector<std::size_t> degree(mesh.positions.size(), 0);
  std::vector<Index> neighbour(mesh.positions.size(), 0);
  for (const auto& [edge, corner] : corners) {
    ++degree[edge.first];
    neighbour[edge.first] = edge.second;
  }
  for (Index v = 0; v < mesh.positions.size(); ++v) {
    if (degree[v] == 0) return false;
    std::size_t met = 0;
    Index at = neighbour[v];
    do {
      at = corners.at({v, at});
      ++met;
    } while (at != neighbour[v] && met <= degree[v]);
    if (met != degree[v]) return false;
  }
  return true;
}

long long euler_characteristic(const Mesh& mesh, const std::map<DirectedEdge, Index>& corners) {
  return static_cast<long long>(mesh.positions.size()) - static_cast<long long>(corners.size() / 2) +
         static_cast<long long>(mesh.triangles.size());
}

std::size_t component_count(const Mesh& mesh) {
  std::vector<Index> label(mesh.positions.size());
  std::iota(label.begin(), label.end(), 0u);
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& t : mesh.triangles) {
      const Index lowest = std::min({label[t[0]], label[t[1]], label[t[2]]});
      for (Index v : t) {
        changed |= label[v] != lowest;
        label[v] = lowest;
      }
    }
  }
  return std::set<Index>(label.begin(), label.end()).size();
}

double volume(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const auto &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum / 6;
}

Mesh shape(const std::string& name, std::size_t faces, std::uint64_t seed) {
  std::string error;
  Mesh mesh = make_shape(name, faces, seed, error);
  EXPECT_EQ(error, "");
  return mesh;
}

// FNV-1a over the bits of a mesh.
std::uint64_t fingerprint(const Mesh& mesh) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&](const void* data, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) hash = (hash ^ static_cast<const unsigned char*>(data)[i]) * 0x100000001b3u;
  };
  add(mesh.positions.data(), mesh.positions.size() * sizeof(mesh.positions[0]));
  add(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]));
  return hash;
}

class Shapes : public testing::TestWithParam<ShapeInfo> {};

TEST_P(Shapes, AreClosedManifoldAndOriented) {
  for (std::size_t faces : {0, 100, 350, 1200, 4000, 15000}) {
    for (std::uint64_t seed : {0, 1, 2, 77}) {
      SCOPED_TRACE(testing::Message() << "target " << faces << " seed " << seed);
      const Mesh mesh = shape(GetParam().name, faces, seed);
      const std::map<DirectedEdge, Index> corners = opposite_corners(mesh);
      ASSERT_TRUE(every_edge_has_two_faces(corners));
      EXPECT_TRUE(every_vertex_has_one_fan(mesh, corners));
      EXPECT_GT(volume(mesh), 0);
      EXPECT_EQ(component_count(mesh), GetParam().components);
      if (GetParam().euler_characteristic) {
        EXPECT_EQ(euler_characteristic(mesh, corners), *GetParam().euler_characteristic);
      }
    }
  }
}

TEST_P(Shapes, PassExactValidation) {
  for (std::size_t faces : {0, 250, 1000, 6000}) {
    for (std::uint64_t seed : {0, 1, 2}) {
      SCOPED_TRACE(testing::Message() << "target " << faces << " seed " << seed);
      const Validation validation = validate(shape(GetParam().name, faces, seed));
      EXPECT_TRUE(validation.valid()) << (validation.valid() ? "" : to_string(validation.defects.front().kind));
      EXPECT_EQ(validation.degenerate_faces, 0u);
      EXPECT_EQ(validation.unreferenced_vertices, 0u);
      EXPECT_EQ(validation.duplicate_vertices, 0u);
    }
  }
}

TEST_P(Shapes, MeetTheFaceTarget) {
  const bool is_gyroid = GetParam().name == std::string("gyroid");
  for (std::size_t faces : {1000, 1717, 5000, 13000, 20000, 20500, 48000, 100000, 150000, 450000}) {
    const double tolerance = faces >= 20000 ? 0.02 : is_gyroid ? 0.2 : 0.05;
    const double target = static_cast<double>(faces);
    EXPECT_NEAR(static_cast<double>(shape(GetParam().name, faces, 3).triangles.size()), target, tolerance * target);
  }
}

TEST_P(Shapes, RaiseTinyTargetsToTheSmallestSize) {
  const double smallest = static_cast<double>(GetParam().smallest);
  const double tolerance = GetParam().name == std::string("gyroid") ? 0.4 * smallest : 0;
  EXPECT_NEAR(static_cast<double>(shape(GetParam().name, 0, 0).triangles.size()), smallest, tolerance);
}

TEST_P(Shapes, DependOnNothingButTheirArguments) {
  EXPECT_EQ(fingerprint(shape(GetParam().name, 3000, 5)), fingerprint(shape(GetParam().name, 3000, 5)));
  const bool has_seed = GetParam().name != std::string("sphere");
  EXPECT_EQ(fingerprint(shape(GetParam().name, 3000, 5)) != fingerprint(shape(GetParam().name, 3000, 6)), has_seed);
}

INSTANTIATE_TEST_SUITE_P(All, Shapes, testing::ValuesIn(shape_table().begin(), shape_table().end()),
                         [](const auto& tested) { return std::string(tested.param.name); });

// Recorded once. They hold on every machine and compiler, whatever its mathematical library is.
TEST(ShapeBits, AreTheSameOnEveryMachine) {
  const std::map<std::string, std::uint64_t> recorded = {
      {"sphere", 0xf1943759c7ad9495u}, {"bumpy", 0xb7ce3fac14decc62u},  {"spikes", 0xd37514b814896f24u},
      {"knot", 0xfc113e66817963a5u},   {"gyroid", 0xdd4e3a826b3d7c21u}, {"bracket", 0xf057891f99d11ee0u},
      {"nested", 0xc05627d6b43a2988u}, {"slabs", 0x90943da5f13bc29du},
  };
  for (const ShapeInfo& info : shape_table()) {
    EXPECT_EQ(fingerprint(shape(info.name, 2000, 42)), recorded.at(info.name)) << info.name;
  }
}

TEST(ShapeErrors, UnknownNameListsTheShapes) {
  std::string error;
  EXPECT_TRUE(make_shape("teapot", 100, 0, error).triangles.empty());
  EXPECT_NE(error.find("teapot"), std::string::npos);
  for (const ShapeInfo& info : shape_table()) EXPECT_NE(error.find(info.name), std::string::npos);
}

TEST(ShapeErrors, TooManyFacesAreRefused) {
  std::string error;
  EXPECT_TRUE(make_shape("sphere", std::size_t{1} << 40, 0, error).triangles.empty());
  EXPECT_FALSE(error.empty());
}

TEST(ShapeGyroid, HasHighGenus) {
  const Mesh mesh = shape("gyroid", 200000, 0);
  EXPECT_LT(euler_characteristic(mesh, opposite_corners(mesh)), -100);
}

}  // namespace
}  // namespace prcage
