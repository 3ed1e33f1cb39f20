#include "core/surface.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace prcage {
namespace {

// Disjoint sets of numbers; the smallest member represents its set.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  void unite(std::uint32_t i, std::uint32_t j) {
    i = find(i);
    j = find(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

std::uint32_t origin(std::span<const Triangle> triangles, std::uint32_t h) { return triangles[h / 3][h % 3]; }

// Spreads the bits of a position; positions that compare equal have the same value.
std::uint64_t hash(const Position& p) {
  std::uint64_t h = 0;
  for (const double x : p) {
    h ^= std::bit_cast<std::uint64_t>(x + 0.0);  // -0 + 0 is 0
    h *= 0x9e3779b97f4a7c15u;
    h ^= h >> 32;
  }
  return h;
}

}  // namespace

SubMesh select_faces(std::span<const Position> positions, std::span<const Triangle> triangles,
                     std::span<const std::uint8_t> keep) {
  SubMesh part;
  std::vector<std::uint32_t> number(positions.size(), none);
  for (std::uint32_t f = 0; f < triangles.size(); ++f) {
    if (!keep.empty() && keep[f] == 0) continue;
    part.face_of.push_back(f);
    part.mesh.triangles.push_back(triangles[f]);
    for (const std::uint32_t v : triangles[f]) number[v] = 0;
  }
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    if (number[v] == none) continue;
    number[v] = static_cast<std::uint32_t>(part.vertex_of.size());
    part.vertex_of.push_back(v);
    part.mesh.positions.push_back(positions[v]);
  }
  for (Triangle& t : part.mesh.triangles)
    for (std::uint32_t& v : t) v = number[v];
  return part;
}

SubMesh arrange_faces(std::span<const Position> positions, std::span<const Triangle> triangles,
                      std::vector<std::uint32_t> faces) {
  SubMesh part;
  std::vector<std::uint32_t> number(positions.size(), none);
  part.mesh.triangles.reserve(faces.size());
  for (const std::uint32_t f : faces) {
    Triangle t = triangles[f];
    for (std::uint32_t& v : t) {
      if (number[v] == none) {
        number[v] = static_cast<std::uint32_t>(part.vertex_of.size());
        part.vertex_of.push_back(v);
        part.mesh.positions.push_back(positions[v]);
      }
      v = number[v];
    }
    part.mesh.triangles.push_back(t);
  }
  part.face_of = std::move(faces);
  return part;
}

Components face_components(std::size_t face_count, const EdgeGroups& edges) {
  DisjointSets sets(face_count);
  for (std::size_t e = 0; e < edges.size(); ++e)
    for (const std::uint32_t h : edges[e]) sets.unite(edges[e][0] / 3, h / 3);

  Components components;
  components.of_face.resize(face_count);
  std::vector<std::uint32_t> sizes;
  for (std::uint32_t f = 0; f < face_count; ++f) {
    const std::uint32_t first = sets.find(f);
    if (first == f) sizes.push_back(0);
    const std::uint32_t c = first == f ? static_cast<std::uint32_t>(sizes.size() - 1) : components.of_face[first];
    components.of_face[f] = c;
    ++sizes[c];
  }
  components.offsets.assign(1, 0);
  for (const std::uint32_t size : sizes) components.offsets.push_back(components.offsets.back() + size);
  components.faces.resize(face_count);
  std::vector<std::uint32_t> end(components.offsets.begin(), components.offsets.end() - 1);
  for (std::uint32_t f = 0; f < face_count; ++f) components.faces[end[components.of_face[f]]++] = f;
  return components;
}

std::vector<std::uint32_t> non_manifold_vertices(std::span<const Triangle> triangles, std::size_t vertex_count,
                                                 const EdgeGroups& edges) {
  DisjointSets corners(3 * triangles.size());  // corner i of face f is 3 f + i
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const std::uint32_t first = edges[e][0];
    for (const std::uint32_t h : edges[e].subspan(1)) {
      const bool same_direction = origin(triangles, h) == origin(triangles, first);
      corners.unite(first, same_direction ? h : next_halfedge(h));
      corners.unite(next_halfedge(first), same_direction ? next_halfedge(h) : h);
    }
  }
  std::vector<std::uint8_t> fans(vertex_count, 0);  // 0, 1, or 2 for more
  for (std::uint32_t c = 0; c < 3 * triangles.size(); ++c) {
    std::uint8_t& n = fans[origin(triangles, c)];
    if (corners.find(c) == c && n < 2) ++n;
  }
  std::vector<std::uint32_t> found;
  for (std::uint32_t v = 0; v < vertex_count; ++v)
    if (fans[v] > 1) found.push_back(v);
  return found;
}

std::vector<std::array<std::uint32_t, 2>> duplicate_faces(std::span<const Triangle> triangles,
                                                          const EdgeGroups& edges) {
  std::vector<std::array<std::uint32_t, 2>> found;
  std::vector<std::array<std::uint32_t, 2>> faces;  // {apex, face} round one edge
  const auto apex = [&](std::uint32_t h) { return origin(triangles, previous_halfedge(h)); };
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (edges[e].size() < 2) continue;
    if (edges[e].size() == 2 && apex(edges[e][0]) != apex(edges[e][1])) continue;  // nearly all of them
    faces.clear();
    for (const std::uint32_t h : edges[e]) faces.push_back({apex(h), h / 3});
    std::sort(faces.begin(), faces.end());
    const std::uint32_t h = edges[e][0];
    const std::uint32_t larger_end = std::max(origin(triangles, h), origin(triangles, next_halfedge(h)));
    for (std::size_t k = 1; k < faces.size(); ++k)  // each pair has three common edges: take the one of low vertices
      if (faces[k][0] == faces[k - 1][0] && faces[k][0] > larger_end) found.push_back({faces[k - 1][1], faces[k][1]});
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a[1] < b[1]; });
  return found;
}

std::size_t count_duplicate_positions(std::span<const Position> positions) {
  struct Entry {
    std::uint64_t hash;
    std::uint32_t vertex;
  };
  std::vector<Entry> entries(positions.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v) entries[v] = {hash(positions[v]), v};
  std::sort(entries.begin(), entries.end(), [&](const Entry& a, const Entry& b) {
    return a.hash != b.hash ? a.hash < b.hash : positions[a.vertex] < positions[b.vertex];
  });
  std::size_t count = 0;
  for (std::size_t k = 1; k < entries.size(); ++k)
    if (positions[entries[k].vertex] == positions[entries[k - 1].vertex]) ++count;
  return count;
}

double Extent::diagonal() const {
  const Vec3 size = upper - lower;
  return std::hypot(size.x(), size.y(), size.z());  // does not underflow in between
}

Extent extent(std::span<const Position> positions) {
  if (positions.empty()) return {};
  Extent box{vec(positions[0]), vec(positions[0])};
  for (const Position& p : positions) {
    box.lower = box.lower.cwiseMin(vec(p));
    box.upper = box.upper.cwiseMax(vec(p));
  }
  return box;
}

Measures measure(std::span<const Position> positions, std::span<const Triangle> triangles) {
  const Extent box = extent(positions);
  const Vec3 centre = 0.5 * (box.lower + box.upper);
  Measures sum;
  for (const Triangle& t : triangles) {
    const Vec3 a = vec(positions[t[0]]) - centre;
    const Vec3 b = vec(positions[t[1]]) - centre;
    const Vec3 c = vec(positions[t[2]]) - centre;
    sum.area += 0.5 * (b - a).cross(c - a).norm();
    sum.volume += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

}  // namespace prcage
