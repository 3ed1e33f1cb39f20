#include "core/qp3.h"

#include <cassert>
#include <cmath>
#include <limits>

namespace prcage {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Lower Cholesky factor L of G = L L^T.
struct Cholesky3 {
  double l00, l10, l11, l20, l21, l22;

  explicit Cholesky3(const Symmetric3& G) {
    l00 = std::sqrt(G.xx);
    l10 = G.xy / l00;
    l20 = G.xz / l00;
    l11 = std::sqrt(G.yy - l10 * l10);
    l21 = (G.yz - l20 * l10) / l11;
    l22 = std::sqrt(G.zz - l20 * l20 - l21 * l21);
  }
  bool positive() const { return l00 > 0 && l11 > 0 && l22 > 0; }

  // L^-1 v
  Vec3 forward(const Vec3& v) const {
    const double y0 = v.x() / l00;
    const double y1 = (v.y() - l10 * y0) / l11;
    const double y2 = (v.z() - l20 * y0 - l21 * y1) / l22;
    return {y0, y1, y2};
  }
  // L^-T v
  Vec3 backward(const Vec3& v) const {
    const double x2 = v.z() / l22;
    const double x1 = (v.y() - l21 * x2) / l11;
    const double x0 = (v.x() - l10 * x1 - l20 * x2) / l00;
    return {x0, x1, x2};
  }
};

// At most three linearly independent active normals with their multipliers.
class ActiveSet {
 public:
  int size() const {
    assert(size_ >= 0 && size_ <= 3);
    return size_;
  }

  // Coefficients r with a ~ sum r_j n_j in the least-squares sense, and the remainder z orthogonal to all n_j.
  Vec3 decompose(const Vec3& a, double r[3]) const {
    if (size_ == 0) return a;
    if (size_ == 1) {
      r[0] = n_[0].dot(a) / n_[0].squaredNorm();
      return a - r[0] * n_[0];
    }
    if (size_ == 2) {
      const double aa = n_[0].squaredNorm(), ab = n_[0].dot(n_[1]), bb = n_[1].squaredNorm();
      const double pa = n_[0].dot(a), pb = n_[1].dot(a);
      const double det = aa * bb - ab * ab;
      r[0] = (pa * bb - pb * ab) / det;
      r[1] = (pb * aa - pa * ab) / det;
      const Vec3 across = n_[0].cross(n_[1]);
      return (a.dot(across) / across.squaredNorm()) * across;
    }
    const Vec3 c12 = n_[1].cross(n_[2]), c20 = n_[2].cross(n_[0]), c01 = n_[0].cross(n_[1]);
    const double det = n_[0].dot(c12);
    r[0] = a.dot(c12) / det;
    r[1] = a.dot(c20) / det;
    r[2] = a.dot(c01) / det;
    return Vec3::Zero();
  }

  double multiplier(int j) const { return u_[j]; }
  void step(double t, const double r[3]) {
    for (int j = 0; j < size_; ++j) u_[j] -= t * r[j];
  }
  void add(const Vec3& n, double u) {
    n_[size_] = n;
    u_[size_] = u;
    ++size_;
  }
  void drop(int k) {
    for (int j = k; j + 1 < size_; ++j) {
      n_[j] = n_[j + 1];
      u_[j] = u_[j + 1];
    }
    --size_;
  }

 private:
  Vec3 n_[3];
  double u_[3] = {0, 0, 0};
  int size_ = 0;
};

// Makes constraint n . y >= b with present slack s < 0 active: moves y along the boundary of the active set, dropping
// constraints whose multiplier reaches zero.
QpStatus activate(const Vec3& n, double s, ActiveSet& active, Vec3& y) {
  double u = 0;
  for (int guard = 0; guard < 20; ++guard) {
    double r[3] = {0, 0, 0};
    const Vec3 z = active.decompose(n, r);
    const double zz = active.size() < 3 ? z.dot(n) : 0.0;
    const double full_step = zz > 1e-12 * n.squaredNorm() ? -s / zz : infinity;
    double partial_step = infinity;
    int blocking = -1;
    for (int j = 0; j < active.size(); ++j) {
      if (r[j] > 1e-14 && active.multiplier(j) / r[j] < partial_step) {
        partial_step = active.multiplier(j) / r[j];
        blocking = j;
      }
    }
    const double t = std::min(full_step, partial_step);
    if (t == infinity) return QpStatus::infeasible;
    active.step(t, r);
    u += t;
    if (full_step < infinity) {
      y += t * z;
      s += t * zz;
    }
    if (full_step <= partial_step) {
      active.add(n, u);
      return QpStatus::solved;
    }
    active.drop(blocking);
  }
  return QpStatus::not_converged;
}

}  // namespace

QpStatus solve_qp3(const Symmetric3& G, const Vec3& g, const PlaneArrays& planes, double tolerance, Vec3& x) {
  const Cholesky3 factor(G);
  if (!factor.positive()) return QpStatus::not_converged;
  Vec3 y = -factor.forward(g);
  ActiveSet active;
  for (int iteration = 0; iteration < 64; ++iteration) {
    x = factor.backward(y);
    double worst = -tolerance;
    std::size_t violated = planes.count;
    for (std::size_t i = 0; i < planes.count; ++i) {
      const double slack = planes.nx[i] * x.x() + planes.ny[i] * x.y() + planes.nz[i] * x.z() - planes.offset[i];
      if (slack < worst) {
        worst = slack;
        violated = i;
      }
    }
    if (violated == planes.count) return QpStatus::solved;
    const Vec3 n = factor.forward({planes.nx[violated], planes.ny[violated], planes.nz[violated]});
    const QpStatus status = activate(n, worst, active, y);
    if (status != QpStatus::solved) return status;
  }
  return QpStatus::not_converged;
}

}  // namespace prcage
