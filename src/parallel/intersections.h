// All places where surfaces touch that they must not: improper contacts inside one surface, and contacts between two.
// Boxes find the candidates, floating point answers nearly all of them, exact predicates the rest.
// Everything here must be called inside an Arena; results do not depend on the number of threads.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/triangle_pair.h"
#include "core/vec3.h"
#include "parallel/pair_collector.h"
#include "parallel/surface_tree.h"

namespace prcage {

// Per vertex of a closed oriented manifold: is no pair of its faces in improper contact for certain (core/star.h)?
// twin[h] is the opposite of halfedge h.
std::vector<std::uint8_t> embedded_stars(std::span<const Position> positions, std::span<const Triangle> triangles,
                                         std::span<const std::uint32_t> twin);

// Pairs i < j of faces of the surface in improper_contact(). Degenerate faces must have been left out. `embedded` may
// be what embedded_stars() found: it changes no result, but spares the tests of most pairs, which are of neighbours.
FacePairs self_intersections(const SurfaceTree& surface, std::size_t limit = no_limit,
                             std::span<const std::uint8_t> embedded = {});

// The same for the pairs of which at least one face is in `changed`, a tree over a selection of the same surface's
// faces.
FacePairs self_intersections(const SurfaceTree& surface, const SurfaceTree& changed,
                             std::span<const std::uint8_t> is_changed, std::size_t limit = no_limit);

// Do the two closed triangles touch? They have no vertices in common; degenerate ones are the segment or point that
// they are. Exact.
bool touch(const double* const s[3], const double* const t[3]);

// Pairs (face of a, face of b) that touch. The two surfaces have no vertices in common; degenerate faces count as the
// segment or point that they are.
FacePairs contacts(const SurfaceTree& a, const SurfaceTree& b, std::size_t limit = no_limit);

}  // namespace prcage
