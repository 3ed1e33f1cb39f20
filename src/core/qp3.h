// The small quadratic programme behind every placement: minimise a positive definite quadratic form in three
// unknowns subject to linear inequalities (paper sec. 3.2, "QP Solver").
//
// Dual active-set method (Goldfarb and Idnani 1983) in whitened coordinates: a Cholesky factor of the form turns the
// problem into projecting the origin onto an intersection of half-spaces, where at most three constraints are active.
// qp3_batch.h solves many problems at once, to the same bits.
#pragma once

#include "core/qp3_problem.h"
#include "core/vec3.h"

namespace prcage {

// Symmetric 3 by 3 matrix: xx, xy, xz, yy, yz, zz.
struct Symmetric3 {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  double trace() const { return xx + yy + zz; }
  Vec3 operator*(const Vec3& v) const {
    return {xx * v.x() + xy * v.y() + xz * v.z(), xy * v.x() + yy * v.y() + yz * v.z(),
            xz * v.x() + yz * v.y() + zz * v.z()};
  }
  // this += w n n^T
  void add_outer(const Vec3& n, double w) {
    xx += w * n.x() * n.x();
    xy += w * n.x() * n.y();
    xz += w * n.x() * n.z();
    yy += w * n.y() * n.y();
    yz += w * n.y() * n.z();
    zz += w * n.z() * n.z();
  }
};

// Minimises 1/2 x^T G x + g . x subject to the planes; G positive definite. A plane may be violated by up to
// `tolerance`, not negative, in the units of the offsets. Writes x if solved. Deterministic, no allocation,
// thread-safe.
QpStatus solve_qp3(const Symmetric3& G, const Vec3& g, const PlaneArrays& planes, double tolerance, Vec3& x);
QpStatus solve_qp3(const Symmetric3& G, const Vec3& g, const SlabRows& slabs, double tolerance, Vec3& x);

}  // namespace prcage
