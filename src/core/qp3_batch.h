// Many quadratic programmes at once, by the best vector instructions that the CPU has. The solutions are those of
// solve_qp3, bit for bit, whatever the instruction set and whichever problems are solved together.
#pragma once

#include <cstdint>
#include <span>

#include "core/qp3.h"
#include "core/simd.h"

namespace prcage {

// Problem i has form[i], linear[i] and the planes of SlabRows{&rows[first_row[i]], row_length[i]}.
struct Qp3Batch {
  std::span<const Symmetric3> form;
  std::span<const Vec3> linear;
  std::span<const std::uint32_t> first_row;
  std::span<const std::uint32_t> row_length;
  std::span<const double> rows;

  std::size_t size() const { return form.size(); }
};

// Calls solve_qp3 for each problem in effect: x[i] is written if status[i] is solved. No allocation, thread-safe. The
// level must be an available one.
void solve_qp3_batch(const Qp3Batch& batch, double tolerance, std::span<Vec3> x, std::span<QpStatus> status,
                     SimdLevel level = simd_level());

}  // namespace prcage
