// prcage cage: reads a mesh, makes the cage, writes it if it is certified, and says what happened.
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

ExitCode exit_code_of(Status status) {
  switch (status) {
    case Status::ok:
      return ExitCode::ok;
    case Status::face_budget_not_reached:
      return ExitCode::face_budget_not_reached;
    case Status::cancelled:
      return ExitCode::interrupted;
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
    if (!has_cage()) {
      explain_failure();
      return exit_code_of(result_->status);
    }
    if (write_cage() != ExitCode::ok) return fail("cannot_write", "the cage cannot be written", ExitCode::cannot_write);
    summarise();
    return exit_code_of(result_->status);
  }

  bool outputs_writable() const {
    const auto asked_for = [](const std::string& path) { return !path.empty(); };
    return writable(command_.output) && (!asked_for(command_.stats) || writable(command_.stats)) &&
           (!asked_for(command_.wrap_output) || writable(command_.wrap_output));
  }

  ExitCode fail(const char* status, const std::string& message, ExitCode code) {
    record_.status = status;
    record_.message = message;
    return code;
  }

  void make() {
    Control control;
    const InterruptGuard interrupts(control);
    std::optional<ProgressBar> bar;
    if (!command_.quiet) {
      // Said when Ctrl-C starts to mean "stop with what you have", not before.
      fmt::print(stderr, "{}: {} vertices, {} faces\n", input_name(command_.input), input_.file.mesh.positions.size(),
                 input_.file.mesh.triangles.size());
      if (isatty(STDERR_FILENO) != 0) {
        bar.emplace([this, &control](double seconds) { return progress_line(control, cycles(), seconds); });
      }
    }
    result_ = command_.wrap ? cage_of_wrap(control) : make_cage(input_.file.mesh, command_.options, &control);
    distrust_without_certificate();
    record_.status = to_string(result_->status);
    record_.message = result_->message;
  }

  Result cage_of_wrap(Control& control) {
    record_.wrap = alpha_wrap(input_.file.mesh, *command_.wrap, &control);
    command_.wrap = record_.wrap->settings;
    if (record_.wrap->status == Status::ok) {
      return make_cage_around(input_.file.mesh, record_.wrap->mesh, command_.options, &control);
    }
    Result result;
    result.status = record_.wrap->status;
    result.message = record_.wrap->message;
    return result;
  }

  int cycles() const {
    const Options& options = command_.options;
    return options.schedule.empty() ? options.cycles : static_cast<int>(options.schedule.size());
  }

  // Nothing is written that does not carry its certificate, whatever the status says.
  void distrust_without_certificate() {
    if (!has_cage() || result_->certificate.valid()) return;
    result_->status = Status::certificate_failed;
    result_->message = "the cage does not carry a valid certificate";
  }

  // Cancelled early enough, a run may have none.
  bool has_cage() const { return result_->has_cage() && !result_->cage.triangles.empty(); }

  ExitCode write_cage() {
    const Timer timer;
    const std::string comment = fmt::format("cage by prcage {}", version());
    const ExitCode written = write_output(command_.output, command_.format, result_->cage, comment);
    record_.write_seconds = timer.seconds();
    record_.cage_written = written == ExitCode::ok;
    return written;
  }

  // Also where no cage could be made of it: somebody will want to look at it.
  ExitCode write_wrap() const {
    if (command_.wrap_output.empty() || record_.wrap->status != Status::ok) return ExitCode::ok;
    return write_output(command_.wrap_output, command_.wrap_format, record_.wrap->mesh,
                        fmt::format("alpha wrap by prcage {}", version()));
  }

  void explain_failure() const {
    const Result& result = *result_;
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
      fmt::print(stderr, "{}", run_text(command_, input_, *result_, wrap, timer_.seconds()));
    }
    const std::size_t faces = result_->cage.triangles.size();
    if (result_->status == Status::face_budget_not_reached) {
      fmt::print(stderr,
                 "prcage: face budget not reached: asked for {} faces, tau allows no fewer than {}; the cage is valid "
                 "and written\n",
                 command_.options.face_budget, faces);
    } else if (result_->status == Status::cancelled) {
      fmt::print(stderr, "prcage: interrupted: the cage reached so far, {} faces, is valid and written to {}\n", faces,
                 output_name(command_.output));
    }
  }

  // The code to exit with: that of the run, unless it went well and only its statistics cannot be written.
  ExitCode write_statistics() const {
    if (command_.stats.empty()) return record_.exit_code;
    const InputMesh* input = input_.file.ok ? &input_ : nullptr;
    const Result* result = result_ ? &*result_ : nullptr;
    const ExitCode written = write_text(command_.stats, run_json(command_, input, result, record_));
    return record_.exit_code == ExitCode::ok ? written : record_.exit_code;
  }

  CageCommand command_;
  Timer timer_;
  InputMesh input_;
  std::optional<Result> result_;
  RunRecord record_;
};

}  // namespace

ExitCode run(const CageCommand& command) { return CageRun(command).run(); }

}  // namespace prcage
