#include "tools/batch_progress.h"

#include <cmath>

#include <fmt/format.h>

#include "tools/cli_progress.h"

namespace prcage {

std::string duration_text(double seconds) {
  const long long whole = std::llround(seconds);
  if (whole < 100) return fmt::format("{} s", whole);
  const long long minutes = (whole + 30) / 60;
  if (minutes < 60) return fmt::format("{} min", minutes);
  return fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

BatchProgress::BatchProgress(const std::vector<BatchInput>& to_do) : meshes_(to_do.size()) {
  for (const BatchInput& input : to_do) weight_ += weight(input);
}

// Starting a process takes as long as a few kilobytes.
double BatchProgress::weight(const BatchInput& input) { return static_cast<double>(input.bytes) + 10000; }

void BatchProgress::finish(const BatchInput& input, const BatchRow& row) {
  const std::lock_guard lock(mutex_);
  ++done_;
  if (!has_cage(row.text("status"))) ++failed_;
  done_weight_ += weight(input);
}

std::string BatchProgress::line(double seconds) const {
  const std::lock_guard lock(mutex_);
  const double part = meshes_ == 0 ? 1 : static_cast<double>(done_) / static_cast<double>(meshes_);
  std::string text = fmt::format("{}  {}/{} meshes", progress_text(part), done_, meshes_);
  if (failed_ > 0) text += fmt::format(", {} without a cage", failed_);
  if (done_ == 0) return fmt::format("{}  {}", text, duration_text(seconds));
  const double left = seconds * (weight_ - done_weight_) / done_weight_;
  return fmt::format("{}  {:.3g} per minute  {}, {} left", text, 60 * static_cast<double>(done_) / seconds,
                     duration_text(seconds), duration_text(left));
}

std::string outcome_text(const BatchRow& row) {
  const std::string mesh = row.text("mesh");
  const std::string status = row.text("status");
  if (!has_cage(status)) {
    const std::string defects = row.text("defects");
    return fmt::format("{}: {}: {}", mesh, status, defects.empty() ? row.text("message") : defects);
  }
  const std::string unmeasured = row.text("evaluation_failure");
  return fmt::format("{}: {}: {} faces -> {} in {:.2f} s{}{}", mesh, status, std::get<std::int64_t>(row["input_faces"]),
                     std::get<std::int64_t>(row["cage_faces"]), std::get<double>(row["process_seconds"]),
                     unmeasured.empty() ? "" : ", not measured: ", unmeasured);
}

StatusCounts count_statuses(const BatchTable& table) {
  StatusCounts counts;
  table.for_each([&counts](const BatchRow& row) { ++counts[row.text("status")]; });
  return counts;
}

std::string summary_text(const StatusCounts& counts) {
  std::size_t rows = 0;
  std::size_t cages = 0;
  std::string lines;
  for (const auto& [status, count] : counts) {
    rows += count;
    if (has_cage(status)) cages += count;
    lines += fmt::format("  {:<28} {}\n", status, count);
  }
  const double percent = rows == 0 ? 100 : 100 * static_cast<double>(cages) / static_cast<double>(rows);
  return fmt::format("{} of {} meshes have a cage ({:.1f} %)\n{}", cages, rows, percent, lines);
}

}  // namespace prcage
