// prcage batch: the cages of a whole directory. Each mesh is a process of its own, so that a crash, an endless run or
// one that eats the memory costs that mesh only; what became of it is a row of a table that survives a kill at any
// moment.
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <system_error>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "tools/batch_job.h"
#include "tools/batch_progress.h"
#include "tools/batch_table.h"
#include "tools/child_process.h"
#include "tools/cli_commands.h"
#include "tools/cli_files.h"
#include "tools/cli_progress.h"

namespace prcage {
namespace {

namespace fs = std::filesystem;

// Why a batch does not even begin; the remedy included.
struct Refusal {
  ExitCode code;
  std::string message;
};

// The directory of the processes' files while a batch runs. Only one batch at a time can have it; what one that was
// killed has left in it is removed.
class Scratch {
 public:
  explicit Scratch(fs::path directory) : directory_(std::move(directory)) {
    fs::create_directories(directory_);
    lock();
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory_)) {
      if (entry.path() != lock_file()) fs::remove_all(entry.path(), ignored);
    }
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(directory_, ignored);
    close(lock_);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  // A new name at each call, also of another batch that was killed and whose processes are not gone yet.
  fs::path next() { return directory_ / fmt::format("{}-{}", getpid(), count_++); }

 private:
  fs::path lock_file() const { return directory_ / "lock"; }

  void lock() {
    lock_ = open(lock_file().c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (lock_ < 0) {
      throw fs::filesystem_error("cannot create", lock_file(), std::error_code(errno, std::generic_category()));
    }
    if (flock(lock_, LOCK_EX | LOCK_NB) == 0) return;
    close(lock_);
    throw Refusal{ExitCode::cannot_write, fmt::format("{} belongs to a batch that runs now", directory_.string())};
  }

  fs::path directory_;
  int lock_ = -1;
  std::size_t count_ = 0;
};

std::string extension_of(MeshFormat format) {
  const std::string name = to_string(format);
  return "." + name.substr(0, name.find('-'));
}

bool lies_within(const fs::path& path, const fs::path& directory) {
  const fs::path steps = fs::weakly_canonical(path).lexically_relative(fs::weakly_canonical(directory));
  return !steps.empty() && *steps.begin() != "..";
}

bool is_worth_a_line(const BatchRow& row) {
  return !has_cage(row.text("status")) || !row.text("evaluation_failure").empty();
}

class Batch {
 public:
  explicit Batch(const BatchCommand& command) : command_(command) {
    plan_.cage = command.cage;
    plan_.evaluates = !command.no_eval;
    plan_.settings =
        fmt::format("{}{}", fmt::join(cage_arguments(command.cage), " "), command.no_eval ? " --no-eval" : "");
    plan_.extension = extension_of(command.cage.format);
    plan_.output = command.output;
    plan_.timeout_seconds = command.timeout;
    plan_.memory_limit_mb = command.memory_limit_mb;
  }

  ExitCode run() {
    std::vector<BatchInput> inputs = shard_of(find_inputs(), command_.shard);
    fs::create_directories(plan_.output);
    scratch_.emplace(named(".work"));
    table_.emplace(named(".sqlite"), BatchTable::Open::or_create);
    choose_work(std::move(inputs));
    if (!work()) {
      print_error(fmt::format("interrupted; the same command with --resume goes on with {}", named(".sqlite")));
      return ExitCode::interrupted;
    }
    return conclude();
  }

 private:
  // Files of this shard.
  std::string named(const char* extension) const {
    const Shard& shard = command_.shard;
    const std::string part = shard.count == 1 ? "" : fmt::format("-{}-of-{}", shard.index, shard.count);
    return plan_.output / fmt::format("batch{}{}", part, extension);
  }

  std::vector<BatchInput> find_inputs() const {
    if (fs::is_directory(command_.input) && lies_within(command_.input, command_.output)) {
      throw Refusal{ExitCode::usage,
                    fmt::format("the cages would go among the meshes of {}: name another directory", command_.input)};
    }
    try {
      std::vector<BatchInput> inputs = find_batch_inputs(command_.input, command_.output);
      if (!inputs.empty()) return inputs;
    } catch (const fs::filesystem_error& error) {
      throw Refusal{ExitCode::cannot_read, fmt::format("{}: {}", error.path1().string(), error.code().message())};
    }
    throw Refusal{ExitCode::cannot_read, fmt::format("{}: no meshes (.ply, .obj, .stl, .off)", command_.input)};
  }

  // What the table does not have yet, if the table is one of this batch.
  void choose_work(std::vector<BatchInput> inputs) {
    const std::set<std::string> settings = table_->settings();
    for (const std::string& other : settings) {
      if (other != plan_.settings) {
        refuse_table(
            fmt::format("has results of other settings: repeat them, or name another directory\n"
                        "  there: {}\n  asked: {}",
                        other, plan_.settings));
      }
    }
    if (!settings.empty() && !command_.resume) {
      refuse_table("has results already: add --resume to go on with it, or name another directory");
    }
    // By all meshes, not by those that are left: times before and after a resumption can then be compared.
    share_ = share_cores(std::max(1, static_cast<int>(std::thread::hardware_concurrency())), inputs.size(),
                         command_.jobs, plan_.cage.options.threads);
    plan_.cage.options.threads = share_.threads;
    std::erase_if(inputs, [this](const BatchInput& input) { return is_done(input); });
    order_by_size(inputs);
    to_do_ = std::move(inputs);
  }

  bool is_done(const BatchInput& input) const {
    const std::optional<BatchRow> row = table_->find(input.mesh, plan_.settings);
    if (!row) return false;
    if (row->text("input_file") != input.file) {
      refuse_table(
          fmt::format("has results of {} for {}: name another directory", row->text("input_file"), input.file));
    }
    return has_cage(row->text("status")) || !command_.retry_failed;
  }

  [[noreturn]] void refuse_table(const std::string& why) const {
    throw Refusal{ExitCode::cannot_write, fmt::format("{} {}", named(".sqlite"), why)};
  }

  // False if it was interrupted: the meshes under way leave no trace.
  bool work() {
    const SignalWait signals;  // before there is another thread
    BatchProgress progress(to_do_);
    std::optional<ProgressBar> bar;
    draws_ = !command_.quiet && !command_.progress && isatty(STDERR_FILENO) != 0;
    if (draws_) bar.emplace([&progress](double seconds) { return progress.line(seconds); });
    std::vector<std::unique_ptr<BatchJob>> running;
    std::size_t next = 0;
    while (next < to_do_.size() || !running.empty()) {
      while (next < to_do_.size() && running.size() < share_.jobs) {
        running.push_back(std::make_unique<BatchJob>(plan_, to_do_[next++], scratch_->next()));
      }
      if (signals.stop_requested_within(std::chrono::milliseconds(100))) return false;
      std::erase_if(running, [&](const auto& job) { return finished(*job, progress); });
    }
    return true;
  }

  bool finished(BatchJob& job, BatchProgress& progress) {
    const std::optional<BatchRow> row = job.poll();
    if (!row) return false;
    table_->put(*row);
    progress.finish(job.input(), *row);
    if (command_.progress) {
      fmt::print(stderr, "{}  {}\n", progress.line(timer_.seconds()), outcome_text(*row));
    } else if (!command_.quiet && is_worth_a_line(*row)) {
      fmt::print(stderr, "{}{}\n", draws_ ? "\r\x1b[K" : "", outcome_text(*row));
    }
    return true;
  }

  ExitCode conclude() const {
    const StatusCounts counts = count_statuses(*table_);
    if (!command_.quiet) {
      fmt::print(stderr, "{}{} made in {}; table: {}\n", summary_text(counts), to_do_.size(),
                 duration_text(timer_.seconds()), named(".sqlite"));
    }
    for (const auto& [status, count] : counts) {
      if (!has_cage(status)) return ExitCode::some_failed;
    }
    return counts.contains(to_string(Status::face_budget_not_reached)) ? ExitCode::face_budget_not_reached
                                                                       : ExitCode::ok;
  }

  BatchCommand command_;
  Timer timer_;
  BatchPlan plan_;
  std::optional<Scratch> scratch_;
  std::optional<BatchTable> table_;
  CoreShare share_;
  bool draws_ = false;  // a progress bar, in the way of other lines
  std::vector<BatchInput> to_do_;
};

}  // namespace

ExitCode run(const BatchCommand& command) {
  try {
    return Batch(command).run();
  } catch (const Refusal& refusal) {
    print_error(refusal.message);
    return refusal.code;
  } catch (const BatchTableError& error) {
    print_error(error.what());
  } catch (const fs::filesystem_error& error) {
    print_error(error);
  }
  return ExitCode::cannot_write;
}

}  // namespace prcage
