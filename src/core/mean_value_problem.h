// What the kernels of mean value coordinates for the several instruction sets share. Plain types only: they are also
// compiled for other instruction sets than the rest of the program.
#pragma once

#include <cstddef>
#include <cstdint>

namespace prcage {

// A closed cage. Every vertex is in use; lengths are of the order of 1.
struct MeanValueCage {
  std::size_t vertices;
  std::size_t edges;
  std::size_t faces;
  const double* position;         // x, y, z of each vertex
  const std::uint32_t* edge;      // two vertices each
  const std::uint32_t* corner;    // three vertices of each face
  const std::uint32_t* opposite;  // of each face: the edges opposite to its three corners
};

struct MeanValueArrays {
  const MeanValueCage* cage;
  std::size_t count;
  const double* point;  // x, y, z each
  double* weights;      // a row for each point, `stride` numbers apart
  std::size_t stride;
  const std::uint32_t* column;  // of the row, for each vertex of the cage; the other columns are left alone
  double* scratch;              // mean_value_scratch_rows() rows
};

// What the kernels keep of the vertices and the edges while they look at as many points as a vector has lanes; a cache
// line for the widest vector.
struct alignas(64) ScratchRow {
  double number[8];
};

constexpr std::size_t mean_value_scratch_rows(const MeanValueCage& cage) { return 5 * cage.vertices + cage.edges; }

}  // namespace prcage
