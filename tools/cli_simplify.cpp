// prcage simplify: reads a mesh, simplifies it within its tolerances, writes it if it is certified, and says what
// happened.
#include <new>
#include <optional>
#include <string>

#include <fmt/core.h>
#include <unistd.h>

#include "tools/cli_commands.h"
#include "tools/cli_files.h"
#include "tools/cli_progress.h"
#include "tools/report.h"
#include "tools/report_json.h"

namespace prcage {
namespace {

// One run from the command to its exit code. What is known is kept as it comes, for the statistics.
class SimplifyRun {
 public:
  explicit SimplifyRun(const SimplifyCommand& command) : command_(command) {
    if (stores_floats(command_.format)) command_.options.precision = Precision::float32;
  }

  ExitCode run() {
    try {
      record_.exit_code = read_simplify_write();
    } catch (const std::bad_alloc&) {
      record_.exit_code = fail(to_string(Status::internal_error), out_of_memory_text, ExitCode::internal_error);
      print_error(record_.message);
    }
    record_.total_seconds = timer_.seconds();
    return write_statistics();
  }

 private:
  ExitCode read_simplify_write() {
    if (!writable(command_.output) || (!command_.stats.empty() && !writable(command_.stats)))
      return fail("cannot_write", "an output cannot be written", ExitCode::cannot_write);
    input_ = read_input(command_.input, command_.weld);
    if (!input_.file.ok) return fail("cannot_read", input_.file.error, ExitCode::cannot_read);
    simplify_input();
    if (!result_->has_mesh()) {
      explain_failure();
      return exit_code_of(result_->status);
    }
    const Timer timer;
    if (write_output(command_.output, command_.format, result_->mesh,
                     fmt::format("simplified by prcage {}", version())) != ExitCode::ok)
      return fail("cannot_write", "the surface cannot be written", ExitCode::cannot_write);
    record_.write_seconds = timer.seconds();
    record_.cage_written = true;
    summarise();
    return exit_code_of(result_->status);
  }

  ExitCode fail(const char* status, const std::string& message, ExitCode code) {
    record_.status = status;
    record_.message = message;
    return code;
  }

  void simplify_input() {
    Control control;
    const InterruptGuard interrupts(control);
    std::optional<ProgressBar> bar;
    if (!command_.quiet) {
      fmt::print(stderr, "{}: {} vertices, {} faces\n", input_name(command_.input), input_.file.mesh.positions.size(),
                 input_.file.mesh.triangles.size());
      const SimplifyOptions& options = command_.options;
      const int cycles = options.schedule.empty() ? options.cycles : static_cast<int>(options.schedule.size());
      if (isatty(STDERR_FILENO) != 0)
        bar.emplace([&control, cycles](double seconds) { return progress_line(control, 0, cycles, seconds); });
    }
    result_ = simplify(input_.file.mesh, command_.options, &control);
    record_.status = to_string(result_->status);
    record_.message = result_->message;
  }

  void explain_failure() const {
    const SimplifyResult& result = *result_;
    if (result.status == Status::invalid_input) {
      print_error(validation_headline(input_, result.validation));
      fmt::print(stderr, "{}", validation_details(input_, result.validation));
    } else {
      print_error(fmt::format("{}: {}; nothing written", to_string(result.status), result.message));
    }
    if (result.status == Status::certificate_failed) fmt::print(stderr, "{}", certificate_text(result.certificate));
  }

  void summarise() const {
    if (!command_.quiet) fmt::print(stderr, "{}", simplify_text(command_, input_, *result_, timer_.seconds()));
    if (result_->status == Status::ok) return;
    fmt::print(stderr, "prcage: {}: {}; it is valid and written to {}\n", to_string(result_->status), result_->message,
               output_name(command_.output));
  }

  // The code to exit with: that of the run, unless it went well and only its statistics cannot be written.
  ExitCode write_statistics() const {
    if (command_.stats.empty()) return record_.exit_code;
    const InputMesh* input = input_.file.ok ? &input_ : nullptr;
    const SimplifyResult* result = result_ ? &*result_ : nullptr;
    const ExitCode written = write_text(command_.stats, simplify_json(command_, input, result, record_));
    return record_.exit_code == ExitCode::ok ? written : record_.exit_code;
  }

  SimplifyCommand command_;
  Timer timer_;
  InputMesh input_;
  std::optional<SimplifyResult> result_;
  RunRecord record_;
};

}  // namespace

ExitCode run(const SimplifyCommand& command) { return SimplifyRun(command).run(); }

}  // namespace prcage
