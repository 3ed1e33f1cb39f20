// Trees of axis-aligned boxes on Embree: the broad phase of every collision and distance question.
//
// Boxes are single precision, in a frame that maps the scene into about the unit cube, and rounded outward, so that
// no overlap of the double-precision originals is missed. Embree reports box pairs; callers decide exactly.
// Everything here must be called inside an Arena. A tree may be queried from many threads at once, not while it is
// being built.
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/vec3.h"

namespace prcage {

// x -> (x - centre) * scale, monotone in every coordinate, so that order and overlap survive rounding.
struct UnitFrame {
  Vec3 centre = Vec3::Zero();
  double scale = 1;
};

// Frame of the bounding box of the points (0, 0, 0 if there are none).
UnitFrame unit_frame(std::span<const Position> points);

struct Box {
  float lower[3] = {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
                    std::numeric_limits<float>::infinity()};
  float upper[3] = {-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                    -std::numeric_limits<float>::infinity()};

  bool overlaps(const Box& o) const {  // without branches: the answer is hard to predict
    bool all = true;
    for (int k = 0; k < 3; ++k) all &= (lower[k] <= o.upper[k]) & (o.lower[k] <= upper[k]);
    return all;
  }
  bool contains(const Box& o) const {
    bool all = true;
    for (int k = 0; k < 3; ++k) all &= (lower[k] <= o.lower[k]) & (o.upper[k] <= upper[k]);
    return all;
  }
  void unite(const Box& o) {
    for (int k = 0; k < 3; ++k) {
      lower[k] = lower[k] < o.lower[k] ? lower[k] : o.lower[k];
      upper[k] = upper[k] > o.upper[k] ? upper[k] : o.upper[k];
    }
  }
  bool empty() const { return !(lower[0] <= upper[0]); }
};

// Box of n points, outward-rounded.
Box bounding_box(const UnitFrame& frame, std::initializer_list<const double*> points);

enum class TreeQuality { fast_build, fast_query };

// Embree's device: shared by the trees of one run.
class TreeDevice {
 public:
  TreeDevice();
  RTCDevice get() const { return device_.get(); }

 private:
  struct Release {
    void operator()(RTCDevice d) const { rtcReleaseDevice(d); }
  };
  std::unique_ptr<RTCDeviceTy, Release> device_;
};

class BoxTree {
 public:
  explicit BoxTree(const TreeDevice& device) : device_(&device) {}

  // Builds the tree over boxes, which must stay where they are while the tree is used. Empty boxes are left out,
  // all others must be finite. Throws std::bad_alloc if Embree runs out of memory.
  void build(std::span<const Box> boxes, TreeQuality quality);

  bool empty() const { return live_ == 0; }
  std::span<const Box> boxes() const { return boxes_; }
  RTCScene scene() const { return scene_.get(); }

 private:
  struct Release {
    void operator()(RTCScene s) const { rtcReleaseScene(s); }
  };
  const TreeDevice* device_;
  std::unique_ptr<RTCSceneTy, Release> scene_;
  std::span<const Box> boxes_;
  std::size_t live_ = 0;
};

// Calls visit(i, j) for every box i of a and j of b that overlap, touching included, each pair once; concurrently
// and in no particular order. visit must not throw.
template <class Visit>
void join(const BoxTree& a, const BoxTree& b, const Visit& visit) {
  if (a.empty() || b.empty()) return;
  struct Context {
    const Box* a;
    const Box* b;
    const Visit* visit;
  } context{a.boxes().data(), b.boxes().data(), &visit};
  rtcCollide(
      a.scene(), b.scene(),
      [](void* user, RTCCollision* hits, unsigned count) {
        const auto& c = *static_cast<const Context*>(user);
        for (unsigned k = 0; k < count; ++k) {
          const std::uint32_t i = hits[k].primID0;
          const std::uint32_t j = hits[k].primID1;
          if (c.a[i].overlaps(c.b[j])) (*c.visit)(i, j);
        }
      },
      &context);
}

// The same for all unordered pairs i < j of one tree.
template <class Visit>
void self_join(const BoxTree& tree, const Visit& visit) {
  join(tree, tree, [&visit](std::uint32_t i, std::uint32_t j) {
    if (i < j) visit(i, j);
  });
}

}  // namespace prcage
