#include "parallel/inverted_faces.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <vector>

#include "core/lattice.h"
#include "parallel/closest_face.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

// Faces that are farther than the closest one by less are as close: of the distance, and of the size of the scene.
constexpr double distance_rounding = 1e-9;
constexpr double input_rounding = 1e-12;

struct Sample {
  Vec3 point;
  double distance;  // of the closest face of the input
  std::uint32_t face;
};

class InvertedFaces {
 public:
  InvertedFaces(const SurfaceTree& input, const SurfaceTree& surface)
      : input_(input),
        surface_(surface),
        closest_(input),
        normals_(surface.triangles().size()),
        suspect_(surface.triangles().size()) {}

  std::size_t count(const TreeDevice& device) {
    parallel_each(suspect_.size(), 16, [&](std::size_t f) {
      const Corners p = corners(static_cast<std::uint32_t>(f));
      normals_[f] = (p[1] - p[0]).cross(p[2] - p[0]);
      suspect_[f] = !normals_[f].isZero(0) && !faces_a_closest_one(p, normals_[f]);
    });
    clear_by_equally_close_faces(device);
    return static_cast<std::size_t>(std::count(suspect_.begin(), suspect_.end(), 1));
  }

 private:
  Corners corners(std::uint32_t f) const {
    const Triangle& t = surface_.triangles()[f];
    return {vec(surface_.positions()[t[0]]), vec(surface_.positions()[t[1]]), vec(surface_.positions()[t[2]])};
  }

  bool faces_a_closest_one(const Corners& p, const Vec3& normal) const {
    bool found = false;
    std::uint32_t hint = none;
    for_each_lattice_point([&](const Barycentric& weights) {
      if (found) return;
      hint = closest_.nearest(at(p, weights), hint).face;
      found = normal.dot(closest_.area_normal(hint)) > 0;
    });
    return found;
  }

  // Few faces come here: those at sharp edges of the input, and the inverted ones.
  void clear_by_equally_close_faces(const TreeDevice& device) {
    std::vector<Sample> samples;
    for (std::uint32_t f = 0; f < suspect_.size(); ++f) {
      if (!suspect_[f]) continue;
      for_each_lattice_point([&](const Barycentric& weights) { samples.push_back({at(corners(f), weights), 0, f}); });
    }
    if (samples.empty()) return;
    std::vector<Box> boxes(samples.size());
    parallel_each(samples.size(), 16, [&](std::size_t i) {
      Sample& s = samples[i];
      s.distance = closest_.nearest(s.point).distance * (1 + distance_rounding) + input_rounding / input_.frame().scale;
      const Position low = position(s.point - Vec3::Constant(s.distance));
      const Position high = position(s.point + Vec3::Constant(s.distance));
      boxes[i] = bounding_box(input_.frame(), {low.data(), high.data()});
    });
    BoxTree tree(device);
    tree.build(boxes, TreeQuality::fast_query);
    join(tree, input_.runs(), [&](std::uint32_t i, std::uint32_t f) {
      const Sample& s = samples[i];
      std::atomic_ref suspect(suspect_[s.face]);
      if (suspect.load(std::memory_order_relaxed) != 0 && normals_[s.face].dot(closest_.area_normal(f)) > 0 &&
          closest_.distance_to_face(s.point, f) <= s.distance)
        suspect.store(0, std::memory_order_relaxed);
    });
  }

  const SurfaceTree& input_;
  const SurfaceTree& surface_;
  ClosestFace closest_;
  std::vector<Vec3> normals_;
  std::vector<std::uint8_t> suspect_;
};

}  // namespace

std::size_t count_inverted_faces(const TreeDevice& device, const SurfaceTree& input, const SurfaceTree& surface) {
  return InvertedFaces(input, surface).count(device);
}

}  // namespace prcage
