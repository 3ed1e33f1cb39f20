#include "parallel/silhouette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <new>
#include <numbers>
#include <vector>

#include "parallel/parallel_for.h"

namespace prcage {
namespace {

// Rays along the longer side of the picture.
constexpr int rays_across = 320;

using Vec3f = Eigen::Vector3f;

struct Release {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

// A mesh in single precision, in a frame that makes it about as large as the unit cube, ready for rays.
class Body {
 public:
  Body(const TreeDevice& device, const UnitFrame& frame, const Mesh& mesh) : scene_(rtcNewScene(device.get())) {
    points_.reserve(mesh.positions.size() + 1);
    for (const Position& p : mesh.positions) points_.push_back(((vec(p) - frame.centre) * frame.scale).cast<float>());
    points_.push_back(Vec3f::Zero());  // Embree reads 16 bytes at the last vertex
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, points_.data(), 0, sizeof(Vec3f),
                               points_.size() - 1);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                               sizeof(Triangle), mesh.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_.get());
    if (rtcGetDeviceError(device.get()) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  }

  std::size_t size() const { return points_.size() - 1; }
  const Vec3f& point(std::size_t v) const { return points_[v]; }

  bool covers(const Vec3f& origin, const Vec3f& direction) const {
    RTCRay ray{};
    ray.org_x = origin.x();
    ray.org_y = origin.y();
    ray.org_z = origin.z();
    ray.dir_x = direction.x();
    ray.dir_y = direction.y();
    ray.dir_z = direction.z();
    ray.tfar = std::numeric_limits<float>::infinity();
    ray.mask = ~0u;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_.get(), &context, &ray);
    return ray.tfar < 0;
  }

 private:
  std::vector<Vec3f> points_;
  std::unique_ptr<RTCSceneTy, Release> scene_;
};

// View k of n: a point of the Fibonacci lattice on the upper half of the sphere.
Vec3 direction(std::size_t k, std::size_t n) {
  const double z = (static_cast<double>(k) + 0.5) / static_cast<double>(n), r = std::sqrt(1 - z * z);
  const double angle = 2 * std::numbers::pi * std::numbers::phi * static_cast<double>(k);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

// The picture plane of a view, and the rectangle on it that holds both bodies.
class View {
 public:
  View(const Vec3& along, const Body& input, const Body& surface)
      : along_(along.cast<float>()), x_(along.unitOrthogonal().cast<float>()), y_(along_.cross(x_)) {
    for (const Body* body : {&input, &surface}) {
      for (std::size_t v = 0; v < body->size(); ++v) {
        const Vec3f& p = body->point(v);
        const std::array<float, 3> at{p.dot(x_), p.dot(y_), p.dot(along_)};
        for (std::size_t k = 0; k < 3; ++k) {
          low_[k] = std::min(low_[k], at[k]);
          high_[k] = std::max(high_[k], at[k]);
        }
      }
    }
    cell_ = std::max(high_[0] - low_[0], high_[1] - low_[1]) / rays_across;
  }

  int columns() const { return 1 + static_cast<int>((high_[0] - low_[0]) / cell_); }
  int rows() const { return 1 + static_cast<int>((high_[1] - low_[1]) / cell_); }
  const Vec3f& along() const { return along_; }

  Vec3f origin(int column, int row) const {
    const float x = low_[0] + (static_cast<float>(column) + 0.5f) * cell_;
    const float y = low_[1] + (static_cast<float>(row) + 0.5f) * cell_;
    return x * x_ + y * y_ + (low_[2] - 1) * along_;
  }

 private:
  Vec3f along_, x_, y_;
  static constexpr float far = std::numeric_limits<float>::infinity();
  std::array<float, 3> low_{far, far, far}, high_{-far, -far, -far};
  float cell_ = 0;
};

// Area of the difference over that of the input.
double difference(const View& view, const Body& input, const Body& surface) {
  struct Count {
    std::size_t input = 0, different = 0;
  };
  std::vector<Count> rows(static_cast<std::size_t>(view.rows()));
  parallel_each(rows.size(), 4, [&](std::size_t row) {
    Count count;
    for (int column = 0; column < view.columns(); ++column) {
      const Vec3f origin = view.origin(column, static_cast<int>(row));
      const bool covered = input.covers(origin, view.along());
      count.input += covered ? 1 : 0;
      count.different += covered != surface.covers(origin, view.along()) ? 1 : 0;
    }
    rows[row] = count;
  });
  Count sum;
  for (const Count& row : rows) {
    sum.input += row.input;
    sum.different += row.different;
  }
  return static_cast<double>(sum.different) / static_cast<double>(std::max<std::size_t>(sum.input, 1));
}

}  // namespace

SilhouetteDeviation measure_silhouettes(const TreeDevice& device, const UnitFrame& frame, const Mesh& input,
                                        const Mesh& surface, std::size_t views) {
  const Body input_body(device, frame, input), surface_body(device, frame, surface);
  SilhouetteDeviation deviation{views, 0, 0};
  for (std::size_t k = 0; k < views; ++k) {
    const double d = difference(View(direction(k, views), input_body, surface_body), input_body, surface_body);
    deviation.mean += d / static_cast<double>(views);
    deviation.max = std::max(deviation.max, d);
  }
  return deviation;
}

}  // namespace prcage
