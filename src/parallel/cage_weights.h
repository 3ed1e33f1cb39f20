// Mean value coordinates of many points, row by row: the cage in the form that the kernels want, the loop over blocks
// of points on all threads, and the weighted mean that a row stands for. Must be called inside an Arena.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/mean_value.h"
#include "core/vec3.h"
#include "parallel/parallel_for.h"

namespace prcage {

// A cage and all that the weights need to know of it.
class BoundCage {
 public:
  // Returns why there are no weights with respect to this cage, a clause for people, or nothing.
  std::string build(const Mesh& cage);

  // Numbers in a row: one for each vertex of the cage, zero for those that no face names.
  std::size_t row_size() const { return row_size_; }

  // body(first, count, rows) for blocks of points, always the same ones, with a row for each point of a block one after
  // the other. Rows are only good during the call.
  template <class Body>
  void for_each_block(std::span<const Position> points, const Body& body) const {
    const std::size_t blocks = block_count(points.size());
    parallel_each(blocks, 1, [&](std::size_t block) {
      const std::size_t first = block * block_size;
      const std::span<const Position> part = points.subspan(first, std::min(block_size, points.size() - first));
      const std::vector<double> rows = weights_of(part);
      body(first, part.size(), std::span<const double>(rows));
    });
  }

  static std::size_t block_count(std::size_t points) { return (points + block_size - 1) / block_size; }
  static constexpr std::size_t block_size = 128;

 private:
  std::vector<double> weights_of(std::span<const Position> points) const;
  MeanValueCage arrays() const;

  double scale_ = 1;  // a power of two: nothing is rounded
  std::size_t row_size_ = 0;
  std::vector<std::uint32_t> column_;  // of each vertex in use
  std::vector<Position> position_;     // scaled
  std::vector<Triangle> corner_;
  std::vector<Triangle> opposite_;
  std::vector<std::array<std::uint32_t, 2>> edge_;
};

// The positions of a cage as rows are multiplied with them: from the centre of the cage, so that what the sum of a row
// lacks of 1 is not multiplied with the distance from the origin.
class CagePose {
 public:
  explicit CagePose(std::span<const Position> positions);

  // Weighted mean of all vertices, or of those that `columns` names. The order of the sum depends on their number only.
  template <class Weight>
  Position mean(std::span<const Weight> weights) const {
    return sum(weights, [](std::size_t i) { return i; });
  }
  template <class Weight>
  Position mean(std::span<const Weight> weights, std::span<const std::uint32_t> columns) const {
    return sum(weights, [columns](std::size_t i) { return columns[i]; });
  }

 private:
  // Four sums at a time.
  template <class Weight, class Column>
  Position sum(std::span<const Weight> weights, const Column& column) const {
    constexpr std::size_t lanes = 4;
    double partial[3][lanes] = {};
    const auto add = [&](std::size_t i, std::size_t lane) {
      for (std::size_t k = 0; k < 3; ++k)
        partial[k][lane] += static_cast<double>(weights[i]) * coordinate_[k][column(i)];
    };
    const std::size_t whole = weights.size() / lanes * lanes;
    for (std::size_t i = 0; i < whole; i += lanes)
      for (std::size_t lane = 0; lane < lanes; ++lane) add(i + lane, lane);
    for (std::size_t i = whole; i < weights.size(); ++i) add(i, i - whole);
    Position result;
    for (std::size_t k = 0; k < 3; ++k)
      result[k] = centre_[k] + ((partial[k][0] + partial[k][2]) + (partial[k][1] + partial[k][3]));
    return result;
  }

  Position centre_;
  std::vector<double> coordinate_[3];
};

}  // namespace prcage
