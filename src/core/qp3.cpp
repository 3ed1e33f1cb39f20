#include "core/qp3.h"

#include "core/qp3_kernel.h"

namespace prcage {

QpStatus solve_qp3(const Symmetric3& G, const Vec3& g, const PlaneArrays& planes, double tolerance, Vec3& x) {
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
      active.entering = factor.forward({planes.nx[worst.plane], planes.ny[worst.plane], planes.nz[worst.plane]});
      active.entering_multiplier = 0;
      active.slack = worst.slack;
    }
    if (steps == max_steps) return QpStatus::not_converged;
    const StepResult<double> result = step(active);
    if (result.infeasible) return QpStatus::infeasible;
    entered = result.entered;
  }
}

}  // namespace prcage
