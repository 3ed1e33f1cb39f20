// What the makers of planes for the several instruction sets share. Plain types only: they are also compiled for other
// instruction sets than the rest of the program.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/qp3_problem.h"

namespace prcage {

// The local frame of an edge, and where its star lies in the arrays. Faces are in the order of EdgeStar: face k of the
// star has the corners first_corner + k and the next one, and the tail or the head of the edge.
struct StarFrame {
  double origin[3];  // midpoint of the edge
  double scale;      // global length of one local unit
  double tail[3];    // global
  double head[3];
  std::uint32_t first_corner;
  std::uint32_t first_row;   // where its rows begin
  std::uint32_t faces;       // the last two die with the edge
  std::uint32_t tail_faces;  // the first ones; the others are at the head
};

// The kernels load and store whole vectors: so many numbers beyond the corners and the rows must be there. What is
// behind the rows is overwritten.
constexpr std::size_t star_padding = 16;

struct StarArrays {
  std::size_t count;
  const StarFrame* frame;
  const double* corner[3];  // x, y, z; global
  const double* lower;      // of the height interval of the face with the same number as the corner; global
  const double* upper;
  double margin;           // added to the lower bounds, local
  double absolute_margin;  // the same, global
  double height_fraction;  // least height over its outer edge that a face keeps

  // The SlabRows of every star, local frame, row_length(faces) long: the bounds of its faces, and the orientations of
  // those that survive. Faces too thin to have a reliable normal have planes that no point violates.
  double* rows;
  // Sum over the star of area times squared distance to the plane: 1/2 x^T form x + linear . x + constant.
  double* form;      // six each: xx, xy, xz, yy, yz, zz
  double* linear;    // three each
  double* constant;  // one each
};

}  // namespace prcage
