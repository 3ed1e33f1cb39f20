// Stage 6 of a round: accepted patches become part of the cage.
#pragma once

#include "parallel/patches.h"

namespace prcage {

// What becomes of the costs of edges whose end has moved: all are evaluated again, or they are estimated from what they
// were, and an edge is evaluated when it is selected. That saves most evaluations, at the price of a worse order.
enum class NewCosts : std::uint8_t { evaluated, estimated };

// Collapses the edges of all accepted patches, in parallel. Updates boxes and distances, marks the vertices whose
// edges must be evaluated again, and takes rejected edges out of the race until then.
void commit_collapses(CageState& state, const PatchBatch& batch, NewCosts costs = NewCosts::evaluated);

// Flips the edges of all accepted patches.
void commit_flips(CageState& state, const PatchBatch& batch);

void commit_moves(CageState& state, const PatchBatch& batch);

}  // namespace prcage
