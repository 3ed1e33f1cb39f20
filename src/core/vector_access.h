// How the kernels that are written once for all instruction sets read and write a V, which is a double or a vector of
// doubles. For the sources of kernels only, for the reasons that qp3_kernel.h names.
#pragma once

#include <cstddef>

#include "core/qp3_kernel.h"

namespace prcage {
namespace {

// width, load(), store(), and the numbers of the lanes.
template <class V>
struct Access;

template <>
struct Access<double> {
  static constexpr std::size_t width = 1;
  static double load(const double* from) { return *from; }
  static void store(double value, double* to) { *to = value; }
  static double lane_numbers() { return 0; }
};

// The widest vector that there is.
constexpr std::size_t most_lanes = 8;

template <class V>
inline Triple<V> broadcast(const double v[3]) {
  return {V(v[0]), V(v[1]), V(v[2])};
}

}  // namespace
}  // namespace prcage
