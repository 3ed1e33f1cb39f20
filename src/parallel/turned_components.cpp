#include "parallel/turned_components.h"

#include <unordered_set>
#include <vector>

#include "core/predicates.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

// Visits the faces of the component of a face, near ones first, until one answers true. Did one?
template <class Visit>
bool any_of_component(const CornerTable& mesh, std::uint32_t start, const Visit& visit) {
  std::vector<std::uint32_t> faces{start};
  std::unordered_set<std::uint32_t> seen{start};
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (visit(faces[i])) return true;
    for (std::uint32_t h = 3 * faces[i]; h < 3 * faces[i] + 3; ++h)
      if (const std::uint32_t f = mesh.twin[h] / 3; seen.insert(f).second) faces.push_back(f);
  }
  return false;
}

std::vector<std::uint32_t> component_of(const CornerTable& mesh, std::uint32_t start) {
  std::vector<std::uint32_t> faces;
  any_of_component(mesh, start, [&](std::uint32_t f) {
    faces.push_back(f);
    return false;
  });
  return faces;
}

class Search {
 public:
  Search(const CageState& state, PatchBatch& batch)
      : state_(state),
        batch_(batch),
        box_(patch_boxes(state, batch, [&](std::size_t i) { return batch.alive(i); })),
        patch_at_(state.mesh.face_slots(), none) {
    parallel_each(batch.size(), default_grain, [&](std::size_t i) {
      if (!batch.alive(i)) return;
      for (const std::uint32_t f : batch.removed_faces(i)) patch_at_[f] = static_cast<std::uint32_t>(i);
    });
  }

  // Could the patch sweep over all that it leaves of its component? That would be in the convex hull of the old faces
  // and the new ones. A face that no patch removes and that is not in their box shows that it is not.
  bool may_turn(std::size_t i) const {
    const auto shows = [&](std::uint32_t f) { return patch_at_[f] == none && !box_[i].contains(state_.face_box[f]); };
    for (const std::uint32_t f : batch_.removed_faces(i))
      for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h)
        if (shows(state_.mesh.twin[h] / 3)) return false;
    return !any_of_component(state_.mesh, batch_.removed_faces(i).front(), shows);
  }

  // Of the patches on the component of patch i all wait but the cheapest, and that one must not turn it.
  void settle(std::size_t i) {
    const auto faces = component_of(state_.mesh, batch_.removed_faces(i).front());
    std::size_t cheapest = i;
    const auto for_each_patch = [&](const auto& visit) {
      for (const std::uint32_t f : faces)
        if (patch_at_[f] != none && batch_.alive(patch_at_[f])) visit(patch_at_[f]);
    };
    for_each_patch([&](std::uint32_t p) {
      if (batch_.candidate[p] < batch_.candidate[cheapest]) cheapest = p;
    });
    for_each_patch([&](std::uint32_t p) {
      if (p != cheapest) batch_.verdict[p] = Verdict::conflict;
    });
    if (turns(faces, cheapest)) batch_.verdict[cheapest] = Verdict::turns_over;
  }

 private:
  bool turns(const std::vector<std::uint32_t>& faces, std::size_t patch) const {
    std::vector<const double*> before, after;
    for (const std::uint32_t f : faces) {
      const bool removed = patch_at_[f] == patch;
      for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
        before.push_back(state_.mesh.point(state_.mesh.origin(h)));
        if (!removed) after.push_back(before.back());
      }
    }
    for (std::size_t t = batch_.first_face[patch]; t < batch_.first_face[patch + 1]; ++t)
      for (const double* p : patch_triangle(state_.mesh, batch_, t).p) after.push_back(p);
    return exact::volume_sign(before.data(), before.size() / 3) != exact::volume_sign(after.data(), after.size() / 3);
  }

  const CageState& state_;
  PatchBatch& batch_;
  std::vector<Box> box_;                 // of each patch, old faces and new
  std::vector<std::uint32_t> patch_at_;  // per face: the patch that would remove it, or none
};

}  // namespace

void reject_turned_components(const CageState& state, PatchBatch& batch) {
  Search search(state, batch);
  std::vector<std::uint8_t> suspect(batch.size(), 0);
  parallel_each(batch.size(), default_grain,
                [&](std::size_t i) { suspect[i] = batch.alive(i) && search.may_turn(i) ? 1 : 0; });
  for (std::size_t i = 0; i < batch.size(); ++i)
    if (suspect[i] != 0 && batch.alive(i)) search.settle(i);
}

}  // namespace prcage
