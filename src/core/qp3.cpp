#include "core/qp3.h"

#include "core/qp3_kernel.h"

namespace prcage {
namespace {

template <class Planes>
QpStatus solve(const Symmetric3& G, const Vec3& g, const Planes& planes, double tolerance, Vec3& x) {
  const double form[6] = {G.xx, G.xy, G.xz, G.yy, G.yz, G.zz};
  Cholesky<double> factor;
  if (!factorize(form, factor)) return QpStatus::not_converged;
  ActiveSet<double> active{};
  active.y = Triple<double>{0, 0, 0} - factor.forward({g.x(), g.y(), g.z()});
  bool entered = true;
  for (int steps = 0;; ++steps) {
    if (entered) {
      const Triple<double> p = factor.backward(active.y);
      Violation worst;
      if (!find_violation(planes, p, tolerance, worst)) {
        const QpStatus status = status_at(p);
        if (status == QpStatus::solved) x = {p.x, p.y, p.z};
        return status;
      }
      active.entering = factor.forward(normal_of(planes, worst.plane));
      active.entering_multiplier = 0;
      active.slack = worst.slack;
    }
    if (steps == max_steps) return QpStatus::not_converged;
    const StepResult<double> result = step<3>(active, true);
    if (result.infeasible) return QpStatus::infeasible;
    entered = result.entered;
  }
}

}  // namespace

QpStatus solve_qp3(const Symmetric3& G, const Vec3& g, const PlaneArrays& planes, double tolerance, Vec3& x) {
  return solve(G, g, planes, tolerance, x);
}

QpStatus solve_qp3(const Symmetric3& G, const Vec3& g, const SlabRows& slabs, double tolerance, Vec3& x) {
  return solve(G, g, slabs, tolerance, x);
}

}  // namespace prcage
