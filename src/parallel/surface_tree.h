// The faces of a surface, ready to be joined with those of others and to be asked for the closest one. Borrows the
// arrays: they must stay where they are, unchanged, while the tree is used. Surfaces that are compared with each other
// must be built in the same frame.
#pragma once

#include <cstdint>
#include <span>

#include "core/triangle_pair.h"
#include "core/vec3.h"
#include "parallel/box_runs.h"

namespace prcage {

class SurfaceTree {
 public:
  explicit SurfaceTree(const TreeDevice& device) : runs_(device) {}

  // `keep` selects faces: those with keep[f] == 0 are left out. Empty means all. Vertex indices must be in range and
  // coordinates finite.
  void build(const UnitFrame& frame, std::span<const Position> positions, std::span<const Triangle> triangles,
             std::span<const std::uint8_t> keep = {});

  const UnitFrame& frame() const { return frame_; }
  std::span<const Position> positions() const { return positions_; }
  std::span<const Triangle> triangles() const { return triangles_; }
  const BoxRuns& runs() const { return runs_; }

  const double* corner(std::uint32_t face, std::size_t i) const { return positions_[triangles_[face][i]].data(); }
  TriangleRef triangle(std::uint32_t face) const {
    const Triangle& t = triangles_[face];
    return {{corner(face, 0), corner(face, 1), corner(face, 2)}, {t[0], t[1], t[2]}};
  }

 private:
  UnitFrame frame_;
  std::span<const Position> positions_;
  std::span<const Triangle> triangles_;
  BoxRuns runs_;
};

}  // namespace prcage
