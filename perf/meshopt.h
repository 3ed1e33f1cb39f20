// meshopt_simplify() on meshes of prcage.
#pragma once

#include <cstddef>

#include "core/prcage.h"

namespace prcage::perf {

struct MeshoptResult {
  Mesh mesh;
  double seconds = 0;  // of the simplification alone
  float relative_error = 0;
};

// To `target_faces`, without an error limit, on one thread. Indices, float positions and the merging of equal positions
// are prepared off the clock.
MeshoptResult simplify_by_meshopt(const Mesh& mesh, std::size_t target_faces);

}  // namespace prcage::perf
