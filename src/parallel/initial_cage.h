// C_0: the input moved outward by sigma and proved, exactly, to be free of self-intersections and of contact with the
// input. Where neighbouring sheets are too close for sigma it is halved, only there, until the conflict is gone.
#pragma once

#include <span>

#include "parallel/cage_state.h"
#include "parallel/intersections.h"

namespace prcage {

struct DisplacementSettings {
  double step = 0;            // sigma, absolute
  double longest_move = 0;    // no vertex moves farther
  double longest_radius = 0;  // singular vertices are cut off no farther out; no point of C_0 is farther from the input
                              // than this and longest_move together
  bool float_positions = false;
};

struct InitialCage {
  bool valid = false;
  CageState state;
  std::vector<double> step;           // per vertex: sigma used
  std::size_t singular_vertices = 0;  // no direction clears all faces
  std::size_t capped_vertices = 0;    // of those: cut off (vertex_cap.h); the others move along a mean normal
  std::size_t halved_vertices = 0;
  FacePairs self_intersections;  // what is left if not valid (at most five pairs each): faces of the cage, which begins
                                 // with those of `surface`
  FacePairs contacts;            // face of the cage, face of the input
};

// What is known of the faces of a cage whose first faces are those of the surface: fills in all that `state` has beside
// the mesh. All vertices are dirty.
void describe_faces(const Mesh& surface, const UnitFrame& frame, CageState& state);

// `surface` is the input without degenerate faces; `input` the tree over the input that must not be touched. Runs
// inside an Arena.
InitialCage displace(const Mesh& surface, const SurfaceTree& input, const DisplacementSettings& settings,
                     const TreeDevice& device);

}  // namespace prcage
