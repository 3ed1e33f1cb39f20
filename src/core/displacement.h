// The first step off the input (paper sec. 3.2): a direction along which every incident face plane of a vertex moves
// outward at least as far as the step.
#pragma once

#include <span>

#include "core/corner_table.h"

namespace prcage {

// The shortest x with n . x >= 1 for all unit normals n. False if there is none.
bool clearing_direction(std::span<const Vec3> normals, Vec3& direction);

// The clearing direction of the faces at a vertex; those without area are left out, and those that are low against the
// step if there is none otherwise: it clears them with their neighbours. False if there is none, a singular vertex (see
// vertex_cap.h); the direction is then the mean normal.
bool displacement_direction(const CornerTable& mesh, std::uint32_t vertex, double step, Vec3& direction);

// Unit normal of the face of a halfedge, zero if it has no area.
Vec3 unit_normal(const CornerTable& mesh, std::uint32_t h);

}  // namespace prcage
