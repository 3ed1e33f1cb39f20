#include "tools/report_measures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <tbb/parallel_sort.h>
#include <boost/pending/disjoint_sets.hpp>

#include "core/angles.h"
#include "core/vec3.h"

namespace prcage {
namespace {

// Gathers minimum, mean and maximum of values one by one.
class ValueRangeOf {
 public:
  void add(double value) {
    min_ = std::min(min_, value);
    max_ = std::max(max_, value);
    sum_ += value;
    ++count_;
  }
  ValueRange range() const {
    return count_ == 0 ? ValueRange{} : ValueRange{min_, sum_ / static_cast<double>(count_), max_};
  }

 private:
  double min_ = std::numeric_limits<double>::infinity();
  double max_ = -std::numeric_limits<double>::infinity();
  double sum_ = 0;
  std::size_t count_ = 0;
};

bool usable(const Mesh& mesh, const Triangle& triangle) {
  return std::all_of(triangle.begin(), triangle.end(), [&mesh](std::uint32_t v) {
    return v < mesh.positions.size() && vec(mesh.positions[v]).allFinite();
  });
}

std::vector<Triangle> usable_triangles(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const Triangle& triangle : mesh.triangles) {
    if (usable(mesh, triangle)) triangles.push_back(triangle);
  }
  return triangles;
}

std::vector<bool> referenced(const Mesh& mesh, const std::vector<Triangle>& triangles) {
  std::vector<bool> used(mesh.positions.size(), false);
  for (const Triangle& triangle : triangles) {
    for (const std::uint32_t v : triangle) used[v] = true;
  }
  return used;
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // lower vertex first

// One entry for each side of a face, equal edges next to each other.
std::vector<Edge> sorted_sides(const std::vector<Triangle>& triangles) {
  std::vector<Edge> sides;
  sides.reserve(3 * triangles.size());
  for (const Triangle& triangle : triangles) {
    for (std::size_t i = 0; i < 3; ++i) sides.emplace_back(std::minmax(triangle[i], triangle[(i + 1) % 3]));
  }
  tbb::parallel_sort(sides);
  return sides;
}

// Calls visit(edge, number of faces) once for each edge.
template <typename Visit>
void for_each_edge(const std::vector<Edge>& sides, Visit visit) {
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last = std::find_if(first, sides.end(), [&first](const Edge& side) { return side != *first; });
    visit(*first, last - first);
    first = last;
  }
}

void measure_edges(const Mesh& mesh, const std::vector<Triangle>& triangles, MeshMeasures& measures) {
  ValueRangeOf length;
  for_each_edge(sorted_sides(triangles), [&](const Edge& edge, std::ptrdiff_t faces) {
    ++measures.edges;
    if (faces == 1) ++measures.boundary_edges;
    if (faces > 2) ++measures.non_manifold_edges;
    length.add((vec(mesh.positions[edge.second]) - vec(mesh.positions[edge.first])).norm());
  });
  measures.edge_length = length.range();
}

std::size_t count_components(std::size_t vertex_count, const std::vector<bool>& used,
                             const std::vector<Triangle>& triangles) {
  boost::disjoint_sets_with_storage<> sets(vertex_count);
  for (const Triangle& triangle : triangles) {
    sets.union_set(triangle[0], triangle[1]);
    sets.union_set(triangle[0], triangle[2]);
  }
  std::size_t roots = 0;
  for (std::size_t v = 0; v < vertex_count; ++v) {
    if (used[v] && sets.find_set(v) == v) ++roots;
  }
  return roots;
}

void measure_faces(const Mesh& mesh, const std::vector<Triangle>& triangles, MeshMeasures& measures) {
  ValueRangeOf smallest;
  const Vec3 origin = triangles.empty() ? Vec3::Zero() : vec(mesh.positions[triangles.front()[0]]);
  for (const Triangle& triangle : triangles) {
    const Vec3 p = vec(mesh.positions[triangle[0]]) - origin;
    const Vec3 q = vec(mesh.positions[triangle[1]]) - origin;
    const Vec3 r = vec(mesh.positions[triangle[2]]) - origin;
    measures.area += (q - p).cross(r - p).norm() / 2;
    measures.volume += p.dot(q.cross(r)) / 6;
    const auto angles = corner_angles(p, q, r);
    const auto [low, high] = std::minmax_element(angles.begin(), angles.end());
    smallest.add(*low);
    measures.largest_angle = std::max(measures.largest_angle, *high);
  }
  measures.smallest_angle = smallest.range();
}

void measure_box(const Mesh& mesh, const std::vector<bool>& used, MeshMeasures& measures) {
  Eigen::AlignedBox3d box;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    ++measures.referenced_vertices;
    box.extend(vec(mesh.positions[v]));
  }
  if (box.isEmpty()) return;
  measures.lower = position(box.min());
  measures.upper = position(box.max());
  measures.diagonal = box.diagonal().norm();
}

}  // namespace

MeshMeasures measure(const Mesh& mesh) {
  MeshMeasures measures;
  const std::vector<Triangle> triangles = usable_triangles(mesh);
  const std::vector<bool> used = referenced(mesh, triangles);
  measures.vertices = mesh.positions.size();
  measures.faces = mesh.triangles.size();
  measures.usable_faces = triangles.size();
  measure_box(mesh, used, measures);
  measure_edges(mesh, triangles, measures);
  measure_faces(mesh, triangles, measures);
  measures.components = count_components(mesh.positions.size(), used, triangles);
  measures.euler_characteristic = static_cast<long long>(measures.referenced_vertices) -
                                  static_cast<long long>(measures.edges) + static_cast<long long>(triangles.size());
  return measures;
}

std::size_t count_usable_faces(const Mesh& mesh) {
  const auto faces = std::count_if(mesh.triangles.begin(), mesh.triangles.end(),
                                   [&mesh](const Triangle& triangle) { return usable(mesh, triangle); });
  return static_cast<std::size_t>(faces);
}

std::size_t count_boundary_edges(const Mesh& mesh) {
  std::size_t boundary = 0;
  for_each_edge(sorted_sides(usable_triangles(mesh)), [&boundary](const Edge&, std::ptrdiff_t faces) {
    if (faces == 1) ++boundary;
  });
  return boundary;
}

}  // namespace prcage
