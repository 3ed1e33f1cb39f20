// Points spread over a surface evenly by area, for the measures that the paper takes by sampling.
//
// The area, faces in a row, is cut into as many equal parts as there are points, and each part gets one at random:
// as uniform as independent points, with less noise in every mean, and points of neighbouring numbers are close to each
// other. Each point is a function of the surface, the number of points, the random numbers and its own number alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/counter_random.h"
#include "core/vec3.h"

namespace prcage {

class AreaSamples {
 public:
  struct Sample {
    Vec3 point;
    std::uint32_t face;
  };

  // Borrows the arrays. Faces may be degenerate, but there must be some area.
  AreaSamples(std::span<const Position> positions, std::span<const Triangle> triangles, std::size_t count,
              const CounterRandom& random);

  std::size_t size() const { return count_; }
  Sample operator[](std::size_t i) const;

 private:
  std::uint32_t face_at(double area) const;

  std::span<const Position> positions_;
  std::span<const Triangle> triangles_;
  std::vector<double> area_up_to_;  // of the faces 0 .. f
  std::size_t count_;
  CounterRandom random_;
};

}  // namespace prcage
