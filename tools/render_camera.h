// Where a picture is seen from.
#pragma once

#include <vector>

#include "tools/render.h"
#include "tools/render_math.h"
#include "tools/render_scene.h"

namespace prcage::raycast {

// Perspective camera for one panel, in samples: x to the right, y down, from the panel's upper left corner.
class Camera {
 public:
  Camera(const RenderOptions& options, int columns, int rows);

  // Backs off and shifts sideways until all points are inside, with a margin.
  void fit(const std::vector<const Body*>& bodies);

  const Vec3f& eye() const { return eye_; }
  const Vec3f& right() const { return right_; }
  const Vec3f& back() const { return back_; }
  const Vec3f& world_up() const { return world_up_; }

  Vec3f direction(float x, float y) const;

  // Sample coordinates and the depth along the view.
  Vec3f project(const Vec3f& point) const;

  // 1 in the middle of the panel, 0 at its left and right border and below.
  float inset(const Vec3f& point) const;

 private:
  template <class Visit>
  void for_each_point(const std::vector<const Body*>& bodies, const Vec3f& target, const Visit& visit) const;
  float distance_for(const std::vector<const Body*>& bodies, const Vec3f& target) const;

  float columns_, rows_, tan_x_ = 0, tan_y_ = 0;
  Vec3f eye_ = Vec3f::Zero(), right_, up_, back_, world_up_;
};

}  // namespace prcage::raycast
