#include "parallel/distance_band.h"

#include <openvdb/tree/Tree.h>
#include <openvdb/tree/ValueAccessor.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/filtered_cross.h"
#include "parallel/parallel_for.h"

namespace prcage {
namespace {

constexpr std::size_t recent_slots = 1024;
// The memo is dropped when it takes more than this many bytes; it fills again where it is needed.
constexpr std::uint64_t memo_limit = std::uint64_t{128} << 20;
constexpr std::uint64_t measure_after = 10000;
// What a thread may find between two calls of absorb(); more is not remembered.
constexpr std::size_t most_found = std::size_t{1} << 20;
// Voxels are not made smaller than this fraction of the unit of the tree's frame, which keeps their indices small.
constexpr double smallest_voxel = 1e-7;
// A triangle that needs more pieces is given up as undecided: bounds the work for faces that are huge against tau.
constexpr int max_pieces = 1 << 16;
// Pieces smaller than this fraction of tau are given up as undecided.
constexpr double smallest_piece = 1.0 / 64;

std::size_t slot(const openvdb::Coord& voxel) {
  const auto mix = static_cast<std::uint32_t>(voxel.x()) * 73856093u ^
                   static_cast<std::uint32_t>(voxel.y()) * 19349663u ^
                   static_cast<std::uint32_t>(voxel.z()) * 83492791u;
  return (mix ^ (mix >> 15)) % recent_slots;
}

using Tree = openvdb::tree::Tree4<std::int32_t, 5, 4, 3>::Type;
using Accessor = openvdb::tree::ValueAccessor<const Tree, false>;  // not registered with the tree

}  // namespace

struct DistanceBand::Memo {
  struct Found {
    openvdb::Coord voxel = openvdb::Coord::max();
    std::int32_t face = -1;
  };
  // What one thread knows between two calls of absorb().
  struct Thread {
    explicit Thread(const Tree& shared) : tree(shared), recent(recent_slots) {}
    Accessor tree;
    std::vector<Found> recent;  // direct-mapped by voxel
    std::vector<Found> found;   // not in the tree yet
    std::uint32_t last = none;  // the face found last: the next question is about a place near by
  };

  Tree tree{-1};
  tbb::enumerable_thread_specific<Thread> threads{[this] { return Thread(tree); }};
  std::uint64_t filled = 0;
  std::uint64_t unmeasured = 0;  // voxels filled since the size of the tree was looked at
};

DistanceBand::DistanceBand(const SurfaceTree& surface)
    : closest_(surface), frame_(surface.frame()), memo_(std::make_unique<Memo>()) {
  widest_face_ = tbb::parallel_reduce(
      tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(surface.triangles().size()), default_grain), 0.0,
      [&](const tbb::blocked_range<std::uint32_t>& range, double widest) {
        for (std::uint32_t f = range.begin(); f < range.end(); ++f) {
          const TriangleRef t = surface.triangle(f);
          for (int k = 0; k < 3; ++k) widest = std::max(widest, difference(t.p[k], t.p[(k + 1) % 3]).norm());
        }
        return widest;
      },
      [](double x, double y) { return std::max(x, y); });
}

DistanceBand::~DistanceBand() = default;

std::uint64_t DistanceBand::voxels_filled() const { return memo_->filled; }

DistanceBand::Near DistanceBand::near(const Vec3& x) {
  const std::uint32_t face = near_face(x);
  return {face, distance_to_face(x, face)};
}

std::uint32_t DistanceBand::near_face(const Vec3& x) {
  const Vec3 y = (x - frame_.centre) / voxel_size_;
  const openvdb::Coord voxel(static_cast<int>(std::floor(y.x())), static_cast<int>(std::floor(y.y())),
                             static_cast<int>(std::floor(y.z())));
  Memo::Thread& memo = memo_->threads.local();
  Memo::Found& recent = memo.recent[slot(voxel)];
  if (recent.voxel != voxel) {
    std::int32_t face = memo.tree.getValue(voxel);
    if (face < 0) {
      const Vec3 centre = (Vec3(voxel.x(), voxel.y(), voxel.z()) + Vec3::Constant(0.5)) * voxel_size_ + frame_.centre;
      face = static_cast<std::int32_t>(nearest(centre, memo.last).face);
      memo.last = static_cast<std::uint32_t>(face);
      if (memo.found.size() < most_found) memo.found.push_back({voxel, face});
    }
    recent = {voxel, face};
  }
  return static_cast<std::uint32_t>(recent.face);
}

double DistanceBand::reach(const Vec3& a, const Vec3& b, const Vec3& c, double tau, bool in_parts) {
  constexpr double unproved = std::numeric_limits<double>::infinity();
  // Depth first; each division replaces a piece by its halves across the longest edge, so the stack stays short.
  std::array<std::array<Vec3, 3>, 64> stack;
  std::size_t top = 0;
  stack[top++] = {a, b, c};
  // No two points within tau of one face are farther apart.
  const double widest = (2 * tau + widest_face_) * (2 * tau + widest_face_);
  double squared_reach = 0;
  for (int pieces = 0; top > 0; ++pieces) {
    if (pieces == max_pieces) return unproved;
    const std::array<Vec3, 3> piece = stack[--top];
    const auto& [p, q, r] = piece;
    const std::array<double, 3> length{(q - p).squaredNorm(), (r - q).squaredNorm(), (p - r).squaredNorm()};
    const auto i = static_cast<std::size_t>(std::max_element(length.begin(), length.end()) - length.begin());
    if (pieces == 0 ? !in_parts : length[i] <= widest) {
      const Proof proof = prove(piece, std::sqrt(length[i]), tau);
      if (proof.kind == Proof::refuted) return unproved;
      squared_reach = std::max(squared_reach, proof.squared_reach);
      if (proof.kind == Proof::proved) continue;
    }
    if (length[i] < smallest_piece * smallest_piece * tau * tau || top + 2 > stack.size()) return unproved;
    const Vec3& from = piece[i];
    const Vec3& to = piece[(i + 1) % 3];
    const Vec3& apex = piece[(i + 2) % 3];
    const Vec3 middle = 0.5 * (from + to);
    stack[top++] = {middle, to, apex};
    stack[top++] = {from, middle, apex};
  }
  return std::sqrt(squared_reach);
}

DistanceBand::Proof DistanceBand::prove(const std::array<Vec3, 3>& piece, double longest, double tau) {
  const Vec3 centre = (piece[0] + piece[1] + piece[2]) / 3;
  const std::uint32_t memo = near_face(centre);
  const TriangleDistance near = distance_from(memo);
  const double to_near = near.largest_squared(piece);
  if (to_near <= tau * tau) return {Proof::proved, to_near};
  // The memo knows one face for all pieces in a voxel.
  if (longest > voxel_size_ && near.squared(centre) <= tau * tau) return {Proof::open};
  const Near found = nearest(centre, memo);
  if (found.distance > tau) return {Proof::refuted};
  if (found.face == memo) return {Proof::open};
  const double to_found = distance_from(found.face).largest_squared(piece);
  return to_found <= tau * tau ? Proof{Proof::proved, to_found} : Proof{Proof::open};
}

void DistanceBand::set_voxel_size(double size) {
  const double allowed = std::max(size, smallest_voxel / frame_.scale);
  if (allowed == voxel_size_) return;
  absorb();
  voxel_size_ = allowed;
  memo_->threads.clear();  // what they remember is of the old voxels
  memo_->tree.clear();
}

void DistanceBand::absorb() {
  openvdb::tree::ValueAccessor<Tree, false> writer(memo_->tree);
  std::uint64_t found = 0;
  for (const Memo::Thread& memo : memo_->threads) {
    for (const Memo::Found& f : memo.found) writer.setValue(f.voxel, f.face);
    found += memo.found.size();
  }
  if (found == 0) return;
  memo_->filled += found;
  memo_->threads.clear();  // their accessors point into the tree that has just changed
  // Measuring it takes a walk over all of its nodes.
  memo_->unmeasured += found;
  if (memo_->unmeasured < measure_after) return;
  memo_->unmeasured = 0;
  if (memo_->tree.memUsage() > memo_limit) memo_->tree.clear();
}

}  // namespace prcage
