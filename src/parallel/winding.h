// Exact winding numbers of closed surfaces at points, and from them how the components of a surface are nested.
// Everything here must be called inside an Arena; results do not depend on the number of threads.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/surface.h"
#include "parallel/intersections.h"

namespace prcage {

struct Winding {
  bool known = false;  // false if the point is on the surface
  int number = 0;      // the surface's turns round the point: 1 inside an outward surface
};

// Faces that a point does not see: those of component skip[point], if `components` is there.
struct IgnoredComponents {
  const Components* components = nullptr;
  std::span<const std::uint32_t> skip;
};

// Winding numbers at many points at once. The surface must be closed and oriented: every edge has as many faces in one
// direction as in the other. Zero-area faces are allowed, and matter only to points that lie on them.
//
// Signed crossings are counted along a segment from the point to beyond the bounding box, nearly parallel to an axis,
// so that the segment's box is thin and holds few faces; all segments are joined with the tree at once. A segment
// that meets an edge or a vertex is replaced by another one.
std::vector<Winding> winding_numbers(const TreeDevice& device, const SurfaceTree& surface,
                                     std::span<const Position> points, const IgnoredComponents& ignored = {});

// How one component lies among the others.
struct Nesting {
  int sign = 0;    // of the volume that the component bounds, exact: 1 outward, -1 inward
  Winding others;  // winding number of all other components at a point of this one

  // Is the winding number 0 and 1 on its two sides, as on the boundary of a solid: an outer surface in the open, or
  // an inward one within a single outer one?
  bool bounds_solid() const { return others.known && ((sign > 0 && others.number == 0) || is_cavity()); }
  bool is_cavity() const { return others.known && sign < 0 && others.number == 1; }

  // How it would be if all faces of the surface were turned round.
  Nesting turned() const { return {-sign, {others.known, -others.number}}; }
};

// Sign of the volume that each component of a closed oriented surface bounds, exact.
std::vector<int> volume_signs(const SurfaceTree& surface, const Components& components);

// For a closed oriented surface whose components do not touch; one entry per component.
std::vector<Nesting> nesting(const TreeDevice& device, const SurfaceTree& surface, const Components& components);

// A vertex of each component.
std::vector<Position> component_points(std::span<const Position> positions, std::span<const Triangle> triangles,
                                       const Components& components);

}  // namespace prcage
