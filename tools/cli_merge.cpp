// prcage merge: one table from those of the shards of a batch.
#include <unistd.h>

#include <filesystem>
#include <set>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "tools/batch_progress.h"
#include "tools/batch_table.h"
#include "tools/cli_commands.h"
#include "tools/cli_files.h"

namespace prcage {
namespace {

namespace fs = std::filesystem;

fs::path directory_of(const std::string& table) { return fs::absolute(table).lexically_normal().parent_path(); }

// Paths of cages are relative to the table that names them.
void rebase_cage(BatchRow& row, const fs::path& from, const fs::path& to) {
  const std::string cage = row.text("cage_file");
  if (!cage.empty()) row.set("cage_file", (from / cage).lexically_normal().lexically_proximate(to).string());
}

class Merge {
 public:
  explicit Merge(const MergeCommand& command)
      : command_(command), unfinished_(fmt::format("{}.{}.tmp", command.output, getpid())) {}

  ~Merge() {
    std::error_code ignored;
    fs::remove(unfinished_, ignored);
  }
  Merge(const Merge&) = delete;
  Merge& operator=(const Merge&) = delete;

  // The new table appears when it is complete.
  ExitCode run() {
    if (fs::exists(command_.output)) {
      print_error(fmt::format("{} is there already: remove it, or name another file", command_.output));
      return ExitCode::cannot_write;
    }
    if (!settings_agree()) return ExitCode::cannot_read;
    if (!writable(command_.output)) return ExitCode::cannot_write;
    unite();
    fs::rename(unfinished_, command_.output);
    return ExitCode::ok;
  }

 private:
  bool settings_agree() const {
    std::string first_settings, first_table;
    for (const std::string& path : command_.tables) {
      const BatchTable table(path, BatchTable::Open::existing);
      for (const std::string& settings : table.settings()) {
        if (first_table.empty()) {
          first_settings = settings;
          first_table = path;
        }
        if (settings == first_settings || command_.mix_settings) continue;
        print_error(
            fmt::format("the tables were made with different settings; --mix-settings accepts that\n"
                        "  {}: {}\n  {}: {}",
                        first_table, first_settings, path, settings));
        return false;
      }
    }
    return true;
  }

  void unite() {
    BatchTable merged(unfinished_, BatchTable::Open::or_create);
    merged.atomically([&] {
      for (const std::string& path : command_.tables) add(merged, path);
    });
    report(merged);
  }

  // A mesh that an earlier table has, too, stays as it was there.
  void add(BatchTable& merged, const std::string& path) {
    const BatchTable table(path, BatchTable::Open::existing);
    table.for_each([&](BatchRow row) {
      if (const auto earlier = merged.find(row.text("mesh"), row.text("settings"))) {
        note_duplicate(*earlier, row, path);
        return;
      }
      rebase_cage(row, directory_of(path), directory_of(command_.output));
      merged.put(row);
    });
  }

  void note_duplicate(const BatchRow& kept, const BatchRow& passed_over, const std::string& path) {
    ++duplicates_;
    const bool same = kept["status"] == passed_over["status"] && kept["cage_faces"] == passed_over["cage_faces"];
    fmt::print(stderr, "prcage: {} of {} is there twice{}; the first is kept\n", passed_over.text("mesh"), path,
               same ? "" : ", with another result");
  }

  void report(const BatchTable& merged) const {
    fmt::print(stderr, "{}", summary_text(count_statuses(merged)));
    fmt::print(stderr, "{} duplicates; table: {}\n", duplicates_, command_.output);
  }

  const MergeCommand& command_;
  std::string unfinished_;
  std::size_t duplicates_ = 0;
};

}  // namespace

ExitCode run(const MergeCommand& command) {
  try {
    return Merge(command).run();
  } catch (const BatchTableError& error) {
    print_error(error.what());
    return ExitCode::cannot_read;
  } catch (const fs::filesystem_error& error) {
    print_error(error);
    return ExitCode::cannot_write;
  }
}

}  // namespace prcage
