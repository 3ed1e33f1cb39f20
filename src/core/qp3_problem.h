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

// The planes of a star, in nine rows of `length` numbers, one row after the other: slabs lower <= normal . x <= upper,
// one a face, and half-spaces inward . x >= inward_offset. A slab's two planes have their normal once: the slacks of
// both come from one dot product, which negation does not round. Planes 0 . x >= -1, with upper = 1, fill the rows up:
// they hold everywhere.
struct SlabRows {
  const double* rows;
  std::size_t length;  // 0 or row_length(), less than 2^20
};

enum SlabRow : std::size_t { slab_normal = 0, slab_lower = 3, slab_upper = 4, slab_inward = 5, slab_inward_offset = 8 };
constexpr std::size_t slab_rows = 9;

// Whole vectors of four numbers, which stay aligned if the first row is. At least as long as most stars need: so they
// all take the same way through the solver, and no branch is foreseen wrongly because of one face more or less.
constexpr std::size_t least_row_length = 12;
constexpr std::size_t row_length(std::size_t faces) {
  return faces <= least_row_length ? least_row_length : (faces + 3) / 4 * 4;
}

enum class QpStatus : std::uint8_t { solved, infeasible, not_converged };

// Many problems, and where their solutions go. The rows of problem i begin at number first_row[i]; best if they follow
// one another, on a multiple of 32 bytes.
struct QpBatchArrays {
  std::size_t count;
  const double* form;    // six each: xx, xy, xz, yy, yz, zz
  const double* linear;  // three each
  const std::uint32_t* first_row;
  const std::uint32_t* row_length;
  const double* rows;
  double tolerance;
  double* x;  // three each, written if solved
  QpStatus* status;
};

}  // namespace prcage
