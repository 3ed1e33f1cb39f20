// Placement problems of real runs in a file: what the benchmark of the QP solver solves. The generator is
// record_qps.cpp; the files are made anew by every build and are no format for anybody else.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/qp3.h"

namespace prcage::perf {

// Problems in structure-of-arrays form, as the solver gets them: unit trace, local frames.
struct QpProblems {
  std::vector<Symmetric3> form;
  std::vector<Vec3> linear;
  std::vector<std::uint32_t> first_plane{0};  // planes of problem i: [first_plane[i], first_plane[i + 1])
  std::vector<double> nx, ny, nz, offset;

  std::size_t size() const { return form.size(); }
  std::size_t plane_count(std::size_t i) const { return first_plane[i + 1] - first_plane[i]; }
  PlaneArrays planes(std::size_t i) const {
    const std::size_t k = first_plane[i];
    return {nx.data() + k, ny.data() + k, nz.data() + k, offset.data() + k, plane_count(i)};
  }
  void add(const Symmetric3& problem_form, const Vec3& problem_linear, const PlaneArrays& planes);
};

// Both throw std::runtime_error.
void write_qps(const std::string& path, const QpProblems& problems);
QpProblems read_qps(const std::string& path);

}  // namespace prcage::perf
