#include "core/star.h"

#include "core/filtered_cross.h"

namespace prcage {
namespace {

// Sum of the faces' area vectors, up to rounding: any direction will do, this one does for most stars.
Vec3 mean_normal(const double* centre, const double* const* link, std::size_t size) {
  Vec3 sum = Vec3::Zero();
  Vec3 u = difference(centre, link[size - 1]);
  for (std::size_t i = 0; i < size; ++i) {
    const Vec3 v = difference(centre, link[i]);
    sum += u.cross(v);
    u = v;
  }
  return sum;
}

}  // namespace

bool star_certainly_embedded(const double* centre, const double* const* link, std::size_t size) {
  const Vec3 n = mean_normal(centre, link, size);
  // u -> (n x d) . u does not change along n. An odd d, so that regular meshes have no vertices where it is zero.
  const FilteredCross across(n, {0.3141, 0.5926, -0.7422});
  Vec3 u = difference(centre, link[size - 1]);
  int side = across.sign_of_product(u);
  if (side == 0) return false;
  int rises = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const Vec3 v = difference(centre, link[i]);
    if (FilteredCross(u, v).sign_of_product(n) <= 0) return false;
    const int next_side = across.sign_of_product(v);
    if (next_side == 0) return false;
    if (side < next_side) ++rises;
    side = next_side;
    u = v;
  }
  return rises == 1;
}

}  // namespace prcage
