// From the caller's arrays, whatever their layout, to the engine's own mesh.
#pragma once

#include "core/prcage.h"

namespace prcage {

// Copies without loss: floats become the doubles of the same value, indices are taken as they are.
Mesh to_mesh(const MeshView& view);

}  // namespace prcage
