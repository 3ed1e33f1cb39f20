// Stages 4 and 5 of a round: patches against the rest of the cage and against each other, exactly, and the choice of
// those that are kept.
#pragma once

#include "parallel/patches.h"

namespace prcage {

// Rejects patches that meet a face of the cage which they would not remove. Faces that other patches would remove
// count: a patch must be valid whether or not the others are committed.
void reject_hits_on_cage(const CageState& state, const TreeDevice& device, PatchBatch& batch);

// Rejects of every two patches that meet the one with the higher key, in the order of the keys, so that the outcome is
// the greedy one.
void reject_conflicts(const CageState& state, const TreeDevice& device, PatchBatch& batch);

// Rejects patches for what they must not do to the surface itself, in this order: sweep over another component of it,
// meet the rest of it or each other, and in a band on both sides turn their own component inside out.
void reject_collisions(const CageState& state, const TreeDevice& device, Sides sides, PatchBatch& batch);

}  // namespace prcage
