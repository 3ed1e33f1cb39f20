// A cheap proof that a patch cannot collide with anything near it: parallel projection.
//
// Let C be a closed embedded surface with outward normals, S a disc of its faces, S' another disc with the same rim, K
// a convex set that contains both, and n a direction. If
//   1. all faces of S and of S' face n (their normals have a positive component along it), and S' winds once round its
//      inner vertex, so that both project one to one onto the same polygon P, and
//   2. every face of C that meets K faces n,
// then S' meets the rest of C only in the rim. Proof: along a line parallel to n, crossings of C go in turn out of the
// solid and into it. Inside K all of them go out, so a line has at most one there, and over P that one is in S. A face
// outside S that met S' inside the rim would be crossed by lines near by, as a second one.
//
// All answers here are certain, by error bounds on floating-point signs: "false" may mean "hard to tell".
#pragma once

#include <cmath>

#include "core/filtered_cross.h"

namespace prcage {

// Does triangle abc face n for certain? n is taken as exact.
inline bool certainly_faces(const Vec3& n, const double* a, const double* b, const double* c) {
  return FilteredCross(difference(a, b), difference(a, c)).sign_of_product(n) > 0;
}

// How often a fan of triangles that all face n winds round its centre, seen along n: the number of times that its rim
// passes from below a line through the centre to above it. Triangles may come in any order.
class Winds {
 public:
  Winds(const Vec3& n, const double* centre) : centre_(centre) {
    int k = 0;  // the axis that is most nearly orthogonal to n
    for (int i = 1; i < 3; ++i)
      if (std::abs(n[i]) < std::abs(n[k])) k = i;
    up_ = n.cross(Vec3::Unit(k));
  }
  // "Above" is where n x across points to: for an odd one, regular meshes have no vertices on a level with the centre.
  Winds(const Vec3& n, const Vec3& across, const double* centre) : centre_(centre), up_(n.cross(across)) {}

  // The rim runs from b to c here.
  void add(const double* b, const double* c) {
    const double from = height(b);
    const double to = height(c);
    if (from < 0 && to > 0) ++turns_;
  }

  bool certainly_once() const { return certain_ && turns_ == 1; }

 private:
  double height(const double* x) {
    double sum = 0, magnitude = 0;
    for (int k = 0; k < 3; ++k) {
      const double term = (x[k] - centre_[k]) * up_[k];
      sum += term;
      magnitude += std::abs(term);
    }
    if (!(std::abs(sum) > 2e-15 * magnitude)) certain_ = false;
    return sum;
  }

  const double* centre_;
  Vec3 up_;
  int turns_ = 0;
  bool certain_ = true;
};

}  // namespace prcage
