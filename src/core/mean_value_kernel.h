// Mean value coordinates, once for all: V is a double, or a vector of doubles with a point in each lane.
//
// Seen from a point x, a face of the cage is a spherical triangle; let m be the integral of the unit vector over it.
// The face passes m on to its corners a, b, c as weights with w_a (a - x) + w_b (b - x) + w_c (c - x) = m. Since the
// vectors m of a closed surface add up to zero, x is the mean of the vertices under the sums of these weights.
//
// With the unit vectors u to the corners and n_a = u_b x u_c,
//   m = 1/2 sum of (theta / sin theta) n   over the three sides, theta being the angle that a side subtends,
//   w_a = n_a . m / (det |a - x|)          with det = u_a . n_a.
// The factor theta / sin theta belongs to an edge, not to a face: it is computed once for the two faces, whose sides
// then cancel to the last bit. This and the solution for w by the very n that m is made of are what keeps the mean
// equal to x near faces and edges, although the single weights lose digits there.
//
// theta / sin theta is a polynomial in sin^2(theta / 2), so that an edge needs neither a root nor a division, unless it
// subtends more than 60 degrees; the angle is then halved twice first.
//
// Every operation acts on each lane alone and rounds as IEEE 754 says: a point has the same weights, bit for bit,
// whichever V computes them. What only some lanes need is skipped if no lane needs it.
//
// For the sources named mean_value*.cpp only, for the reasons that qp3_kernel.h names.
#pragma once

#include "core/mean_value_problem.h"
#include "core/vector_access.h"

namespace prcage {
namespace {

inline double abs(double x) { return __builtin_fabs(x); }

// A point is at a vertex of the cage if it is nearer than this, on an edge if the cosine of half the angle that the
// edge subtends is less. Nearer than that no weight can be told from those there.
constexpr double square_at_vertex = 1e-200;
constexpr double cosine_on_edge = 1e-12;

// A spherical triangle is flat if the sines of its three angles are less than this bound: the point is nearly in the
// plane of the face. If it is not over the face as well, the face has next to nothing to pass on, and is left out. So
// is a slender triangle, whose determinant and mean are less than the bound, and four times the bound, times the square
// of its longest side: the point is nearly in line with an edge. To pass on what little there is would be to pass on
// noise as well, of the size of the rounding error divided by the bound: the bound makes the two errors equal. The mean
// is restored afterwards, see complete().
constexpr double small_sine = 1e-8;

// Over the face, where the weights are large and sound, points get barycentric coordinates only if the sines are less
// than this.
constexpr double sine_on_face = 1e-12;

// The form of complete() is taken for singular if its determinant is less than this times the cube of its trace. Where
// that happens near the cage, the weights are so large that what was left out does not matter.
constexpr double singular_form = 1e-9;

// ------------------------------------------------------------------------------------------------- scratch

// What is known of the cage as seen from the points: rows of as many numbers as V has lanes.
template <class V>
class View {
 public:
  View(const MeanValueCage& cage, double* scratch)
      : unit_(scratch),
        inverse_(unit_ + 3 * width * cage.vertices),
        weight_(inverse_ + width * cage.vertices),
        factor_(weight_ + width * cage.vertices) {}

  // Direction of a vertex, and the reciprocal of its distance.
  Triple<V> unit(std::size_t v) const {
    const double* u = unit_ + 3 * width * v;
    return {Access<V>::load(u), Access<V>::load(u + width), Access<V>::load(u + 2 * width)};
  }
  void set_unit(std::size_t v, const Triple<V>& unit) {
    double* u = unit_ + 3 * width * v;
    Access<V>::store(unit.x, u);
    Access<V>::store(unit.y, u + width);
    Access<V>::store(unit.z, u + 2 * width);
  }
  V inverse(std::size_t v) const { return Access<V>::load(inverse_ + width * v); }
  void set_inverse(std::size_t v, const V& inverse) { Access<V>::store(inverse, inverse_ + width * v); }

  // Weight of a vertex, times its distance until the end.
  V weight(std::size_t v) const { return Access<V>::load(weight_ + width * v); }
  void set_weight(std::size_t v, const V& weight) { Access<V>::store(weight, weight_ + width * v); }
  void add_weight(std::size_t v, const V& weight) { set_weight(v, this->weight(v) + weight); }

  // theta / sin theta of an edge.
  V factor(std::size_t e) const { return Access<V>::load(factor_ + width * e); }
  void set_factor(std::size_t e, const V& factor) { Access<V>::store(factor, factor_ + width * e); }

 private:
  static constexpr std::size_t width = Access<V>::width;

  double* unit_;
  double* inverse_;
  double* weight_;
  double* factor_;
};

// The element of the cage that each point lies on: its number, or -1. Their weights are not those of the formula, which
// divides by zero there.
template <class V>
struct Contact {
  V vertex = V(-1.0);
  V edge = V(-1.0);
  V face = V(-1.0);
  V left_out = V(-1.0);  // the last face that was left out
};

template <class V>
inline void note(const Mask<V>& where, std::size_t number, V& element) {
  element = select(where, V(static_cast<double>(number)), element);
}

// ------------------------------------------------------------------------------------------------ vertices

template <class V>
inline void view_vertices(const MeanValueCage& cage, const Triple<V>& x, View<V>& view, Contact<V>& contact) {
  for (std::size_t v = 0; v < cage.vertices; ++v) {
    const Triple<V> to = broadcast<V>(cage.position + 3 * v) - x;
    const V square = dot(to, to);
    const V inverse = V(1.0) / sqrt(square);
    view.set_unit(v, times(inverse, to));
    view.set_inverse(v, inverse);
    view.set_weight(v, V(0.0));
    const Mask<V> here = square < V(square_at_vertex);
    if (any(here)) note(here, v, contact.vertex);
  }
}

// --------------------------------------------------------------------------------------------------- edges

constexpr double widest_square = 0.25;  // sin^2 of half of 60 degrees

// theta / sin theta for s = sin^2(theta / 2) up to widest_square, relative error 2e-16: interpolated at the Chebyshev
// nodes, the constant term exact. Two chains, of the even and of the odd powers, halve the wait for the result.
template <class V>
inline V angle_over_sine(const V& s) {
  constexpr double even[] = {1,
                             0.5333333333325431,
                             0.4063491909306382,
                             0.34097363364319966,
                             0.29589314020010576,
                             0.12379275849012099,
                             -0.8033777372009793};
  constexpr double odd[] = {0.6666666666666673, 0.4571428573192472, 0.3694090671148258, 0.3185797065635861,
                            0.3118828563914496, 0.7601380624559784, 1.3589244503068343};
  const V square = s * s;
  V even_part(even[6]);
  V odd_part(odd[6]);
  for (int k = 6; k-- > 0;) {
    even_part = even_part * square + V(even[k]);
    odd_part = odd_part * square + V(odd[k]);
  }
  return even_part + s * odd_part;
}

// Of an edge between the directions b and c that subtends more than 60 degrees: replaces s by sin^2(theta / 8) and
// returns what the result is to be multiplied with. Where the edge passes through the point, that is infinite.
template <class V>
inline V halve_twice(const Triple<V>& b, const Triple<V>& c, const Mask<V>& wide, V& s, V& cosine) {
  const V half(0.5), one(1.0);
  const Triple<V> sum = b + c;
  cosine = half * sqrt(dot(sum, sum));                  // of theta / 2; keeps its digits where b = -c
  const V cosine_quarter = sqrt(half + half * cosine);  // of theta / 4
  s = select(wide, half - half * cosine_quarter, s);
  return select(wide, one / (cosine * cosine_quarter), one);
}

template <class V>
inline void view_edges(const MeanValueCage& cage, View<V>& view, Contact<V>& contact) {
  const V half(0.5);
  for (std::size_t e = 0; e < cage.edges; ++e) {
    const Triple<V> b = view.unit(cage.edge[2 * e]);
    const Triple<V> c = view.unit(cage.edge[2 * e + 1]);
    V s = half - half * dot(b, c);
    const Mask<V> wide = s > V(widest_square);
    if (!any(wide)) {
      view.set_factor(e, angle_over_sine(s));
      continue;
    }
    V cosine;
    const V scale = halve_twice(b, c, wide, s, cosine);
    view.set_factor(e, scale * angle_over_sine(s));
    const Mask<V> here = wide & (cosine < V(cosine_on_edge));
    if (any(here)) note(here, e, contact.edge);
  }
}

// --------------------------------------------------------------------------------------------------- faces

// A face seen from the points.
template <class V>
struct SeenFace {
  Triple<V> normal[3];  // of the side opposite to each corner, as long as the sine of its angle
  Triple<V> mean;       // 2 m
  V det;
};

template <class V>
inline SeenFace<V> see_face(const MeanValueCage& cage, const View<V>& view, std::size_t f) {
  const std::uint32_t* corner = cage.corner + 3 * f;
  const std::uint32_t* opposite = cage.opposite + 3 * f;
  const Triple<V> a = view.unit(corner[0]);
  const Triple<V> b = view.unit(corner[1]);
  const Triple<V> c = view.unit(corner[2]);
  SeenFace<V> face;
  face.normal[0] = cross(b, c);
  face.normal[1] = cross(c, a);
  face.normal[2] = cross(a, b);
  face.mean = times(view.factor(opposite[0]), face.normal[0]) + times(view.factor(opposite[1]), face.normal[1]) +
              times(view.factor(opposite[2]), face.normal[2]);
  face.det = dot(a, face.normal[0]);
  return face;
}

template <class V>
inline V larger(const V& a, const V& b) {
  return select(a < b, b, a);
}

// Are the sines of the three angles less than the bound? Their numerator is the determinant.
template <class V>
inline Mask<V> sines_below(double bound, const V& det_square, const V square[3]) {
  const V b(bound * bound);
  return (det_square <= b * square[0] * square[1]) & (det_square <= b * square[1] * square[2]) &
         (det_square <= b * square[2] * square[0]);
}

// The reciprocal of the determinant, zero where the face is left out.
template <class V>
inline V careful_reciprocal(const SeenFace<V>& face, std::size_t number, Contact<V>& contact) {
  V square[3];
  for (std::size_t i = 0; i < 3; ++i) square[i] = dot(face.normal[i], face.normal[i]);
  const V det = face.det * face.det;
  const V mean = dot(face.mean, face.mean);
  const Mask<V> over = mean > V(1.0);  // of a flat triangle: a half sphere, or nothing
  const Mask<V> on_face = over & sines_below(sine_on_face, det, square);
  if (any(on_face)) note(on_face, number, contact.face);
  const V longest = larger(larger(square[0], square[1]), square[2]);
  const V slender = V(small_sine * small_sine) * longest * longest;
  const Mask<V> out =
      (sines_below(small_sine, det, square) & (mean <= V(1.0))) | ((det <= slender) & (mean <= V(16.0) * slender));
  note(out, number, contact.left_out);
  return select(out, V(0.0), V(1.0) / face.det);
}

template <class V>
inline void add_faces(const MeanValueCage& cage, View<V>& view, Contact<V>& contact) {
  const V bound(small_sine);
  for (std::size_t f = 0; f < cage.faces; ++f) {
    const SeenFace<V> face = see_face(cage, view, f);
    // Sines are at most 1: without a small determinant no triangle is flat.
    const V reciprocal = any(abs(face.det) <= bound) ? careful_reciprocal(face, f, contact) : V(1.0) / face.det;
    const Triple<V> mean = times(reciprocal, face.mean);
    for (std::size_t i = 0; i < 3; ++i) view.add_weight(cage.corner[3 * f + i], dot(face.normal[i], mean));
  }
}

// ------------------------------------------------------------------------------------------- completion

// Symmetric 3 by 3 matrix.
template <class V>
struct Form {
  V xx, xy, xz, yy, yz, zz;
};

// The solution of form x = right, zero where the form is nearly singular.
template <class V>
inline Triple<V> solve(const Form<V>& form, const Triple<V>& right) {
  const auto& [xx, xy, xz, yy, yz, zz] = form;
  const Form<V> cofactor{yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy,
                         xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy};
  const V det = xx * cofactor.xx + xy * cofactor.xy + xz * cofactor.xz;
  const V trace = xx + yy + zz;
  const V reciprocal = select(det > V(singular_form) * trace * trace * trace, V(1.0) / det, V(0.0));
  return times(reciprocal, Triple<V>{cofactor.xx * right.x + cofactor.xy * right.y + cofactor.xz * right.z,
                                     cofactor.xy * right.x + cofactor.yy * right.y + cofactor.yz * right.z,
                                     cofactor.xz * right.x + cofactor.yz * right.y + cofactor.zz * right.z});
}

// Where faces were left out, the weighted directions do not add up to zero. Changes each weight in proportion to its
// magnitude and to the component of its direction along one vector, which is chosen so that they do.
template <class V>
inline void complete(const MeanValueCage& cage, View<V>& view, const Contact<V>& contact) {
  const V zero(0.0);
  const Mask<V> where = contact.left_out >= zero;
  if (!any(where)) return;
  Triple<V> sum{zero, zero, zero};
  Form<V> form{zero, zero, zero, zero, zero, zero};
  for (std::size_t v = 0; v < cage.vertices; ++v) {
    const Triple<V> u = view.unit(v);
    sum = sum + times(view.weight(v), u);
    const Triple<V> size = times(abs(view.weight(v)), u);
    form.xx = form.xx + size.x * u.x;
    form.xy = form.xy + size.x * u.y;
    form.xz = form.xz + size.x * u.z;
    form.yy = form.yy + size.y * u.y;
    form.yz = form.yz + size.y * u.z;
    form.zz = form.zz + size.z * u.z;
  }
  const Triple<V> change = select<V>(where, solve(form, sum), {zero, zero, zero});
  for (std::size_t v = 0; v < cage.vertices; ++v) {
    const V weight = view.weight(v);
    view.set_weight(v, weight - abs(weight) * dot(change, view.unit(v)));
  }
}

// ------------------------------------------------------------------------------------- points on the cage

inline Triple<double> vertex(const MeanValueCage& cage, std::uint32_t v) {
  return broadcast<double>(cage.position + 3 * v);
}

struct Row {
  double* weights;
  const std::uint32_t* column;

  double& operator[](std::size_t v) const { return weights[column[v]]; }
};

inline void set_on_edge(const MeanValueCage& cage, std::size_t e, const Triple<double>& x, const Row& row) {
  const std::uint32_t* end = cage.edge + 2 * e;
  const Triple<double> tail = vertex(cage, end[0]);
  const Triple<double> along = vertex(cage, end[1]) - tail;
  const double share = dot(x - tail, along) / dot(along, along);
  row[end[0]] = 1 - share;
  row[end[1]] = share;
}

inline void set_on_face(const MeanValueCage& cage, std::size_t f, const Triple<double>& x, const Row& row) {
  const std::uint32_t* corner = cage.corner + 3 * f;
  const Triple<double> a = vertex(cage, corner[0]);
  const Triple<double> b = vertex(cage, corner[1]);
  const Triple<double> c = vertex(cage, corner[2]);
  const Triple<double> normal = cross(b - a, c - a);
  const double square = dot(normal, normal);
  const double share_b = dot(normal, cross(c - x, a - x)) / square;
  const double share_c = dot(normal, cross(a - x, b - x)) / square;
  row[corner[0]] = 1 - share_b - share_c;
  row[corner[1]] = share_b;
  row[corner[2]] = share_c;
}

// Replaces the row of a point that lies on the cage. One at a vertex is on edges and faces as well, as far as these
// tests can tell.
inline void set_contact(const MeanValueCage& cage, double on_vertex, double on_edge, double on_face,
                        const Triple<double>& x, const Row& row) {
  if (on_vertex < 0 && on_edge < 0 && on_face < 0) return;
  for (std::size_t v = 0; v < cage.vertices; ++v) row[v] = 0;
  if (on_vertex >= 0) {
    row[static_cast<std::size_t>(on_vertex)] = 1;
  } else if (on_edge >= 0) {
    set_on_edge(cage, static_cast<std::size_t>(on_edge), x, row);
  } else {
    set_on_face(cage, static_cast<std::size_t>(on_face), x, row);
  }
}

template <class V>
inline void set_contacts(const MeanValueArrays& arrays, std::size_t first, std::size_t lanes,
                         const Contact<V>& contact) {
  if (!any((contact.vertex >= V(0.0)) | (contact.edge >= V(0.0)) | (contact.face >= V(0.0)))) return;
  double on_vertex[most_lanes], on_edge[most_lanes], on_face[most_lanes];
  Access<V>::store(contact.vertex, on_vertex);
  Access<V>::store(contact.edge, on_edge);
  Access<V>::store(contact.face, on_face);
  for (std::size_t i = 0; i < lanes; ++i)
    set_contact(*arrays.cage, on_vertex[i], on_edge[i], on_face[i], broadcast<double>(arrays.point + 3 * (first + i)),
                {arrays.weights + (first + i) * arrays.stride, arrays.column});
}

// ------------------------------------------------------------------------------------------------- points

// The points from number `first` on, the last of them again where there are fewer than lanes.
template <class V>
inline Triple<V> gather_points(const MeanValueArrays& arrays, std::size_t first, std::size_t lanes) {
  double coordinate[3][most_lanes];
  for (std::size_t i = 0; i < Access<V>::width; ++i) {
    const double* point = arrays.point + 3 * (first + (i < lanes ? i : lanes - 1));
    for (std::size_t k = 0; k < 3; ++k) coordinate[k][i] = point[k];
  }
  return {Access<V>::load(coordinate[0]), Access<V>::load(coordinate[1]), Access<V>::load(coordinate[2])};
}

// Writes the weights with the sum 1. Nothing is near zero here: the sum of a closed cage is positive inside, and
// negative outside of it.
template <class V>
inline void store_weights(const MeanValueArrays& arrays, std::size_t first, std::size_t lanes, View<V>& view) {
  const std::size_t vertices = arrays.cage->vertices;
  V sum(0.0);
  for (std::size_t v = 0; v < vertices; ++v) {
    const V weight = view.weight(v) * view.inverse(v);
    view.set_weight(v, weight);
    sum = sum + weight;
  }
  const V reciprocal = V(1.0) / sum;
  double* const rows = arrays.weights + first * arrays.stride;
  for (std::size_t v = 0; v < vertices; ++v) {
    double weight[most_lanes];
    Access<V>::store(view.weight(v) * reciprocal, weight);
    for (std::size_t i = 0; i < lanes; ++i) rows[i * arrays.stride + arrays.column[v]] = weight[i];
  }
}

template <class V>
inline void find_mean_values_of(const MeanValueArrays& arrays) {
  constexpr std::size_t width = Access<V>::width;
  const MeanValueCage& cage = *arrays.cage;
  View<V> view(cage, arrays.scratch);
  for (std::size_t first = 0; first < arrays.count; first += width) {
    const std::size_t lanes = arrays.count - first < width ? arrays.count - first : width;
    Contact<V> contact;
    view_vertices(cage, gather_points<V>(arrays, first, lanes), view, contact);
    view_edges(cage, view, contact);
    add_faces(cage, view, contact);
    complete(cage, view, contact);
    store_weights(arrays, first, lanes, view);
    set_contacts(arrays, first, lanes, contact);
  }
}

}  // namespace
}  // namespace prcage
