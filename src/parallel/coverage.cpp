#include "parallel/coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/area_samples.h"
#include "core/round_outward.h"
#include "parallel/closest_face.h"
#include "parallel/parallel_for.h"

namespace prcage {

CoverageSamples samples_of(const Mesh& surface, std::size_t most_vertices, std::size_t spread) {
  CoverageSamples samples;
  const std::size_t stride = (surface.positions.size() + most_vertices - 1) / most_vertices;
  for (std::size_t v = 0; v < surface.positions.size(); v += stride) samples.points.push_back(surface.positions[v]);
  const AreaSamples over_area(surface.positions, surface.triangles, spread, CounterRandom(0, 0));
  for (std::size_t i = 0; i < over_area.size(); ++i) samples.points.push_back(position(over_area[i].point));
  return samples;
}

Coverage::Coverage(CoverageSamples samples)
    : sample_(std::move(samples.points)),
      margin_(samples.margin),
      room_(std::move(samples.room)),
      least_share_(samples.least_share),
      distance_(sample_.size()),
      next_(sample_.size()),
      face_(sample_.size()),
      face_distance_(sample_.size()) {}

void Coverage::assign(const CageState& state, const UnitFrame& frame, const TreeDevice& device) {
  const CornerTable& mesh = state.mesh;
  std::vector<Triangle> triangles(mesh.face_slots());
  for (std::size_t f = 0; f < triangles.size(); ++f) std::copy_n(&mesh.corner_vertex[3 * f], 3, triangles[f].begin());
  std::vector<std::uint8_t> alive(triangles.size());
  for (std::uint32_t f = 0; f < triangles.size(); ++f) alive[f] = mesh.face_alive(f) ? 1 : 0;
  SurfaceTree tree(device);
  tree.build(frame, mesh.position, triangles, alive);
  const ClosestFace closest(tree);
  parallel_chunks(sample_.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::uint32_t hint = none;  // samples lie along a curve
    for (std::size_t s = begin; s < end; ++s) {
      const ClosestFace::Near near = closest.nearest(vec(sample_[s]), hint);
      hint = face_[s] = near.face;
      distance_[s] = float_above(near.distance);
    }
  });
  first_.assign(triangles.size(), none);
  for (std::uint32_t s = 0; s < sample_.size(); ++s) {
    next_[s] = first_[face_[s]];
    first_[face_[s]] = s;
  }
}

void Coverage::renumber(std::span<const std::uint32_t> old_faces) {
  std::vector<std::uint32_t> first(old_faces.size());
  for (std::size_t f = 0; f < first.size(); ++f) first[f] = first_[old_faces[f]];
  first_ = std::move(first);
}

double Coverage::bound_of(std::uint32_t sample, double bound) const {
  return room_.empty() ? bound : std::clamp<double>(room_[sample], least_share_ * bound, bound);
}

bool Coverage::keeps_samples(const CageState& state, double bound, const PatchBatch& batch, std::size_t i) {
  struct NewFace {
    std::uint32_t number;
    TriangleDistance distance;
  };
  std::vector<NewFace> faces;
  for (std::size_t t = batch.first_face[i]; t < batch.first_face[i + 1]; ++t) {
    const TriangleRef p = patch_triangle(state.mesh, batch, t);
    const auto at = [&](int k) { return Vec3(p.p[k][0], p.p[k][1], p.p[k][2]); };
    faces.push_back({batch.face[t], TriangleDistance(at(0), at(1), at(2))});
  }
  double& rise = rise_[i] = 0;
  for (const std::uint32_t f : batch.removed_faces(i)) {
    for (std::uint32_t s = first_[f]; s != none; s = next_[s]) {
      double least = std::numeric_limits<double>::infinity();
      for (const NewFace& face : faces) {
        const double d = face.distance.squared(vec(sample_[s]));
        if (d < least) {
          least = d;
          face_[s] = face.number;
        }
      }
      face_distance_[s] = float_above(std::sqrt(least));
      if (face_distance_[s] > std::max<double>(bound_of(s, bound), distance_[s])) return false;
      rise += least - double{distance_[s]} * distance_[s];
    }
  }
  return true;
}

void Coverage::test(const CageState& state, double bound, PatchBatch& batch) {
  bound = std::max(bound - margin_, 0.5 * bound);
  rise_.resize(batch.size());
  parallel_each(batch.size(), 1, [&](std::size_t i) {
    if (batch.alive(i) && !keeps_samples(state, bound, batch, i)) batch.verdict[i] = Verdict::uncovers_input;
  });
}

void Coverage::commit(const PatchBatch& batch) {
  parallel_each(batch.size(), 16, [&](std::size_t i) {
    if (!batch.alive(i)) return;
    std::uint32_t samples = none;  // of all removed faces, in one list
    for (const std::uint32_t f : batch.removed_faces(i)) {
      for (std::uint32_t s = first_[f], next = none; s != none; s = next) {
        next = next_[s];
        next_[s] = samples;
        samples = s;
      }
      first_[f] = none;
    }
    for (std::uint32_t s = samples, next = none; s != none; s = next) {
      next = next_[s];
      distance_[s] = face_distance_[s];
      next_[s] = first_[face_[s]];
      first_[face_[s]] = s;
    }
  });
}

}  // namespace prcage
