// The star of an edge: the faces at its two endpoints, walked once for all who ask about a collapse.
//
// An edge from the tail a to the head b has the faces abc and bad. The other faces of the star join a or b to the edges
// of a closed polygon round both, the link: from the apex c round a to the apex d, and on round b to c. In this order
// each face has its moving endpoint, the vertex of its own number and the next one:
//
//   faces     a ... a | b ... b | bca, bad                  tail_faces() at the tail, then the others at the head
//   vertices  c ...     d ...     c  a      d
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/corner_table.h"

namespace prcage {

// Reused between edges; grows to the largest star.
class EdgeStar {
 public:
  // False if the star has more than `most` faces: nothing else may be asked then.
  bool walk(const CornerTable& mesh, std::uint32_t halfedge, std::uint32_t most = none);

  // Whether the edge may be collapsed in a closed surface: the endpoints have exactly the two apexes as common
  // neighbours, and the merged vertex and the apexes keep a valence of at least 3.
  bool link_condition() const;

  std::uint32_t halfedge() const { return halfedge_; }
  // Faces at the tail that survive.
  std::size_t tail_faces() const { return tail_faces_; }
  // Numbers of the faces; the last two die in a collapse.
  std::span<const std::uint32_t> faces() const { return {face_.data(), count_}; }
  // One more than faces.
  std::span<const std::uint32_t> vertices() const { return {vertex_.data(), count_ + 1}; }

 private:
  bool walk_to(const CornerTable& mesh, std::uint32_t first, std::uint32_t last, std::size_t most);
  void grow();

  std::vector<std::uint32_t> face_;
  std::vector<std::uint32_t> vertex_;
  std::size_t count_ = 0;
  std::size_t tail_faces_ = 0;
  std::uint32_t halfedge_ = none;
};

}  // namespace prcage
