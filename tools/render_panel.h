// One panel of a picture: an opaque body, perhaps a translucent shell around it, perhaps wires.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/render_camera.h"
#include "tools/render_math.h"
#include "tools/render_scene.h"

namespace prcage::raycast {

struct Panel {
  const Body* opaque = nullptr;
  const Body* shell = nullptr;  // translucent, may be null
  const Body* wired = nullptr;  // its edges are drawn, may be null
  bool smooth = false;
  Vec3f color;
  const DistanceColors* distance = nullptr;  // colours the opaque body instead of `color`, may be null
};

// What is common to all panels.
struct Style {
  Vec3f shell_color, line_color;
  bool shadow;
  float line_width;  // in samples
  int samples;
};

enum class Wire : std::uint8_t { none, back, front };  // back: seen through the shell

// The wires of a panel. They are drawn in screen space, so that they have one width everywhere, and ask the scene at
// each sample whether the point of the edge can be seen.
class Wires {
 public:
  // `columns`: samples across the panel.
  Wires(const Panel& panel, const Style& style, const Camera& camera, int columns);

  // The wires on the samples of a band of sample rows, row by row.
  std::vector<Wire> mark(int first_row, int last_row) const;

 private:
  struct ProjectedEdge {
    Vec3f from, to;  // sample coordinates and depth
    Vec3f from_point, to_point;
  };

  void mark_row(const ProjectedEdge& edge, int row, Wire* wires) const;
  Wire visibility(const ProjectedEdge& edge, float s) const;

  const Panel& panel_;
  const Camera& camera_;
  int columns_;
  float radius_;
  std::vector<ProjectedEdge> edges_;
};

// What rays see of a panel, without the wires.
class Shading {
 public:
  Shading(const Panel& panel, const Style& style, const Camera& camera);

  Vec3f operator()(const Vec3f& ray, PixelSequence& sequence) const;

 private:
  const Body& shadow_caster() const { return panel_.shell != nullptr ? *panel_.shell : *panel_.opaque; }
  Vec3f over_shell(const Vec3f& ray, float end, const Vec3f& behind) const;
  Vec3f surface(const Vec3f& ray, const Hit& hit, PixelSequence& sequence) const;
  Vec3f floor(const Vec3f& ray, PixelSequence& sequence) const;
  float key_light(const Body& body, const Vec3f& point, PixelSequence& sequence) const;

  const Panel& panel_;
  const Style& style_;
  const Camera& camera_;
  Vec3f key_, fill_, rim_;  // directions to the lights
  float floor_ = 0;         // height of the ground
};

}  // namespace prcage::raycast
