// How far a batch is: the line of its progress bar, the lines of a log, and the summary at the end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "tools/batch_inputs.h"
#include "tools/batch_table.h"

namespace prcage {

// "45 s", "12 min", "3 h 05 min".
std::string duration_text(double seconds);

// Counts what is done. Thread-safe, as a progress bar asks from a thread of its own.
class BatchProgress {
 public:
  explicit BatchProgress(const std::vector<BatchInput>& to_do);

  void finish(const BatchInput& input, const BatchRow& row);

  // Meshes done, rate, time left. The estimate takes time to be in proportion to the size of the files, which matters
  // because the large ones come first.
  std::string line(double seconds) const;

 private:
  static double weight(const BatchInput& input);

  mutable std::mutex mutex_;
  std::size_t meshes_ = 0;
  std::size_t done_ = 0;
  std::size_t failed_ = 0;
  double weight_ = 0;
  double done_weight_ = 0;
};

// What became of one mesh, one line without its end.
std::string outcome_text(const BatchRow& row);

// Number of rows of each status.
using StatusCounts = std::map<std::string, std::size_t>;
StatusCounts count_statuses(const BatchTable& table);

// The share of meshes with a cage, then the number of each status, a line each.
std::string summary_text(const StatusCounts& counts);

}  // namespace prcage
