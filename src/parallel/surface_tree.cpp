#include "parallel/surface_tree.h"

#include "parallel/parallel_for.h"

namespace prcage {

void SurfaceTree::build(const UnitFrame& frame, std::span<const Position> positions,
                        std::span<const Triangle> triangles, std::span<const std::uint8_t> keep) {
  frame_ = frame;
  positions_ = positions;
  triangles_ = triangles;
  std::vector<Box> boxes(triangles.size());
  parallel_each(triangles.size(), default_grain, [&](std::size_t f) {
    const auto face = static_cast<std::uint32_t>(f);
    const bool kept = keep.empty() || keep[f] != 0;
    boxes[f] = kept ? bounding_box(frame, {corner(face, 0), corner(face, 1), corner(face, 2)}) : Box{};
  });
  runs_.build(boxes);
}

}  // namespace prcage
