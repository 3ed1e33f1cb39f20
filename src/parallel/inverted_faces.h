// Faces of a surface that are turned over with respect to another one that it is made from.
//
// A face counts as inverted if at none of 15 points of it - those with barycentric coordinates in quarters - the face
// of the input that is closest looks the same way, by less than a right angle; where several are equally close, one of
// them is enough. So coarseness is no fault: a face may lie across a step of the input, but not the wrong way round on
// all of it. Faces without area look nowhere and are not counted.
#pragma once

#include <cstddef>

#include "parallel/intersections.h"

namespace prcage {

// Both trees in the same frame. Must be called inside an Arena.
std::size_t count_inverted_faces(const TreeDevice& device, const SurfaceTree& input, const SurfaceTree& surface);

}  // namespace prcage
