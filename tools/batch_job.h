// One mesh of a batch: `prcage cage` in a process of its own, `prcage eval` in another, and what became of it as a row
// of the table.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/batch_inputs.h"
#include "tools/batch_table.h"
#include "tools/child_process.h"
#include "tools/cli_options.h"

namespace prcage {

// The options of `prcage cage` that its result depends on, each written out, defaults too: the same arguments for the
// same cage, however they were given.
std::vector<std::string> cage_arguments(const CageCommand& command);

// What all jobs of a batch have in common.
struct BatchPlan {
  CageCommand cage;              // of each mesh; its paths mean nothing
  std::string settings;          // the options that a row depends on, as one text
  std::string extension;         // of the cages
  std::filesystem::path output;  // the directory of table and cages
  double timeout_seconds = 0;
  std::uint64_t memory_limit_mb = 0;
  bool evaluates = true;
};

// How many meshes at a time, and threads for each.
struct CoreShare {
  std::size_t jobs = 1;
  int threads = 1;
};

// Shares the cores among the meshes: one for each while there are enough meshes, several for each if not. What is not 0
// in `jobs` and `threads` is as asked for.
CoreShare share_cores(int cores, std::size_t meshes, int jobs, int threads);

class BatchJob {
 public:
  // Works in `scratch`, a directory that is not there yet, and removes it in the end. Throws
  // std::filesystem::filesystem_error or std::system_error if the process cannot be started.
  BatchJob(const BatchPlan& plan, BatchInput input, std::filesystem::path scratch);
  ~BatchJob();
  BatchJob(const BatchJob&) = delete;
  BatchJob& operator=(const BatchJob&) = delete;

  const BatchInput& input() const { return input_; }

  // The row, once, when the mesh is done and its cage is in place. To be called often. Throws
  // std::filesystem::filesystem_error if the cage cannot be put in place.
  std::optional<BatchRow> poll();

 private:
  std::filesystem::path unplaced_cage() const { return scratch_ / ("cage" + plan_.extension); }
  ChildCommand child(const char* name, std::vector<std::string> arguments) const;
  ChildCommand cage_child() const;
  ChildCommand evaluation_child() const;
  void record_cage(const ChildEnd& end);
  void record_evaluation(const ChildEnd& end);
  void place_cage();

  const BatchPlan& plan_;
  BatchInput input_;
  std::filesystem::path scratch_;
  std::unique_ptr<ChildProcess> child_;
  bool evaluating_ = false;
  BatchRow row_;
};

}  // namespace prcage
