// How far a patch is from the faces that it replaces: two discs that project one to one, along a direction n, onto the
// same polygon (condition 1 in core/projection.h). Each is the graph of a piecewise linear function over the polygon,
// so their difference is largest at a vertex of the overlay of the two triangulations: at an inner vertex of one, or
// where inner edges cross. That difference is a distance along n: every point of one disc is no farther than it from
// the other disc. So what is known of the old faces' distance from anything carries over to the new ones.
#pragma once

#include <array>
#include <cstddef>

#include "core/vec3.h"

namespace prcage {

// Coordinates of points across n, and their height along it.
class ViewAlong {
 public:
  ViewAlong(const Vec3& n, const double* origin);

  Vec3 operator()(const double* p) const {
    const Vec3 d(p[0] - origin_[0], p[1] - origin_[1], p[2] - origin_[2]);
    return {across_[0].dot(d), across_[1].dot(d), n_.dot(d)};
  }

 private:
  Vec3 n_;
  std::array<Vec3, 2> across_;
  const double* origin_;
};

// One of the two discs as seen along n. Holds a limited number of elements and says when they were too many.
class GraphDisc {
 public:
  void add_face(const Vec3& a, const Vec3& b, const Vec3& c) { faces_.add({a, b, c}); }
  void add_inner_edge(const Vec3& a, const Vec3& b);
  void add_inner_vertex(const Vec3& p) { vertices_.add(p); }

  // An upper bound of the distance along n between two discs over the same polygon; infinity if there are too many
  // elements, or where triangles are so narrow, as seen along n, or edges lie so close to each other that rounding
  // might matter.
  friend double largest_gap(const GraphDisc& s, const GraphDisc& t);

 private:
  struct Edge {
    std::array<Vec3, 2> end;
    std::array<double, 2> low, high;  // box across n, a little larger than the edge
  };
  template <class T, std::size_t capacity>
  struct Few {
    std::array<T, capacity> item;
    std::size_t count = 0;
    void add(const T& value) {
      if (count < capacity) item[count] = value;
      ++count;
    }
    bool overflown() const { return count > capacity; }
    const T* begin() const { return item.data(); }
    const T* end() const { return item.data() + count; }
  };
  static constexpr std::size_t most = 32;

  bool overflown() const { return faces_.overflown() || edges_.overflown() || vertices_.overflown(); }
  double gap_at(const Vec3& p) const;
  double gap_at_crossings(const GraphDisc& other) const;
  double rounding_of_heights() const;

  Few<std::array<Vec3, 3>, most> faces_;
  Few<Edge, most> edges_;
  Few<Vec3, 2> vertices_;
};

double largest_gap(const GraphDisc& s, const GraphDisc& t);

}  // namespace prcage
