// The exact test behind "does not intersect itself": do two triangles of a surface meet outside the vertices and
// edges that they share? Floating-point separation answers the bulk, exact predicates the rest.
#pragma once

#include <cstdint>

namespace prcage {

// Corner positions and vertex numbers of a triangle. Two triangles share a vertex if the numbers are equal;
// equal positions under different numbers are contact.
struct TriangleRef {
  const double* p[3];
  std::uint32_t v[3];
};

// No common vertex: the closed triangles meet at all. One: the edge opposite to it meets the other triangle.
// Two: coplanar and on the same side of the common edge. Three: always. Exact; degenerate triangles are allowed
// where no edge is shared.
bool improper_contact(const TriangleRef& a, const TriangleRef& b);

// Is the plane of one triangle, or one through an edge and nearly orthogonal to the first, certain by floating-point
// arithmetic with an error bound to separate the two closed triangles strictly? False says nothing.
bool certainly_separated(const double* const a[3], const double* const b[3]);

}  // namespace prcage
