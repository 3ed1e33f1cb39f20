#include "core/edge_star.h"

#include <algorithm>

namespace prcage {

bool EdgeStar::walk(const CornerTable& mesh, std::uint32_t halfedge, std::uint32_t most) {
  const std::uint32_t twin = mesh.twin[halfedge];
  if (vertex_.empty()) grow();
  halfedge_ = halfedge;
  count_ = 0;
  vertex_[0] = mesh.apex(halfedge);
  // Round the tail from the face behind that of the edge up to the face of the twin, which belongs to the head.
  if (!walk_to(mesh, mesh.next_around(halfedge), next_halfedge(twin), most)) return false;
  tail_faces_ = count_;
  const std::uint32_t beyond_twin = mesh.next_around(twin);
  return walk_to(mesh, beyond_twin, twin, most) && walk_to(mesh, twin, beyond_twin, most);
}

// Adds the faces of the halfedges that leave one vertex, from `first` up to but not including `last`.
bool EdgeStar::walk_to(const CornerTable& mesh, std::uint32_t first, std::uint32_t last, std::size_t most) {
  for (std::uint32_t h = first; h != last;) {
    if (count_ == most) return false;
    if (count_ == face_.size()) grow();
    const std::uint32_t into = previous_halfedge(h);
    face_[count_] = h / 3;
    vertex_[++count_] = mesh.corner_vertex[into];
    h = mesh.twin[into];
  }
  return true;
}

void EdgeStar::grow() {
  face_.resize(std::max<std::size_t>(64, 2 * face_.size()));
  vertex_.resize(face_.size() + 1);
}

// The neighbours of one endpoint are all different, so that the link meets itself where one of the tail is one of the
// head, too. An apex of valence 3 is a case of that: its third neighbour is joined to both endpoints.
bool EdgeStar::link_condition() const {
  const std::size_t tail_valence = tail_faces_ + 2, head_valence = count_ - tail_faces_;
  if (tail_valence < 3 || head_valence < 3 || tail_valence + head_valence < 7) return false;
  const auto tail = vertices().subspan(1, tail_valence - 3);
  const auto head = vertices().subspan(tail_valence - 1, head_valence - 3);
  return std::find_first_of(tail.begin(), tail.end(), head.begin(), head.end()) == tail.end();
}

}  // namespace prcage
