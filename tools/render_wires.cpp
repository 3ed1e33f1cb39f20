#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/render_panel.h"

namespace prcage::raycast {
namespace {

using Ends = std::pair<std::uint32_t, std::uint32_t>;

// Each edge once, as its two vertices.
std::vector<Ends> edges_of(const Body& body) {
  std::vector<Ends> ends;
  for (const Triangle& t : body.triangles()) {
    for (std::size_t i = 0; i < 3; ++i) ends.push_back(std::minmax(t[i], t[(i + 1) % 3]));
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  return ends;
}

}  // namespace

Wires::Wires(const Panel& panel, const Style& style, const Camera& camera, int columns)
    : panel_(panel), camera_(camera), columns_(columns), radius_(style.line_width / 2) {
  if (panel.wired == nullptr) return;
  const Body& body = *panel.wired;
  for (const auto& [a, b] : edges_of(body)) {
    edges_.push_back({camera.project(body.point(a)), camera.project(body.point(b)), body.point(a), body.point(b)});
  }
}

std::vector<Wire> Wires::mark(int first_row, int last_row) const {
  const auto offset = [&](int row) {
    return static_cast<std::size_t>(row - first_row) * static_cast<std::size_t>(columns_);
  };
  std::vector<Wire> wires(offset(last_row), Wire::none);
  for (const ProjectedEdge& edge : edges_) {
    const auto [low, high] = std::minmax({edge.from.y(), edge.to.y()});
    const int begin = std::max(first_row, static_cast<int>(std::floor(low - radius_)));
    const int end = std::min(last_row, static_cast<int>(std::ceil(high + radius_)));
    for (int row = begin; row < end; ++row) mark_row(edge, row, &wires[offset(row)]);
  }
  return wires;
}

// Marks the samples of one row that are within half a line width of the edge.
void Wires::mark_row(const ProjectedEdge& edge, int row, Wire* wires) const {
  const float radius = radius_, y = static_cast<float>(row) + 0.5f;
  const Vec2f a = edge.from.head<2>(), along = edge.to.head<2>() - a;
  // The part of the edge that is at most a radius above or below the row bounds the columns.
  float s0 = 0, s1 = 1;
  if (along.y() != 0) {
    const float t0 = (y - radius - a.y()) / along.y(), t1 = (y + radius - a.y()) / along.y();
    s0 = std::clamp(std::min(t0, t1), 0.0f, 1.0f);
    s1 = std::clamp(std::max(t0, t1), 0.0f, 1.0f);
  }
  const float x0 = a.x() + s0 * along.x(), x1 = a.x() + s1 * along.x();
  const int begin = std::max(0, static_cast<int>(std::floor(std::min(x0, x1) - radius)));
  const int end = std::min(columns_, static_cast<int>(std::ceil(std::max(x0, x1) + radius)));
  const float length_squared = std::max(along.squaredNorm(), 1e-12f);
  for (int column = begin; column < end; ++column) {
    const Vec2f offset = Vec2f(static_cast<float>(column) + 0.5f, y) - a;
    const float s = std::clamp(offset.dot(along) / length_squared, 0.0f, 1.0f);
    if (wires[column] == Wire::front || (offset - s * along).squaredNorm() > radius * radius) continue;
    wires[column] = std::max(wires[column], visibility(edge, s));
  }
}

// How the edge is seen at the share s of its length on the screen.
Wire Wires::visibility(const ProjectedEdge& edge, float s) const {
  const float t = s * edge.from.z() / ((1 - s) * edge.to.z() + s * edge.from.z());
  const Vec3f ray = edge.from_point + t * (edge.to_point - edge.from_point) - camera_.eye();
  // Short of the edge itself, so that its own faces do not hide it.
  constexpr float nearly = 1 - 3 * ray_offset;
  if (panel_.opaque->occluded(camera_.eye(), ray, 0, nearly)) return Wire::none;
  if (panel_.shell != nullptr && panel_.shell->occluded(camera_.eye(), ray, 0, nearly)) return Wire::back;
  return Wire::front;
}

}  // namespace prcage::raycast
