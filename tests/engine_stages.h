// What the stages of a round need round them, set up for one mesh as make_cage() sets it up, or with a cage of the
// test's own choice.
#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "core/round_outward.h"
#include "parallel/arena.h"
#include "parallel/cage_state.h"
#include "parallel/distance_band.h"
#include "parallel/initial_cage.h"
#include "parallel/patches.h"
#include "test_meshes.h"

namespace prcage::testing {

// Runs f in an arena of its own, as every parallel part of the engine must.
template <class F>
void in_arena(int threads, F&& f) {
  Arena arena(threads);
  arena.run(std::forward<F>(f));
}

// An input with its tree and its distance band. To be made and used inside an arena; stays where it is.
class Stage {
 public:
  explicit Stage(const Mesh& mesh) : input(mesh), tree(device), diagonal(diagonal_of(mesh)) {
    tree.build(unit_frame(input.positions), input.positions, input.triangles);
    band = std::make_unique<DistanceBand>(tree);
    band->set_voxel_size(diagonal / 160);
  }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  InitialCage displaced(double step, bool float_positions = false) const {
    return displace(input, tree, {step, 50 * step, 100 * step, float_positions}, device);
  }

  // The state of an engine whose cage is `cage`, all vertices dirty.
  CageState state_of(const Mesh& cage) const {
    CageState state;
    state.mesh = CornerTable::from_mesh(cage);
    const std::size_t faces = cage.triangles.size();
    state.live_faces = faces;
    forget_costs(state);
    for (const Triangle& t : cage.triangles) {
      const auto [a, b, c] = corners(cage, t);
      const DistanceBand::Near near = band->nearest((a + b + c) / 3);
      state.face_near.push_back(near.face);
      state.face_distance.push_back(float_above(near.distance));
      state.face_reach.push_back(float_above(band->reach(a, b, c, diagonal)));
      state.face_box.push_back(bounding_box(tree.frame(), {a.data(), b.data(), c.data()}));
      state.face_normal.push_back(reliable_normal(a.data(), b.data(), c.data()));
    }
    return state;
  }

  PlacementSettings placement(double tau) const {
    PlacementSettings settings;
    settings.band.outer = tau;
    settings.min_scale = 1e-12 * diagonal;
    settings.cost_scale = 1 / (diagonal * diagonal);
    return settings;
  }

  // Patches of the selected edges, as a round builds them.
  PatchBatch patches(CageState& state, const PlacementSettings& settings,
                     const std::vector<Candidate>& selected) const {
    return build_collapses(state, tree.frame(), place_collapses(state, settings, selected));
  }

  Mesh input;
  TreeDevice device;
  SurfaceTree tree;
  double diagonal;
  std::unique_ptr<DistanceBand> band;
};

// Faces with a corner at an endpoint of the edge, by a loop over all faces.
inline std::vector<std::uint32_t> star_faces(const CornerTable& mesh, std::uint32_t h) {
  std::vector<std::uint32_t> faces;
  const std::uint32_t a = mesh.origin(h), b = mesh.target(h);
  for (std::uint32_t g = 0; g < mesh.corner_vertex.size(); ++g)
    if ((mesh.corner_vertex[g] == a || mesh.corner_vertex[g] == b) && (faces.empty() || faces.back() != g / 3))
      faces.push_back(g / 3);
  return faces;
}

// The halfedge from a to b, or none.
inline std::uint32_t halfedge_between(const CornerTable& mesh, std::uint32_t a, std::uint32_t b) {
  for (std::uint32_t h = 0; h < mesh.corner_vertex.size(); ++h)
    if (mesh.corner_vertex[h] == a && mesh.target(h) == b) return h;
  return none;
}

}  // namespace prcage::testing
