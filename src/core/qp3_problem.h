// What the solver of one quadratic programme and the solver of many share. Plain types only: they are also compiled for
// other instruction sets than the rest of the program.
#pragma once

#include <cstddef>
#include <cstdint>

namespace prcage {

// Planes n . x >= offset in structure-of-arrays form; unit normals, or at least all of one scale.
struct PlaneArrays {
  const double* nx;
  const double* ny;
  const double* nz;
  const double* offset;
  std::size_t count;
};

enum class QpStatus : std::uint8_t { solved, infeasible, not_converged };

// Many problems, and where their solutions go. The planes of problem i are [first_plane[i], first_plane[i + 1]).
struct QpBatchArrays {
  std::size_t count;
  const double* form;    // six each: xx, xy, xz, yy, yz, zz
  const double* linear;  // three each
  const std::uint32_t* first_plane;
  const double* nx;
  const double* ny;
  const double* nz;
  const double* offset;
  double tolerance;
  double* x;  // three each, written if solved
  QpStatus* status;
};

}  // namespace prcage
