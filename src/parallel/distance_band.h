// Distance to the input inside a narrow band: the d(c_f, M) of eq. 4 and the proof behind strict tau.
//
// nearest() is exact and gives eq. 4 its distances. The proof asks for many points at once and is content with a face
// near by: a sparse OpenVDB grid remembers, per voxel, the input face closest to the voxel's centre. The distance to
// that face is an upper bound of the distance to the input, exceeding it by at most the voxel's diagonal;
// over-estimates only cost more pieces, an under-estimate cannot happen. The grid is a memo of a pure function: it is
// filled where queries fall, by closest-point queries on Embree, and what it returns does not depend on what it already
// holds. So results are the same for any number of threads, and memory follows the cage's surface.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "parallel/closest_face.h"

namespace prcage {

class DistanceBand {
 public:
  // The surface must outlive the band.
  explicit DistanceBand(const SurfaceTree& surface);
  ~DistanceBand();

  using Near = ClosestFace::Near;

  // A face near x by the memo: an upper bound of the distance, at most voxel diagonal too large. Thread-safe.
  Near near(const Vec3& x);
  std::uint32_t near_face(const Vec3& x);
  // The nearest face, lowest number among equals; a face that is near already saves time. Thread-safe.
  Near nearest(const Vec3& x, std::uint32_t hint = none) const { return closest_.nearest(x, hint); }
  double distance_to_face(const Vec3& x, std::uint32_t face) const { return closest_.distance_to_face(x, face); }
  TriangleDistance distance_from(std::uint32_t face) const { return closest_.distance_from(face); }
  Vec3 nearest_point(const Vec3& x, std::uint32_t face) const { return closest_.nearest_point(x, face); }
  Vec3 area_normal(std::uint32_t face) const { return closest_.area_normal(face); }
  bool behind_face(const Vec3& x, std::uint32_t face) const { return closest_.behind_face(x, face); }

  // An upper bound of the distance of the points of triangle abc to the input, infinity if it is not proved to be at
  // most tau. The distance to one face is convex, so a piece whose corners are within tau of one common face is proved;
  // other pieces are divided. `in_parts` says that the face near the centroid has been tried and leaves the answer
  // open. Thread-safe.
  double reach(const Vec3& a, const Vec3& b, const Vec3& c, double tau, bool in_parts = false);

  // Voxel edge length for the queries to come; forgets what was remembered at another one. Not thread-safe.
  void set_voxel_size(double size);
  // Takes over what the threads found since the last call. Not thread-safe; to be called between stages.
  void absorb();

  std::uint64_t voxels_filled() const;

 private:
  struct Memo;  // keeps OpenVDB out of this header
  struct Proof {
    enum Kind { proved, open, refuted } kind;
    double squared_reach = 0;  // if proved
  };

  Proof prove(const std::array<Vec3, 3>& piece, double longest, double tau);

  ClosestFace closest_;
  UnitFrame frame_;
  double voxel_size_ = 1;
  double widest_face_ = 0;  // longest edge of the input
  std::unique_ptr<Memo> memo_;
};

}  // namespace prcage
