#include "core/vertex_cap.h"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "core/displacement.h"
#include "core/predicates.h"

namespace prcage {
namespace {

// Fans of more faces are not worth a quadratic search.
constexpr std::size_t largest_fan = 512;
// Of a centre that stays, in steps of the displacement.
constexpr double longest_direction = 20;

// The spherical polygon of the edges at a vertex; its inside is to the left of its sides.
class Polygon {
 public:
  Polygon(const CornerTable& mesh, std::uint32_t vertex, const std::vector<std::uint32_t>& fan)
      : centre_(mesh.point(vertex)), left_(fan.size()) {
    std::iota(left_.begin(), left_.end(), 0u);
    for (const std::uint32_t h : fan) {
      points_.push_back(mesh.point(mesh.target(h)));
      directions_.push_back((mesh.vec_at(mesh.target(h)) - mesh.vec_at(vertex)).normalized());
    }
  }

  std::size_t size() const { return left_.size(); }
  std::array<std::uint32_t, 3> ear(std::size_t i) const {
    return {left_[(i + size() - 1) % size()], left_[i], left_[(i + 1) % size()]};
  }
  void cut(std::size_t i) { left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(i)); }

  // The corner turns left and no other corner is in the cone over its triangle.
  bool is_ear(std::size_t i) const {
    const auto [p, q, r] = ear(i);
    if (side(p, q, r) <= 0) return false;
    return std::none_of(left_.begin(), left_.end(), [&, p = p, q = q, r = r](std::uint32_t w) {
      return w != p && w != q && w != r && side(p, q, w) >= 0 && side(q, r, w) >= 0 && side(r, p, w) >= 0;
    });
  }

  // A direction that clears the planes through the centre and each side. False if there is none, or only a long one: a
  // centre that has to go far would leave the ring behind.
  bool centre_direction(Vec3& direction) const {
    std::vector<Vec3> normals;
    for (std::size_t i = 0; i < size(); ++i) {
      const Vec3 n = directions_[left_[i]].cross(directions_[left_[(i + 1) % size()]]);
      if (n.squaredNorm() > 1e-18) normals.push_back(n.normalized());
    }
    return clearing_direction(normals, direction) && direction.norm() <= longest_direction;
  }

  std::uint32_t corner(std::size_t i) const { return left_[i % size()]; }

  // Cosine of the angle that the new side of the polygon spans.
  double closeness(std::size_t i) const {
    const auto [p, q, r] = ear(i);
    return directions_[p].dot(directions_[r]);
  }

 private:
  int side(std::uint32_t p, std::uint32_t q, std::uint32_t w) const {
    return exact::orient3d(centre_, points_[p], points_[q], points_[w]);
  }

  const double* centre_;
  std::vector<const double*> points_;
  std::vector<Vec3> directions_;
  std::vector<std::uint32_t> left_;
};

// Cuts the ear with the shortest new side: the cap stays as flat as the ring allows. False if there is no ear.
bool cut_best_ear(Polygon& polygon, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::size_t best = polygon.size();
  for (std::size_t i = 0; i < polygon.size(); ++i)
    if ((best == polygon.size() || polygon.closeness(i) > polygon.closeness(best)) && polygon.is_ear(i)) best = i;
  if (best == polygon.size()) return false;
  triangles.push_back(polygon.ear(best));
  polygon.cut(best);
  return true;
}

std::uint32_t append_face(CornerTable& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const auto h = static_cast<std::uint32_t>(mesh.corner_vertex.size());
  mesh.corner_vertex.insert(mesh.corner_vertex.end(), {a, b, c});
  mesh.twin.insert(mesh.twin.end(), 3, none);
  return h;
}

void pair_up(CornerTable& mesh, std::uint32_t g, std::uint32_t h) {
  mesh.twin[g] = h;
  mesh.twin[h] = g;
}

// Pairs the halfedges [first, end) without a twin among each other.
void pair_new_halfedges(CornerTable& mesh, std::uint32_t first) {
  struct Side {
    std::uint32_t low, high, halfedge;
    auto operator<=>(const Side&) const = default;
  };
  std::vector<Side> sides;
  for (std::uint32_t h = first; h < mesh.corner_vertex.size(); ++h) {
    if (mesh.twin[h] != none) continue;
    const std::uint32_t from = mesh.origin(h);
    const std::uint32_t to = mesh.target(h);
    sides.push_back({std::min(from, to), std::max(from, to), h});
  }
  std::sort(sides.begin(), sides.end());
  assert(sides.size() % 2 == 0);
  for (std::size_t i = 0; i + 1 < sides.size(); i += 2) pair_up(mesh, sides[i].halfedge, sides[i + 1].halfedge);
}

}  // namespace

VertexCap plan_cap(const CornerTable& mesh, std::uint32_t vertex) {
  VertexCap cap;
  for_each_outgoing(mesh, vertex, [&](std::uint32_t h) { cap.fan.push_back(h); });
  if (cap.fan.size() > largest_fan) return cap;
  Polygon polygon(mesh, vertex, cap.fan);
  while (polygon.size() >= 3) {
    if (!cap.empty() && polygon.centre_direction(cap.centre_direction)) {
      const auto centre = static_cast<std::uint32_t>(cap.fan.size());
      cap.keeps_centre = true;
      for (std::size_t i = 0; i < polygon.size(); ++i)
        cap.triangles.push_back({centre, polygon.corner(i), polygon.corner(i + 1)});
      return cap;
    }
    if (!cut_best_ear(polygon, cap.triangles)) {
      cap.triangles.clear();
      return cap;
    }
  }
  return cap;
}

std::vector<std::uint32_t> cap_vertex(CornerTable& mesh, const VertexCap& cap, double radius) {
  const std::size_t n = cap.fan.size();
  const std::uint32_t vertex = mesh.origin(cap.fan[0]);
  const Vec3 centre = mesh.vec_at(vertex);
  std::vector<std::uint32_t> ring;
  for (const std::uint32_t h : cap.fan) {
    const Vec3 along = mesh.vec_at(mesh.target(h)) - centre;
    const Position point = position(centre + (radius / along.norm()) * along);
    if (ring.empty() && !cap.keeps_centre) {
      ring.push_back(vertex);
      mesh.position[vertex] = point;
      mesh.vertex_halfedge[vertex] = h;
    } else {
      ring.push_back(static_cast<std::uint32_t>(mesh.position.size()));
      mesh.position.push_back(point);
      mesh.vertex_halfedge.push_back(h);
    }
    mesh.corner_vertex[h] = ring.back();
  }
  // Each face of the fan has lost a corner: a second triangle fills it up to the ring.
  const auto first = static_cast<std::uint32_t>(mesh.corner_vertex.size());
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t next = (i + 1) % n;
    const std::uint32_t h = append_face(mesh, ring[i], mesh.target(cap.fan[next]), ring[next]);
    pair_up(mesh, h, previous_halfedge(cap.fan[i]));
    pair_up(mesh, h + 1, cap.fan[next]);
  }
  for (const auto& [a, b, c] : cap.triangles) {
    const std::uint32_t h = append_face(mesh, a == n ? vertex : ring[a], ring[b], ring[c]);
    if (a == n) mesh.vertex_halfedge[vertex] = h;
  }
  pair_new_halfedges(mesh, first);
  return ring;
}

}  // namespace prcage
