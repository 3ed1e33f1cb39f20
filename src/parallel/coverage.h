// The other direction: how far the input is from the cage. Collapses bridge hollows and let thin parts of a cage shrink
// away without any point of the cage leaving the band. So each face of the cage carries the samples of the input that
// are near it; an operation that would take one of them out of the bound is refused, and those that stay are handed on
// to the faces that replace theirs.
//
// Samples are vertices of the input, all of them or an even choice of many, and points spread over its area; between
// them nothing is proved.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "parallel/patches.h"

namespace prcage {

struct CoverageSamples {
  std::vector<Position> points;
  // Distances are kept below the bound by so much, as far as that leaves half of it: for what is between the samples.
  double margin = 0;
  // Where it is not empty: of each sample, how far it may be, unless that is less than this share of the bound.
  std::vector<float> room;
  double least_share = 1;
};

// Up to so many of the vertices, in steps of equal length, which is even over a surface that lies along a curve, and so
// many points spread evenly by area, at least one, over a surface that has some.
CoverageSamples samples_of(const Mesh& surface, std::size_t most_vertices, std::size_t spread);

class Coverage {
 public:
  explicit Coverage(CoverageSamples samples);

  // Gives each sample to the face of the cage nearest to it. Needed before anything else, and again whenever faces have
  // got new numbers, unless renumber() is called.
  void assign(const CageState& state, const UnitFrame& frame, const TreeDevice& device);
  bool assigned() const { return !first_.empty(); }
  // Leaves samples with their faces, which have got new numbers: what was old_faces[i] is now i.
  void renumber(std::span<const std::uint32_t> old_faces);

  // Rejects patches that take a sample farther than `bound` from the faces that it comes to, and farther than it was.
  // Patches of a batch replace different faces.
  void test(const CageState& state, double bound, PatchBatch& batch);
  // Of the patches that were tested last: by how much the squares of the distances of their samples would rise, in sum.
  const std::vector<double>& rise() const { return rise_; }
  // Hands on the samples of the accepted patches that were tested last.
  void commit(const PatchBatch& batch);

  std::size_t size() const { return sample_.size(); }
  // visit(x) for each sample of the face.
  template <class Visit>
  void for_each_sample(std::uint32_t face, const Visit& visit) const {
    for (std::uint32_t s = first_[face]; s != none; s = next_[s]) visit(vec(sample_[s]));
  }

 private:
  double bound_of(std::uint32_t sample, double bound) const;
  bool keeps_samples(const CageState& state, double bound, const PatchBatch& batch, std::size_t i);

  std::vector<Position> sample_;
  double margin_ = 0;
  std::vector<float> room_;  // empty: no matter
  double least_share_ = 1;
  std::vector<float> distance_;       // of each sample to its face
  std::vector<std::uint32_t> next_;   // sample: the next one of the same face, or none
  std::vector<std::uint32_t> first_;  // face: its first sample, or none
  std::vector<std::uint32_t> face_;   // sample: where it goes if the patch is accepted
  std::vector<float> face_distance_;  // and how far it is from there
  std::vector<double> rise_;          // of each patch
};

}  // namespace prcage
