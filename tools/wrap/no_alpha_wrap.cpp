// What is linked where CGAL's Alpha_wrap_3 is not to be had, or not wanted.
#include "tools/wrap/alpha_wrap.h"

namespace prcage {

bool has_alpha_wrap() { return false; }

Wrap alpha_wrap(const MeshView&, const WrapSettings&, Control*) {
  Wrap wrap;
  wrap.status = Status::invalid_options;
  wrap.message = missing_alpha_wrap;
  return wrap;
}

}  // namespace prcage
