// The bracket: a machine part with holes, cut into triangles as exporters of CAD programs do.
#include "tools/shape_parts.h"

#include <map>

namespace prcage::shape {
namespace {

using Loop = std::vector<std::uint32_t>;

// Cuts a plane polygon with round holes into triangles, as exporters of CAD programs do: no new vertices, hence
// long thin triangles. Holes are joined to the outer loop by bridges, then ears are clipped.
class PolygonCutter {
 public:
  // Counterclockwise is seen from the positive side of the axis, or from the negative side.
  PolygonCutter(const Mesh& mesh, std::size_t axis, bool positive)
      : mesh_(mesh), u_((axis + (positive ? 1 : 2)) % 3), v_((axis + (positive ? 2 : 1)) % 3) {}

  std::vector<Triangle> cut(Loop outer, std::vector<Loop> holes) const {
    orient(outer, true);
    for (Loop& hole : holes) orient(hole, false);
    while (!holes.empty()) bridge_nearest(outer, holes);
    return clip_ears(std::move(outer));
  }

 private:
  double coordinate(std::uint32_t vertex, std::size_t axis) const { return mesh_.positions[vertex][axis]; }

  // Twice the signed area of a triangle.
  double area(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return (coordinate(b, u_) - coordinate(a, u_)) * (coordinate(c, v_) - coordinate(a, v_)) -
           (coordinate(b, v_) - coordinate(a, v_)) * (coordinate(c, u_) - coordinate(a, u_));
  }

  double squared_distance(std::uint32_t a, std::uint32_t b) const {
    return (vec(mesh_.positions[a]) - vec(mesh_.positions[b])).squaredNorm();
  }

  void orient(Loop& loop, bool counterclockwise) const {
    double sum = 0;
    for (std::size_t i = 1; i + 1 < loop.size(); ++i) sum += area(loop[0], loop[i], loop[i + 1]);
    if ((sum > 0) != counterclockwise) std::reverse(loop.begin(), loop.end());
  }

  // Joins the hole that is nearest to the outer loop. Holes are round and no smaller than the gaps between their
  // corners, so nothing lies between the two nearest vertices.
  void bridge_nearest(Loop& outer, std::vector<Loop>& holes) const {
    struct {
      std::size_t hole = 0, inner = 0, outer = 0;
      double distance = HUGE_VAL;
    } best;
    for (std::size_t h = 0; h < holes.size(); ++h) {
      for (std::size_t i = 0; i < holes[h].size(); ++i) {
        for (std::size_t o = 0; o < outer.size(); ++o) {
          const double distance = squared_distance(holes[h][i], outer[o]);
          if (distance < best.distance) best = {h, i, o, distance};
        }
      }
    }
    Loop& hole = holes[best.hole];
    std::rotate(hole.begin(), hole.begin() + static_cast<std::ptrdiff_t>(best.inner), hole.end());
    hole.push_back(hole.front());
    hole.push_back(outer[best.outer]);
    outer.insert(outer.begin() + static_cast<std::ptrdiff_t>(best.outer) + 1, hole.begin(), hole.end());
    holes.erase(holes.begin() + static_cast<std::ptrdiff_t>(best.hole));
  }

  // Can the corner be cut off? Not if another vertex lies in it or on its rim. The margin is far above rounding and
  // far below any triangle of the part.
  bool is_ear(const Loop& loop, std::size_t corner) const {
    constexpr double margin = 1e-9;
    const std::uint32_t a = loop[(corner + loop.size() - 1) % loop.size()], b = loop[corner],
                        c = loop[(corner + 1) % loop.size()];
    if (area(a, b, c) <= margin) return false;
    return std::none_of(loop.begin(), loop.end(), [&](std::uint32_t p) {
      if (p == a || p == b || p == c) return false;
      return area(a, b, p) >= -margin && area(b, c, p) >= -margin && area(c, a, p) >= -margin;
    });
  }

  std::vector<Triangle> clip_ears(Loop loop) const {
    std::vector<Triangle> triangles;
    std::size_t corner = 0, misses = 0;
    while (loop.size() >= 3 && misses < loop.size()) {
      corner %= loop.size();
      if (!is_ear(loop, corner)) {
        ++corner;
        ++misses;
        continue;
      }
      const std::size_t before = (corner + loop.size() - 1) % loop.size();
      triangles.push_back({loop[before], loop[corner], loop[(corner + 1) % loop.size()]});
      loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(corner));
      misses = 0;
    }
    return triangles;
  }

  const Mesh& mesh_;
  std::size_t u_, v_;
};

// An angle bracket: two plates, two bolt holes in the foot, a boss with a bore in the upright. The outline lies in
// the x-y plane and is extruded along z. Three holes through it: genus 3.
class Bracket {
 public:
  Bracket(std::size_t segments, std::uint64_t seed) : segments_(segments) {
    Random random(seed);
    phase_ = random.uniform(0, 1);
    bolt_ = random.uniform(0.42, 0.55);
    bore_ = random.uniform(0.6, 0.8);
    boss_height_ = random.uniform(0.5, 0.8);
  }

  Mesh make() {
    add_outline();
    const Loop bolts_bottom[] = {circle(1, {2.4, 0, 1.2}, bolt_), circle(1, {4.0, 0, 2.9}, bolt_)};
    const Loop bolts_top[] = {circle(1, {2.4, 1, 1.2}, bolt_), circle(1, {4.0, 1, 2.9}, bolt_)};
    const double face = 1 + boss_height_;
    const Loop bore_back = circle(0, {0, 3, 2}, bore_), bore_face = circle(0, {face, 3, 2}, bore_);
    const Loop boss_foot = circle(0, {1, 3, 2}, bore_ + 0.45), boss_face = circle(0, {face, 3, 2}, bore_ + 0.45);

    add_plane(1, false, {front(0), front(1), back(1), back(0)}, {bolts_bottom[0], bolts_bottom[1]});
    add_plane(1, true, {front(3), front(2), back(2), back(3)}, {bolts_top[0], bolts_top[1]});
    add_plane(0, false, {front(0), front(5), back(5), back(0)}, {bore_back});
    add_plane(0, true, {front(3), front(4), back(4), back(3)}, {boss_foot});
    add_plane(0, true, boss_face, {bore_face});
    add_plane(0, true, {front(1), front(2), back(2), back(1)}, {});
    add_plane(1, true, {front(4), front(5), back(5), back(4)}, {});
    add_plane(2, false, {front(0), front(1), front(2), front(3), front(4), front(5)}, {});
    add_plane(2, true, {back(0), back(1), back(2), back(3), back(4), back(5)}, {});
    add_wall(boss_foot, boss_face);
    add_wall(bore_face, bore_back);
    for (int i = 0; i < 2; ++i) add_wall(bolts_top[i], bolts_bottom[i]);
    return std::move(mesh_);
  }

  static constexpr std::size_t face_count(std::size_t segments) { return 16 * segments + 32; }

 private:
  static constexpr std::size_t outline_size = 6;

  static std::uint32_t front(std::uint32_t corner) { return corner; }
  static std::uint32_t back(std::uint32_t corner) { return corner + outline_size; }

  void add_outline() {
    static constexpr double outline[outline_size][2] = {{0, 0}, {5.2, 0}, {5.2, 1}, {1, 1}, {1, 5}, {0, 5}};
    for (double z : {0.0, 4.0}) {
      for (const auto& p : outline) mesh_.positions.push_back({p[0], p[1], z});
    }
  }

  // A circle around the axis, counterclockwise seen from its positive side.
  Loop circle(int axis, const Vec3& centre, double radius) {
    Loop loop;
    for (std::size_t i = 0; i < segments_; ++i) {
      const CosSin angle = turn(phase_ + static_cast<double>(i) / static_cast<double>(segments_));
      Vec3 p = centre;
      p[(axis + 1) % 3] += radius * angle.cos;
      p[(axis + 2) % 3] += radius * angle.sin;
      loop.push_back(index(mesh_.positions.size()));
      mesh_.positions.push_back(position(p));
    }
    return loop;
  }

  void add_plane(std::size_t axis, bool positive, const Loop& outer, const std::vector<Loop>& holes) {
    const std::vector<Triangle> triangles = PolygonCutter(mesh_, axis, positive).cut(outer, holes);
    mesh_.triangles.insert(mesh_.triangles.end(), triangles.begin(), triangles.end());
  }

  // A band between two circles around one axis. It faces outward if `from` lies below `to`, inward otherwise.
  void add_wall(const Loop& from, const Loop& to) {
    for (std::size_t i = 0; i < segments_; ++i) {
      const std::size_t next = (i + 1) % segments_;
      add_quad(mesh_, from[i], from[next], to[next], to[i]);
    }
  }

  std::size_t segments_;
  double phase_, bolt_, bore_, boss_height_;
  Mesh mesh_;
};

// Cuts every edge of a small mesh into `parts` and every face into parts * parts similar ones.
class Subdivision {
 public:
  Subdivision(const Mesh& base, std::size_t parts) : base_(base), parts_(parts) {}

  Mesh run() {
    mesh_.positions = base_.positions;
    mesh_.triangles.reserve(base_.triangles.size() * parts_ * parts_);
    for (const Triangle& face : base_.triangles) add_face(face);
    return std::move(mesh_);
  }

 private:
  // Differences first: a coordinate that is the same at all corners stays exactly so.
  std::uint32_t add_vertex(const Triangle& face, std::size_t i, std::size_t j) {
    const Vec3 p = vec(base_.positions[face[0]]);
    const double u = static_cast<double>(i) / static_cast<double>(parts_);
    const double v = static_cast<double>(j) / static_cast<double>(parts_);
    const Vec3 q = p + u * (vec(base_.positions[face[1]]) - p) + v * (vec(base_.positions[face[2]]) - p);
    mesh_.positions.push_back(position(q));
    return index(mesh_.positions.size() - 1);
  }

  // Vertex `step` of the way from a to b; the inner ones are made when the edge is first seen.
  std::uint32_t edge_vertex(std::uint32_t a, std::uint32_t b, std::size_t step) {
    if (step == 0) return a;
    if (step == parts_) return b;
    if (a > b) return edge_vertex(b, a, parts_ - step);
    const auto [entry, is_new] = first_on_edge_.try_emplace({a, b}, index(mesh_.positions.size()));
    if (is_new) {
      for (std::size_t i = 1; i < parts_; ++i) add_vertex({a, b, b}, i, 0);
    }
    return entry->second + index(step - 1);
  }

  // Row j of a face runs parallel to the edge from corner 0 to corner 1 and has parts - j cells.
  Loop row(const Triangle& face, std::size_t j) {
    Loop vertices;
    vertices.push_back(edge_vertex(face[0], face[2], j));
    const std::size_t cells = parts_ - j;
    for (std::size_t i = 1; i < cells; ++i) {
      vertices.push_back(j == 0 ? edge_vertex(face[0], face[1], i) : add_vertex(face, i, j));
    }
    if (cells > 0) vertices.push_back(edge_vertex(face[1], face[2], j));
    return vertices;
  }

  void add_face(const Triangle& face) {
    Loop lower = row(face, 0);
    for (std::size_t j = 0; j < parts_; ++j) {
      Loop upper = row(face, j + 1);
      for (std::size_t i = 0; i + 1 < lower.size(); ++i) {
        mesh_.triangles.push_back({lower[i], lower[i + 1], upper[i]});
        if (i + 1 < upper.size()) mesh_.triangles.push_back({lower[i + 1], upper[i + 1], upper[i]});
      }
      lower = std::move(upper);
    }
  }

  const Mesh& base_;
  std::size_t parts_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> first_on_edge_;
  Mesh mesh_;
};

}  // namespace

// As many segments a circle as the target allows, up to 64; beyond that all faces are refined.
Mesh make_bracket(std::size_t faces, std::uint64_t seed) {
  const double most = static_cast<double>(Bracket::face_count(64));
  const double parts = std::max(1.0, std::ceil(std::sqrt(static_cast<double>(faces) / most)));
  const double base_faces = static_cast<double>(faces) / (parts * parts);
  const Mesh base = Bracket(at_least(3, (base_faces - 32) / 16), seed).make();
  return Subdivision(base, static_cast<std::size_t>(parts)).run();
}

}  // namespace prcage::shape
