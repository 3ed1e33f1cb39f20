// Placement problems of real runs in a file: what the benchmark of the QP solver solves. The generator is
// record_qps.cpp; the files are made anew by every build and are no format for anybody else.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include <tbb/cache_aligned_allocator.h>

#include "core/qp3.h"

namespace prcage::perf {

// Problems in structure-of-arrays form, as the solver gets them: unit trace, local frames.
struct QpProblems {
  std::vector<Symmetric3> form;
  std::vector<Vec3> linear;
  std::vector<std::uint32_t> first_row, row_length;  // see Qp3Batch
  std::vector<double, tbb::cache_aligned_allocator<double>> rows;
  std::vector<std::uint32_t> plane_count;  // of those that are no padding

  std::size_t size() const { return form.size(); }
  SlabRows planes(std::size_t i) const { return {rows.data() + first_row[i], row_length[i]}; }
  std::size_t all_planes() const { return std::accumulate(plane_count.begin(), plane_count.end(), std::size_t{0}); }
  void clear();  // keeps its memory
  void add(const Symmetric3& problem_form, const Vec3& problem_linear, const SlabRows& slabs, std::size_t planes);
};

// Both throw std::runtime_error.
void write_qps(const std::string& path, const QpProblems& problems);
QpProblems read_qps(const std::string& path);

}  // namespace prcage::perf
