#include "core/repair.h"

#include <algorithm>

#include "core/adjacency.h"
#include "core/predicates.h"

namespace prcage {
namespace {

// Editable halfedge view of the mesh under repair. Faces and halfedges keep their numbers; removed faces are marked.
class Surgeon {
 public:
  Surgeon(const std::vector<Position>& positions, std::vector<Triangle> triangles, std::vector<std::uint32_t> twin)
      : positions_(positions),
        triangles_(std::move(triangles)),
        twin_(std::move(twin)),
        kept_(triangles_.size(), 1),
        tried_(triangles_.size(), 0) {}

  // Removes what can be removed of the degenerate faces given, which must be all there are; leaves the others in the
  // list.
  void run(std::vector<std::uint32_t>& degenerate);

  const std::vector<Triangle>& triangles() const { return triangles_; }
  const std::vector<std::uint8_t>& kept() const { return kept_; }

  std::size_t flips() const { return flips_; }
  std::size_t collapses() const { return collapses_; }

 private:
  enum class Step { progress, wait_for_neighbour, stuck };

  bool is_degenerate(std::uint32_t f) const {
    return exact::collinear(point(3 * f), point(3 * f + 1), point(3 * f + 2));
  }
  bool has_zero_length(std::uint32_t h) const { return positions_[vertex(h)] == positions_[destination(h)]; }
  bool is_needle(std::uint32_t f) const {
    return has_zero_length(3 * f) || has_zero_length(3 * f + 1) || has_zero_length(3 * f + 2);
  }

  std::uint32_t vertex(std::uint32_t h) const { return triangles_[h / 3][h % 3]; }
  std::uint32_t& vertex(std::uint32_t h) { return triangles_[h / 3][h % 3]; }
  const double* point(std::uint32_t h) const { return positions_[vertex(h)].data(); }
  std::uint32_t apex(std::uint32_t h) const { return vertex(previous_halfedge(h)); }

  // The next halfedge with the same origin.
  std::uint32_t turn(std::uint32_t h) const { return twin_[previous_halfedge(h)]; }
  std::uint32_t destination(std::uint32_t h) const { return vertex(next_halfedge(h)); }
  void pair(std::uint32_t g, std::uint32_t h) {
    twin_[g] = h;
    twin_[h] = g;
  }

  // Is there an edge between the origins of g and h? Costs the smaller of the two valences.
  bool adjacent(std::uint32_t g, std::uint32_t h) const;
  // Of two halfedges the one whose origin has the smaller valence (the first if equal).
  std::uint32_t smaller_fan(std::uint32_t g, std::uint32_t h) const;

  std::uint32_t long_edge(std::uint32_t f) const;
  Step remove(std::uint32_t f);
  Step remove_cap(std::uint32_t f);
  Step remove_needle(std::uint32_t f);
  bool flip(std::uint32_t h);
  bool collapse(std::uint32_t h);
  bool link_condition(std::uint32_t h) const;
  bool resolve(std::uint32_t f);

  const std::vector<Position>& positions_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> twin_;
  std::vector<std::uint8_t> kept_;
  std::vector<std::uint8_t> tried_;  // without success since the last round began
  std::vector<std::uint32_t> stack_;
  std::size_t flips_ = 0;
  std::size_t collapses_ = 0;
};

bool Surgeon::adjacent(std::uint32_t g, std::uint32_t h) const {
  const std::uint32_t a = vertex(g);
  const std::uint32_t b = vertex(h);
  std::uint32_t i = g;
  std::uint32_t j = h;
  do {
    if (destination(i) == b || destination(j) == a) return true;
    i = turn(i);
    j = turn(j);
  } while (i != g && j != h);
  return false;
}

std::uint32_t Surgeon::smaller_fan(std::uint32_t g, std::uint32_t h) const {
  std::uint32_t i = turn(g);
  std::uint32_t j = turn(h);
  while (i != g && j != h) {
    i = turn(i);
    j = turn(j);
  }
  return i == g ? g : h;
}

// Halfedge of a cap that holds the third corner: on a line the lexicographic order is the order along it.
std::uint32_t Surgeon::long_edge(std::uint32_t f) const {
  for (std::uint32_t h = 3 * f; h < 3 * f + 2; ++h) {
    const Position& a = positions_[vertex(h)];
    const Position& b = positions_[destination(h)];
    const Position& c = positions_[apex(h)];
    if ((a < c && c < b) || (b < c && c < a)) return h;
  }
  return 3 * f + 2;
}

// Flips the edge of h if its two apexes are not connected yet.
bool Surgeon::flip(std::uint32_t h) {
  const std::uint32_t t = twin_[h];
  const std::uint32_t c = apex(h);
  const std::uint32_t d = apex(t);
  if (c == d || adjacent(previous_halfedge(h), previous_halfedge(t))) return false;
  const std::uint32_t hn = next_halfedge(h);
  const std::uint32_t hp = previous_halfedge(h);
  const std::uint32_t tn = next_halfedge(t);
  const std::uint32_t tp = previous_halfedge(t);
  const std::uint32_t outer[4] = {twin_[hn], twin_[hp], twin_[tn], twin_[tp]};
  const std::uint32_t a = vertex(h);
  const std::uint32_t b = vertex(t);
  vertex(h) = c;
  vertex(hn) = d;
  vertex(hp) = b;
  vertex(t) = d;
  vertex(tn) = c;
  vertex(tp) = a;
  pair(hp, outer[0]);
  pair(tn, outer[1]);
  pair(tp, outer[2]);
  pair(hn, outer[3]);
  ++flips_;
  return true;
}

// The ends of h have no common neighbour but the two apexes, and the surface there is more than a tetrahedron.
bool Surgeon::link_condition(std::uint32_t h) const {
  const std::uint32_t small = smaller_fan(h, twin_[h]);
  const std::uint32_t large = twin_[small];
  if (apex(small) == apex(large)) return false;
  std::size_t valence = 0;
  for (std::uint32_t i = turn(small); i != small; i = turn(i), ++valence) {
    const std::uint32_t x = destination(i);
    if (x == apex(small) || x == apex(large)) continue;
    if (adjacent(twin_[i], large)) return false;
  }
  if (valence > 2) return true;
  // Valence three: the face beyond the star's third face must not end at the other end.
  return apex(twin_[next_halfedge(turn(small))]) != vertex(large);
}

// Collapses the edge of h, two faces with it. The end with fewer faces goes.
bool Surgeon::collapse(std::uint32_t h) {
  if (!link_condition(h)) return false;
  h = smaller_fan(h, twin_[h]);
  const std::uint32_t t = twin_[h];
  const std::uint32_t kept = vertex(t);
  for (std::uint32_t i = turn(h); i != h; i = turn(i)) vertex(i) = kept;
  vertex(h) = kept;
  for (const std::uint32_t g : {h, t}) {
    pair(twin_[next_halfedge(g)], twin_[previous_halfedge(g)]);
    kept_[g / 3] = 0;
  }
  ++collapses_;
  return true;
}

Surgeon::Step Surgeon::remove(std::uint32_t f) { return is_needle(f) ? remove_needle(f) : remove_cap(f); }

Surgeon::Step Surgeon::remove_needle(std::uint32_t f) {
  for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h)
    if (has_zero_length(h) && collapse(h)) return Step::progress;
  return Step::stuck;
}

// A degenerate neighbour goes first, unless it is a cap over the same edge: then the flip leaves two degenerate faces
// with shorter edges.
Surgeon::Step Surgeon::remove_cap(std::uint32_t f) {
  const std::uint32_t h = long_edge(f);
  const std::uint32_t g = twin_[h] / 3;
  if (is_degenerate(g) && (is_needle(g) || long_edge(g) != twin_[h]))
    return tried_[g] == 0 ? Step::wait_for_neighbour : Step::stuck;
  return flip(h) ? Step::progress : Step::stuck;
}

// Works on f and on the degenerate faces that have to go before it. Was anything changed?
bool Surgeon::resolve(std::uint32_t first) {
  bool changed = false;
  stack_.assign(1, first);
  while (!stack_.empty()) {
    const std::uint32_t f = stack_.back();
    if (kept_[f] == 0 || tried_[f] != 0 || !is_degenerate(f)) {
      stack_.pop_back();
      continue;
    }
    const std::uint32_t neighbour = twin_[long_edge(f)] / 3;
    switch (remove(f)) {
      case Step::progress:
        changed = true;
        if (kept_[f] != 0) stack_.push_back(neighbour);  // a flip: f and its neighbour were cut anew
        break;
      case Step::wait_for_neighbour:
        stack_.push_back(neighbour);
        break;
      case Step::stuck:
        tried_[f] = 1;
        break;
    }
  }
  return changed;
}

// Rounds until nothing changes: a face that is stuck may come free when others go. Each flip and collapse lowers the
// number of degenerate faces, or the lengths of their longest edges, so that this ends.
void Surgeon::run(std::vector<std::uint32_t>& degenerate) {
  for (bool changed = !degenerate.empty(); changed;) {
    changed = false;
    for (const std::uint32_t f : degenerate) tried_[f] = 0;
    for (const std::uint32_t f : degenerate) changed = resolve(f) || changed;
    std::erase_if(degenerate, [&](std::uint32_t f) { return kept_[f] == 0 || !is_degenerate(f); });
  }
}

}  // namespace

Repair remove_degenerate_faces(const Mesh& mesh, std::vector<std::uint32_t> twin,
                               std::vector<std::uint32_t> degenerate) {
  Repair out;
  Surgeon surgeon(mesh.positions, mesh.triangles, std::move(twin));
  surgeon.run(degenerate);
  out.flips = surgeon.flips();
  out.collapses = surgeon.collapses();
  out.surface = select_faces(mesh.positions, surgeon.triangles(), surgeon.kept());
  for (std::uint32_t f = 0; f < out.surface.face_of.size(); ++f)
    if (std::binary_search(degenerate.begin(), degenerate.end(), out.surface.face_of[f])) out.degenerate.push_back(f);
  return out;
}

}  // namespace prcage
