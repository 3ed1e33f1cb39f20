#include "parallel/side_test.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "parallel/parallel_for.h"
#include "parallel/winding.h"

namespace prcage {
namespace {

// Pieces beyond these limits are given up as undecided.
constexpr int most_pieces = 1 << 14;
constexpr double smallest_piece = 1.0 / 64;  // of the narrower tolerance
// So that rounding cannot make a piece that touches the input look clear of it.
constexpr double clearly = 1 + 1e-9;

using Piece = std::array<Vec3, 3>;

// Depth first, the halves across the longest edge: the stack stays short.
class Pieces {
 public:
  explicit Pieces(const Piece& whole) { stack_[top_++] = whole; }

  bool next(Piece& piece) {
    if (top_ == 0) return false;
    piece = stack_[--top_];
    ++taken_;
    return true;
  }

  // False if that is more than it is worth.
  bool divide(const Piece& piece, double shortest) {
    std::size_t i = 0;
    const auto length = [&](std::size_t k) { return (piece[(k + 1) % 3] - piece[k]).squaredNorm(); };
    for (std::size_t k = 1; k < 3; ++k)
      if (length(k) > length(i)) i = k;
    if (taken_ >= most_pieces || top_ + 2 > stack_.size() || length(i) < shortest * shortest) return false;
    const Vec3 middle = 0.5 * (piece[i] + piece[(i + 1) % 3]);
    stack_[top_++] = {middle, piece[(i + 1) % 3], piece[(i + 2) % 3]};
    stack_[top_++] = {piece[i], middle, piece[(i + 2) % 3]};
    return true;
  }

 private:
  std::array<Piece, 64> stack_;
  std::size_t top_ = 0;
  int taken_ = 0;
};

double radius_from(const Vec3& centre, const Piece& piece) {
  return std::sqrt(std::max(
      {(piece[0] - centre).squaredNorm(), (piece[1] - centre).squaredNorm(), (piece[2] - centre).squaredNorm()}));
}

Vec3 point(const double* p) { return {p[0], p[1], p[2]}; }

}  // namespace

bool SideTest::add_points(const TriangleRef& face, std::uint32_t near, double narrow, bool inside,
                          std::vector<Position>& points) const {
  Pieces pieces({point(face.p[0]), point(face.p[1]), point(face.p[2])});
  for (Piece piece; pieces.next(piece);) {
    const Vec3 centre = (piece[0] + piece[1] + piece[2]) / 3;
    const DistanceBand::Near nearest = band_.nearest(centre, near);
    near = nearest.face;
    if (band_.distance_from(near).largest_squared(piece) <= narrow * narrow) continue;
    if (nearest.distance <= clearly * radius_from(centre, piece)) {
      if (!pieces.divide(piece, smallest_piece * narrow)) return false;
      continue;
    }
    // Nearly always right, and enough to refuse.
    if (band_.behind_face(centre, near) != inside) return false;
    points.push_back(position(centre));
  }
  return true;
}

void SideTest::reject_wrong_sides(const CageState& state, const BandLimits& limits, PatchBatch& batch) const {
  const double narrow = std::min(limits.inner, limits.outer);
  const bool inside = limits.inner > limits.outer;
  std::vector<std::vector<Position>> points(batch.size());
  parallel_each(batch.size(), 1, [&](std::size_t i) {
    for (std::size_t t = batch.first_face[i]; t < batch.first_face[i + 1] && batch.alive(i); ++t) {
      if (batch.reach[t] > narrow &&
          !add_points(patch_triangle(state.mesh, batch, t), batch.near[t].face, narrow, inside, points[i]))
        batch.verdict[i] = Verdict::wrong_side;
    }
  });
  std::vector<Position> all;
  std::vector<std::uint32_t> patch_of;
  for (std::uint32_t i = 0; i < batch.size(); ++i) {
    if (!batch.alive(i)) continue;
    all.insert(all.end(), points[i].begin(), points[i].end());
    patch_of.resize(all.size(), i);
  }
  const std::vector<Winding> windings = winding_numbers(device_, input_, all);
  for (std::size_t k = 0; k < all.size(); ++k)
    if (!windings[k].known || windings[k].number != (inside ? 1 : 0)) batch.verdict[patch_of[k]] = Verdict::wrong_side;
}

}  // namespace prcage
