// The planes and the quadric of stars of edges, once for all: V is a double, or a vector of doubles with a face in each
// lane.
//
// Every operation acts on each lane alone, and the quadric is summed as if vectors had eight lanes, whatever they have:
// the results are the same bits, whichever V computes them.
//
// For the sources named star_planes*.cpp only, for the reasons that qp3_kernel.h names. The triples are those of the
// solver.
#pragma once

#include "core/star_planes_problem.h"
#include "core/vector_access.h"

namespace prcage {
namespace {

template <class V>
inline Triple<V> load3(const double* const from[3], std::size_t i) {
  return {Access<V>::load(from[0] + i), Access<V>::load(from[1] + i), Access<V>::load(from[2] + i)};
}

// Faces of a star in the local frame of its edge. All zero but the bounds for those without a reliable normal, whose
// planes 0 . x >= -1 hold everywhere; so are the last ones, which die, but for the slab.
template <class V>
struct LocalFaces {
  Triple<V> normal;
  V height;  // normal . centroid
  V area;
  V lower, upper;    // lower <= normal . x <= upper
  Triple<V> inward;  // from the edge of the link, in the plane of the face
  V inward_offset;   // of the bound of the height over that edge
};

// A star with its frame in all lanes.
template <class V>
class Star {
 public:
  Star(const StarArrays& arrays, const StarFrame& frame)
      : arrays_(arrays),
        frame_(frame),
        inverse_(1 / frame.scale),
        origin_(broadcast<V>(frame.origin)),
        tail_(local(broadcast<V>(frame.tail))),
        head_(local(broadcast<V>(frame.head))),
        margin_(arrays.margin + arrays.absolute_margin / frame.scale) {}

  // The faces from number k on.
  LocalFaces<V> faces_from(std::size_t k) const {
    const V zero(0.0), one(1.0), free(-1.0);
    const V number = Access<V>::lane_numbers() + V(static_cast<double>(k));
    const std::size_t i = frame_.first_corner + k;
    const Triple<V> moving = select<V>(number < V(static_cast<double>(frame_.tail_faces)), tail_, head_);
    const Triple<V> v1 = local(load3<V>(arrays_.corner, i));
    const Triple<V> v2 = local(load3<V>(arrays_.corner, i + 1));
    const Triple<V> to_v1 = v1 - moving;
    const Triple<V> to_v2 = v2 - moving;
    const Triple<V> outer = v2 - v1;
    const Triple<V> doubled = cross(to_v1, to_v2);
    const V size = sqrt(dot(doubled, doubled));  // twice the area
    const V outer_square = dot(outer, outer);
    const V outer_length = sqrt(outer_square);
    const V longest = larger(larger(dot(to_v1, to_v1), dot(to_v2, to_v2)), outer_square);
    const Mask<V> reliable = (size > V(1e-9) * longest) & (number < V(static_cast<double>(frame_.faces)));
    const Mask<V> survives = reliable & (number < V(static_cast<double>(frame_.faces) - 2));
    const Triple<V> none{zero, zero, zero};

    // One division for the two unit vectors.
    const V reciprocal = one / (size * outer_length);
    LocalFaces<V> faces;
    faces.normal = select<V>(reliable, times(outer_length * reciprocal, doubled), none);
    faces.inward = select<V>(survives, times(reciprocal, cross(doubled, outer)), none);
    faces.area = select(reliable, V(0.5) * size, zero);
    faces.height = select(reliable, dot(faces.normal, moving + v1 + v2) * V(1.0 / 3), zero);
    const V outer_height = size * size * reciprocal;
    faces.inward_offset = select(survives, dot(faces.inward, v1) + V(arrays_.height_fraction) * outer_height, free);
    const V lower = faces.height + Access<V>::load(arrays_.lower + i) * inverse_ + margin_;
    const V upper = faces.height + Access<V>::load(arrays_.upper + i) * inverse_;
    faces.lower = select(reliable, lower, free);
    faces.upper = select(reliable, upper, one);
    return faces;
  }

  // What lies beyond the last face is stored, too: see make_star().
  void store_planes(std::size_t k, const LocalFaces<V>& faces) const {
    const std::size_t length = row_length(frame_.faces);
    double* const to = arrays_.rows + frame_.first_row + k;
    store3(faces.normal, to + slab_normal * length, length);
    Access<V>::store(faces.lower, to + slab_lower * length);
    Access<V>::store(faces.upper, to + slab_upper * length);
    store3(faces.inward, to + slab_inward * length, length);
    Access<V>::store(faces.inward_offset, to + slab_inward_offset * length);
  }

 private:
  static V larger(const V& a, const V& b) { return select(a < b, b, a); }

  Triple<V> local(const Triple<V>& p) const { return times(inverse_, p - origin_); }

  static void store3(const Triple<V>& v, double* to, std::size_t length) {
    Access<V>::store(v.x, to);
    Access<V>::store(v.y, to + length);
    Access<V>::store(v.z, to + 2 * length);
  }

  const StarArrays& arrays_;
  const StarFrame& frame_;
  V inverse_;
  Triple<V> origin_;
  Triple<V> tail_, head_;
  V margin_;
};

// The numbers of a quadric: the form, the linear part, the constant.
constexpr std::size_t quadric_size = 10;

template <class V>
inline void add_quadric(const LocalFaces<V>& faces, V sum[quadric_size]) {
  const Triple<V>& n = faces.normal;
  const Triple<V> weighted = times(faces.area, n);
  sum[0] = sum[0] + weighted.x * n.x;
  sum[1] = sum[1] + weighted.x * n.y;
  sum[2] = sum[2] + weighted.x * n.z;
  sum[3] = sum[3] + weighted.y * n.y;
  sum[4] = sum[4] + weighted.y * n.z;
  sum[5] = sum[5] + weighted.z * n.z;
  sum[6] = sum[6] - weighted.x * faces.height;
  sum[7] = sum[7] - weighted.y * faces.height;
  sum[8] = sum[8] - weighted.z * faces.height;
  sum[9] = sum[9] + V(0.5) * faces.area * faces.height * faces.height;
}

// The sums of the faces with numbers 0, 1, ... 7 modulo 8.
constexpr std::size_t partial_sums = 8;

inline void store_quadric(const double partial[quadric_size][partial_sums], const StarArrays& arrays, std::size_t i) {
  double sum[quadric_size];
  for (std::size_t q = 0; q < quadric_size; ++q) {
    const double* p = partial[q];
    sum[q] = ((p[0] + p[4]) + (p[2] + p[6])) + ((p[1] + p[5]) + (p[3] + p[7]));
  }
  for (std::size_t q = 0; q < 6; ++q) arrays.form[6 * i + q] = sum[q];
  for (std::size_t q = 0; q < 3; ++q) arrays.linear[3 * i + q] = sum[6 + q];
  arrays.constant[i] = sum[9];
}

// Rows are filled up: the faces beyond the last one constrain nothing, and add nothing. Vectors are stored whole, from
// the last to the first: what one writes beyond its row is overwritten by the first vector of the next row, or of the
// next star.
template <class V>
inline void make_star(const StarArrays& arrays, std::size_t i) {
  constexpr std::size_t width = Access<V>::width;
  const StarFrame& frame = arrays.frame[i];
  const Star<V> star(arrays, frame);
  alignas(64) double partial[quadric_size][partial_sums];
  const std::size_t length = row_length(frame.faces);
  const std::size_t rounds = (length + partial_sums - 1) / partial_sums;
  for (std::size_t part = partial_sums; part != 0;) {
    part -= width;
    V sum[quadric_size];
    for (V& s : sum) s = V(0.0);
    for (std::size_t round = rounds; round-- != 0;) {
      const std::size_t k = round * partial_sums + part;
      if (k >= length) continue;
      const LocalFaces<V> faces = star.faces_from(k);
      star.store_planes(k, faces);
      add_quadric(faces, sum);
    }
    for (std::size_t q = 0; q < quadric_size; ++q) Access<V>::store(sum[q], &partial[q][part]);
  }
  store_quadric(partial, arrays, i);
}

template <class V>
inline void make_stars(const StarArrays& arrays) {
  for (std::size_t i = 0; i < arrays.count; ++i) make_star<V>(arrays, i);
}

}  // namespace
}  // namespace prcage
