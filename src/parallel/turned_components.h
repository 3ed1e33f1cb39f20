// Small components of a surface that may move inward must not turn inside out.
//
// A patch that touches nothing can still pass through its own component: if what the patch does not replace lies
// between the old faces and the new ones, the component is embedded before and after, but looks the other way. A flat
// tetrahedron whose apex goes through the opposite face does that, and no face of the three turns by much.
#pragma once

#include "parallel/cage_state.h"
#include "parallel/patches.h"

namespace prcage {

// Rejects patches that would turn their component inside out. Exact. Where that is possible at all, only the cheapest
// patch of a component is left for this round, since two could do together what neither does alone.
void reject_turned_components(const CageState& state, PatchBatch& batch);

}  // namespace prcage
