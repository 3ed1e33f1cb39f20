#include "core/patch_gap.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace prcage {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Triangles flatter than this share of their longest edge squared, and edges at a smaller angle, are not measured.
constexpr double flattest = 1e-6;
// Points so little outside a triangle or an edge, in its own coordinates, count as within.
constexpr double slack = 1e-9;
// Rounding in the place of a crossing, relative to the height of the discs, with much to spare.
constexpr double rounding = 1e-7;
// Rounding of sums of few products of coordinates, relative to the products.
constexpr double sum_rounding = 2e-15;

double cross(const Vec3& u, const Vec3& v) { return u.x() * v.y() - u.y() * v.x(); }
double dot(const Vec3& u, const Vec3& v) { return u.x() * v.x() + u.y() * v.y(); }
double length_squared(const Vec3& u) { return dot(u, u); }
double extent(const Vec3& u) { return std::abs(u.x()) + std::abs(u.y()); }

bool apart(double x, double y, double low, double high) { return std::min(x, y) > high || std::max(x, y) < low; }

// The difference in height where two edges cross as seen along n; 0 if they do not cross, infinity if that is hard to
// tell. Edges with a common end have no other crossing that matters: where they lie on each other, the difference is
// largest at the other end of the shorter one, which is an inner vertex.
double gap_at_crossing(const std::array<Vec3, 2>& e, const std::array<Vec3, 2>& f) {
  const Vec3 d = e[1] - e[0], g = f[1] - f[0], w = f[0] - e[0];
  const double area = cross(d, g);
  const double along_d = cross(w, g), along_g = cross(w, d);  // times 1 / area: places of the crossing
  if (area * area <= flattest * flattest * length_squared(d) * length_squared(g)) {
    if (e[0] == f[0] || e[0] == f[1] || e[1] == f[0] || e[1] == f[1]) return 0;
    const Vec3 v = f[1] - e[0];
    const double length = length_squared(d), unsure = flattest * length;
    const bool beside = apart(along_g, cross(v, d), -unsure, unsure);
    return beside || apart(dot(w, d), dot(v, d), -unsure, length + unsure) ? 0 : infinity;
  }
  const double sign = area < 0 ? -1 : 1, tolerated = slack * std::abs(area);
  const double error = sum_rounding * extent(w) * std::max(extent(d), extent(g));
  const double least = -tolerated - error, most = std::abs(area) - least;
  if (apart(sign * along_d, sign * along_d, least, most) || apart(sign * along_g, sign * along_g, least, most))
    return 0;
  if (error > tolerated) return infinity;
  return std::abs((along_d * d.z() - along_g * g.z()) / area - w.z());
}

}  // namespace

ViewAlong::ViewAlong(const Vec3& n, const double* origin) : n_(n), origin_(origin) {
  int k = 0;  // the axis that is most nearly orthogonal to n
  for (int i = 1; i < 3; ++i)
    if (std::abs(n[i]) < std::abs(n[k])) k = i;
  across_[0] = n.cross(Vec3::Unit(k)).normalized();
  across_[1] = n.cross(across_[0]);
}

void GraphDisc::add_inner_edge(const Vec3& a, const Vec3& b) {
  const double margin = slack * (extent(a) + extent(b));
  edges_.add({{a, b},
              {std::min(a.x(), b.x()) - margin, std::min(a.y(), b.y()) - margin},
              {std::max(a.x(), b.x()) + margin, std::max(a.y(), b.y()) + margin}});
}

// The difference in height between p and the disc.
double GraphDisc::gap_at(const Vec3& p) const {
  double gap = -1;
  for (const auto& [a, b, c] : faces_) {
    const double area = cross(b - a, c - a);
    const double longest = std::max({length_squared(b - a), length_squared(c - b), length_squared(a - c)});
    if (!(area > flattest * longest)) return infinity;
    const double at_a = cross(b - p, c - p) / area, at_b = cross(c - p, a - p) / area;
    const double at_c = 1 - at_a - at_b;
    if (std::min({at_a, at_b, at_c}) < -slack) continue;
    gap = std::max(gap, std::abs(at_a * a.z() + at_b * b.z() + at_c * c.z() - p.z()));
  }
  return gap < 0 ? infinity : gap;
}

double GraphDisc::gap_at_crossings(const GraphDisc& other) const {
  double gap = 0;
  for (const auto& e : edges_)
    for (const auto& f : other.edges_) {
      if (e.low[0] > f.high[0] || f.low[0] > e.high[0] || e.low[1] > f.high[1] || f.low[1] > e.high[1]) continue;
      gap = std::max(gap, gap_at_crossing(e.end, f.end));
    }
  return gap;
}

double GraphDisc::rounding_of_heights() const {
  double low = infinity, high = -infinity, widest = 0;
  for (const auto& face : faces_) {
    for (const Vec3& p : face) {
      low = std::min(low, p.z());
      high = std::max(high, p.z());
      widest = std::max(widest, extent(p) + std::abs(p.z()));
    }
  }
  return rounding * (high - low) + sum_rounding * widest;
}

double largest_gap(const GraphDisc& s, const GraphDisc& t) {
  if (s.overflown() || t.overflown()) return infinity;
  double gap = s.gap_at_crossings(t);
  for (const Vec3& p : s.vertices_) gap = std::max(gap, t.gap_at(p));
  for (const Vec3& p : t.vertices_) gap = std::max(gap, s.gap_at(p));
  return gap + std::max(s.rounding_of_heights(), t.rounding_of_heights());
}

}  // namespace prcage
