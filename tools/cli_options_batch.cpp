// The options of prcage batch, merge and report: many meshes, and the tables of what became of them.
#include <charconv>
#include <memory>
#include <optional>
#include <string>

#include "tools/cli_command_options.h"
#include "tools/cli_option_groups.h"

namespace prcage {
namespace {

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  const bool slash = index.ec == std::errc{} && index.ptr != end && *index.ptr == '/';
  const auto count = slash ? std::from_chars(index.ptr + 1, end, shard.count) : index;
  const bool whole = slash && count.ec == std::errc{} && count.ptr == end;
  if (whole && shard.index >= 1 && shard.index <= shard.count) return shard;
  refuse("--shard", fmt::format("'{}' is not I/N, part I of N, I from 1 to N", text));
}

// How a batch goes about its work; none of it decides on a cage.
void add_work(CLI::App& app, BatchCommand& command) {
  add_count(app, "--jobs", command.jobs, {0, 4096}, "Meshes at a time; 0: as many as have a core for each thread [0]");
  add_count(app, "--threads", command.cage.options.threads, {0, 4096},
            "Threads for each mesh; 0: cores divided by jobs [0]");
  add_ratio(app, "--timeout", command.timeout, 1e9, "Seconds for each process, then it is given up [none]");
  add_count(app, "--memory-limit", command.memory_limit_mb, {1, 1 << 30},
            "Megabytes of address space for each process [none]");
  add_parsed(app, "--shard", command.shard, &parse_shard, "I/N",
             "Only part I of N, with a table of its own; see prcage merge");
}

void add_progress(CLI::App& app, BatchCommand& command) {
  const AddedOption resume =
      add_flag(app, "--resume", command.resume, "Go on with a batch that was ended: only what is not in the table");
  add_flag(app, "--retry-failed", command.retry_failed, "With --resume: again those without a cage, too").needs(resume);
  const AddedOption progress =
      add_flag(app, "--progress", command.progress, "A line for each mesh instead of a progress bar, as for a log");
  add_flag(app, "--quiet", command.quiet, "No progress, no failures, no summary; errors are still printed")
      .excludes(progress);
}

}  // namespace

void add_batch(CLI::App& app, std::optional<Command>& chosen) {
  struct Parsed {
    BatchCommand command;
    std::optional<MeshFormat> format;
  };
  const auto parsed = std::make_shared<Parsed>();
  BatchCommand& command = parsed->command;
  add_argument(app, "INPUT", command.input,
               "Directory with meshes at any depth, or a text file with\na path on each line")
      .required();
  add_text(app, "-o,--output", command.output, "DIR", "Directory for the cages and their table (required)").required();
  add_cage_settings(app, command.cage);
  add_format(app, parsed->format).described("Format of the cages: ply, ply-ascii, obj, stl, stl-ascii, off [ply]");
  add_work(app, command);
  add_flag(app, "--no-eval", command.no_eval, "Do not measure the cages: no distances, normals, angles in the table");
  add_progress(app, command);
  when_parsed(app, [&app, parsed, &command, &chosen] {
    find_thickness_if_free(app, command.cage.options);
    command.cage.format = parsed->format.value_or(MeshFormat::ply_binary);
    chosen = command;
  });
}

void add_merge(CLI::App& app, std::optional<Command>& chosen) {
  const auto command = std::make_shared<MergeCommand>();
  add_arguments(app, "TABLES", command->tables, "Tables of prcage batch").required();
  add_text(app, "-o,--output", command->output, "TABLE", "Table to write (required); must not be there yet").required();
  add_flag(app, "--mix-settings", command->mix_settings, "Accept tables that were made with different settings");
  when_parsed(app, [command, &chosen] { chosen = *command; });
}

void add_report(CLI::App& app, std::optional<Command>& chosen) {
  const auto command = std::make_shared<ReportCommand>();
  add_argument(app, "TABLE", command->table, "Table of prcage batch or merge; it is only read").required();
  add_text(app, "-o,--output", command->output, "OUTPUT", "HTML page to write (required); - is standard output")
      .required();
  add_text(app, "--title", command->title, "TITLE", "Title of the page [the name of the table]");
  add_count(app, "--models", command->models, {0, 10000},
            "Models to show in 3D, the worst first, up to 10000 [24];\neach takes less than a megabyte of the page");
  when_parsed(app, [command, &chosen] { chosen = *command; });
}

}  // namespace prcage
