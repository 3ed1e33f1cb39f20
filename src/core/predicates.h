// Exact geometric predicates on doubles: the only functions of the project that decide validity.
//
// They wrap CGAL's EPICK kernel (filtered, exact on failure). The implementation is the one translation unit
// that sees CGAL and is compiled with -frounding-math. All are pure and thread-safe. Denormals must not be
// flushed on the calling thread (MXCSR FTZ/DAZ clear); debug builds assert it.
// A point is a pointer to three finite doubles.
#pragma once

#include <cstddef>

namespace prcage::exact {

// Sign of det(b-a, c-a, d-a): +1 if d lies on the side from which a, b, c appear counterclockwise, i.e. on the
// side that the normal (b-a)x(c-a) points to; 0 coplanar; -1 on the other side.
int orient3d(const double* a, const double* b, const double* c, const double* d);

// Are the three points on one line (or equal)?
bool collinear(const double* a, const double* b, const double* c);

// For coplanar p, q, r, s with p, q, r not collinear: +1 if s is on the same side of line pq as r, 0 on the
// line, -1 on the other side.
int coplanar_side(const double* p, const double* q, const double* r, const double* s);

// Do the closed triangles have a common point? Degenerate triangles are treated as the segment or the point
// that they are.
bool triangles_intersect(const double* a0, const double* a1, const double* a2, const double* b0, const double* b1,
                         const double* b2);

// Does the closed segment pq have a common point with the closed triangle? Both may be degenerate.
bool segment_triangle_intersect(const double* p, const double* q, const double* a, const double* b, const double* c);

// Sign of the sum over faces of det(a, b, c): six times the signed volume enclosed by a closed surface. corners
// holds three point pointers a face.
int volume_sign(const double* const* corners, std::size_t face_count);

// The unit vector along (b-a)x(c-a), rounded from its exact value however thin the triangle is; 0, 0, 0 if the points
// are collinear.
void unit_normal(const double* a, const double* b, const double* c, double* normal);

}  // namespace prcage::exact
