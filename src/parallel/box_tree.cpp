#include "parallel/box_tree.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <functional>
#include <new>

#include "core/round_outward.h"

namespace prcage {
namespace {

// Embree drops boxes beyond about 1.8e18 without a word. Clamping is monotone, so boxes that overlap still do.
constexpr double embree_limit = 1e18;

double clamp(double x) { return std::clamp(x, -embree_limit, embree_limit); }

void write_bounds(const RTCBoundsFunctionArguments* args) {
  const Box& box = static_cast<const Box*>(args->geometryUserPtr)[args->primID];
  *args->bounds_o = RTCBounds{box.lower[0], box.lower[1], box.lower[2], 0, box.upper[0], box.upper[1], box.upper[2], 0};
}

std::size_t count_live(std::span<const Box> boxes) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, boxes.size(), 1u << 14), std::size_t{0},
      [&](const tbb::blocked_range<std::size_t>& range, std::size_t n) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) n += boxes[i].empty() ? 0 : 1;
        return n;
      },
      std::plus<>());
}

}  // namespace

UnitFrame unit_frame(std::span<const Position> points) {
  if (points.empty()) return {};
  Vec3 lower = vec(points[0]);
  Vec3 upper = lower;
  for (const Position& p : points) {
    lower = lower.cwiseMin(vec(p));
    upper = upper.cwiseMax(vec(p));
  }
  const double extent = (upper - lower).maxCoeff();
  return {0.5 * (lower + upper), extent > 0 ? 1 / extent : 1};
}

Box bounding_box(const UnitFrame& frame, std::initializer_list<const double*> points) {
  Box box;
  for (int k = 0; k < 3; ++k) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const double* p : points) {
      low = std::min(low, p[k]);
      high = std::max(high, p[k]);
    }
    box.lower[k] = float_below(clamp((low - frame.centre[k]) * frame.scale));
    box.upper[k] = float_above(clamp((high - frame.centre[k]) * frame.scale));
  }
  return box;
}

// No "threads=" here: that would set a process-wide limit on the host's TBB. Embree works in the calling arena.
TreeDevice::TreeDevice() : device_(rtcNewDevice(nullptr)) {
  if (!device_) throw std::bad_alloc();
}

void BoxTree::build(std::span<const Box> boxes, TreeQuality quality) {
  boxes_ = boxes;
  live_ = count_live(boxes);
  scene_.reset();
  if (live_ == 0) return;
  const RTCBuildQuality level = quality == TreeQuality::fast_build ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM;
  scene_.reset(rtcNewScene(device_->get()));
  rtcSetSceneBuildQuality(scene_.get(), level);
  RTCGeometry geometry = rtcNewGeometry(device_->get(), RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryBuildQuality(geometry, level);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(boxes.size()));
  rtcSetGeometryUserData(geometry, const_cast<Box*>(boxes.data()));
  rtcSetGeometryBoundsFunction(geometry, write_bounds, nullptr);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_.get());
  if (rtcGetDeviceError(device_->get()) != RTC_ERROR_NONE) throw std::bad_alloc();
}

}  // namespace prcage
