#include "parallel/wrap_room.h"

#include "parallel/parallel_for.h"

namespace prcage {

float WrapRoom::at(const Vec3& x) const {
  const ClosestFace::Near near = closest_.nearest(x);
  return closest_.behind_face(x, near.face) ? static_cast<float>(near.distance) : 0;
}

float WrapRoom::at(const CornerTable& mesh, std::uint32_t face) const {
  const auto [a, b, c] = mesh.corners(face);
  return at((a + b + c) / 3);
}

void WrapRoom::measure(CageState& state) const {
  state.face_room.resize(state.mesh.face_slots());
  parallel_each(state.face_room.size(), 256, [&](std::size_t f) {
    const auto face = static_cast<std::uint32_t>(f);
    if (state.mesh.face_alive(face)) state.face_room[f] = at(state.mesh, face);
  });
}

void WrapRoom::measure(const PatchBatch& batch, CageState& state) const {
  parallel_each(batch.face.size(), 64, [&](std::size_t t) {
    if (batch.alive(batch.patch_of[t])) state.face_room[batch.face[t]] = at(state.mesh, batch.face[t]);
  });
}

}  // namespace prcage
