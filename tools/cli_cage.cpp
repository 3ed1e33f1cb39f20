// prcage cage: reads a mesh, makes the cage, writes it if it is certified, and says what happened.
#include <algorithm>
#include <chrono>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <unistd.h>

#include "core/schedule.h"
#include "tools/cli_commands.h"
#include "tools/cli_files.h"
#include "tools/cli_progress.h"
#include "tools/report.h"
#include "tools/report_json.h"

namespace prcage {

ExitCode exit_code_of(Status status) {
  switch (status) {
    case Status::ok:
      return ExitCode::ok;
    case Status::face_budget_not_reached:
      return ExitCode::face_budget_not_reached;
    case Status::cancelled:
      return ExitCode::interrupted;
    case Status::deadline_reached:
      return ExitCode::deadline_reached;
    case Status::invalid_options:
      return ExitCode::usage;
    case Status::invalid_input:
      return ExitCode::invalid_mesh;
    case Status::displacement_failed:
    case Status::certificate_failed:
      return ExitCode::no_cage;
    case Status::internal_error:
      return ExitCode::internal_error;
  }
  return ExitCode::internal_error;
}

namespace {

// What became of a sequence of levels, of which one that was not reached does not end it.
const Result& decisive(const std::vector<Result>& results) {
  if (results.back().status != Status::ok) return results.back();
  const auto missed =
      std::find_if(results.begin(), results.end(), [](const Result& result) { return result.status != Status::ok; });
  return missed == results.end() ? results.back() : *missed;
}

// One run from the command to its exit code. What is known is kept as it comes, for the statistics.
class CageRun {
 public:
  explicit CageRun(const CageCommand& command) : command_(command) {
    if (stores_floats(command_.format)) command_.options.precision = Precision::float32;
  }

  ExitCode run() {
    try {
      record_.exit_code = read_make_write();
    } catch (const std::bad_alloc&) {
      record_.exit_code = fail(to_string(Status::internal_error), out_of_memory_text, ExitCode::internal_error);
      print_error(record_.message);
    }
    record_.total_seconds = timer_.seconds();
    return write_statistics();
  }

 private:
  ExitCode read_make_write() {
    if (!outputs_writable()) {
      return fail("cannot_write", "an output cannot be written", ExitCode::cannot_write);
    }
    input_ = read_input(command_.input, command_.weld);
    if (!input_.file.ok) return fail("cannot_read", input_.file.error, ExitCode::cannot_read);
    make();
    if (write_wrap() != ExitCode::ok) return fail("cannot_write", "the wrap cannot be written", ExitCode::cannot_write);
    if (!results_.front().has_cage()) {
      explain_failure(results_.front());
      return exit_code();
    }
    if (write_cages() != ExitCode::ok) {
      return fail("cannot_write", "the cage cannot be written", ExitCode::cannot_write);
    }
    summarise();
    return exit_code();
  }

  // A sequence that was stopped is what was asked for as far as there is any cage.
  ExitCode exit_code() const {
    const Status status = decisive(results_).status;
    const bool late = status == Status::deadline_reached && !results_.front().has_cage();
    return late ? ExitCode::no_cage : exit_code_of(status);
  }

  // The file of each level, or the one of the only cage.
  std::vector<std::string> cage_paths() const {
    if (command_.levels.empty()) return {command_.output};
    std::vector<std::string> paths;
    for (const std::size_t faces : command_.levels) paths.push_back(level_path(command_.output, faces));
    return paths;
  }

  bool outputs_writable() const {
    const auto asked_for = [](const std::string& path) { return !path.empty(); };
    const std::vector<std::string> cages = cage_paths();
    return std::all_of(cages.begin(), cages.end(), writable) &&
           (!asked_for(command_.stats) || writable(command_.stats)) &&
           (!asked_for(command_.wrap_output) || writable(command_.wrap_output));
  }

  ExitCode fail(const char* status, const std::string& message, ExitCode code) {
    record_.status = status;
    record_.message = message;
    return code;
  }

  void make() {
    Control control;
    if (command_.deadline > 0) {
      const std::chrono::duration<double> left(command_.deadline - timer_.seconds());
      control.set_deadline(Control::Clock::now() + std::chrono::duration_cast<Control::Clock::duration>(left));
    }
    const InterruptGuard interrupts(control);
    std::optional<ProgressBar> bar;
    if (!command_.quiet) {
      // Said when Ctrl-C starts to mean "stop with what you have", not before.
      fmt::print(stderr, "{}: {} vertices, {} faces\n", input_name(command_.input), input_.file.mesh.positions.size(),
                 input_.file.mesh.triangles.size());
      if (isatty(STDERR_FILENO) != 0) {
        bar.emplace([this, &control](double seconds) {
          return progress_line(control, command_.levels.size(), cycles(), seconds);
        });
      }
    }
    results_ = command_.wrap ? cages_of_wrap(control) : cages_of_input(control);
    for (Result& result : results_) distrust_without_certificate(result);
    record_.status = to_string(decisive(results_).status);
    record_.message = decisive(results_).message;
  }

  std::vector<Result> cages_of_input(Control& control) const {
    const Mesh& input = input_.file.mesh;
    if (!command_.levels.empty()) return make_cages(input, command_.levels, command_.options, &control);
    return {make_cage(input, command_.options, &control)};
  }

  std::vector<Result> cages_of_wrap(Control& control) {
    const Mesh& input = input_.file.mesh;
    record_.wrap = alpha_wrap(input, *command_.wrap, &control);
    const Wrap& wrap = *record_.wrap;
    command_.wrap = wrap.settings;
    if (wrap.status == Status::ok) {
      if (command_.levels.empty()) return {make_cage_around(input, wrap.mesh, command_.options, &control)};
      return make_cages_around(input, wrap.mesh, command_.levels, command_.options, &control);
    }
    Result result;
    result.status = wrap.status;
    result.message = wrap.message;
    return {result};
  }

  // 0: as many as it takes.
  int cycles() const {
    const Options& options = command_.options;
    if (finds_thickness(options)) return 0;
    return options.schedule.empty() ? options.cycles : static_cast<int>(options.schedule.size());
  }

  // Nothing is written that does not carry its certificate, whatever the status says.
  static void distrust_without_certificate(Result& result) {
    const bool valid = result.certificate.valid() && (!result.around_previous || result.around_previous->valid());
    if (!result.has_cage() || valid) return;
    result.status = Status::certificate_failed;
    result.message = "the cage does not carry a valid certificate";
  }

  // All that there are. The last level may have none.
  ExitCode write_cages() {
    const Timer timer;
    const std::string comment = fmt::format("cage by prcage {}", version());
    const std::vector<std::string> paths = cage_paths();
    ExitCode written = ExitCode::ok;
    std::size_t& count = record_.levels_written;
    while (count < results_.size() && results_[count].has_cage() && written == ExitCode::ok) {
      written = write_output(paths[count], command_.format, results_[count].cage, comment);
      count += written == ExitCode::ok ? 1 : 0;
    }
    record_.write_seconds = timer.seconds();
    record_.cage_written = count == paths.size();
    return written;
  }

  // Also where no cage could be made of it: somebody will want to look at it.
  ExitCode write_wrap() const {
    if (command_.wrap_output.empty() || record_.wrap->status != Status::ok) return ExitCode::ok;
    return write_output(command_.wrap_output, command_.wrap_format, record_.wrap->mesh,
                        fmt::format("alpha wrap by prcage {}", version()));
  }

  void explain_failure(const Result& result) const {
    if (result.status == Status::invalid_input && !command_.wrap) {
      print_error(validation_headline(input_, result.validation));
      fmt::print(stderr, "{}", validation_details(input_, result.validation));
      if (result.validation.faces > 0) fmt::print(stderr, "{}", wrap_hint());
    } else if (result.status == Status::cancelled) {
      print_error("interrupted before there was a cage; nothing written");
    } else {
      print_error(fmt::format("{}: {}; nothing written", to_string(result.status), result.message));
    }
    if (result.status == Status::certificate_failed) {
      fmt::print(stderr, "{}", certificate_text(result.certificate, command_.wrap.has_value()));
    }
  }

  void summarise() const {
    if (!command_.quiet) {
      const Wrap* wrap = record_.wrap ? &*record_.wrap : nullptr;
      fmt::print(stderr, "{}",
                 command_.levels.empty() ? run_text(command_, input_, results_.front(), wrap, timer_.seconds())
                                         : levels_text(command_, input_, results_, wrap, timer_.seconds()));
    }
    for (std::size_t i = 0; i < results_.size(); ++i) explain(results_[i], cage_paths()[i]);
  }

  // What is not as it was asked for, though there is a cage, or at least a level before.
  void explain(const Result& result, const std::string& path) const {
    const bool stopped = result.status == Status::cancelled || result.status == Status::deadline_reached;
    if (!result.has_cage()) {
      fmt::print(stderr, "prcage: {}: {}; {} is not written\n", to_string(result.status), result.message, path);
    } else if (result.status == Status::face_budget_not_reached) {
      fmt::print(stderr, "prcage: face budget not reached: {}; the cage is valid and written to {}\n", result.message,
                 output_name(path));
    } else if (stopped) {
      fmt::print(stderr, "prcage: {}: the cage reached so far, {} faces, is valid and written to {}\n",
                 result.status == Status::cancelled ? "interrupted" : "deadline reached", result.cage.triangles.size(),
                 output_name(path));
    }
  }

  // The code to exit with: that of the run, unless it went well and only its statistics cannot be written.
  ExitCode write_statistics() const {
    if (command_.stats.empty()) return record_.exit_code;
    const InputMesh* input = input_.file.ok ? &input_ : nullptr;
    const ExitCode written = write_text(command_.stats, run_json(command_, input, results_, record_));
    return record_.exit_code == ExitCode::ok ? written : record_.exit_code;
  }

  CageCommand command_;
  Timer timer_;
  InputMesh input_;
  std::vector<Result> results_;  // one, unless levels are made
  RunRecord record_;
};

}  // namespace

ExitCode run(const CageCommand& command) { return CageRun(command).run(); }

}  // namespace prcage
