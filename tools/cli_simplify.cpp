// prcage simplify and prcage lowpoly: meshes of fewer faces, written if they are certified.
#include <optional>
#include <string>

#include <fmt/core.h>

#include "tools/cli_commands.h"
#include "tools/cli_run.h"
#include "tools/report.h"

namespace prcage {
namespace {

// The reference wrap of the paper's sec. 5.4.
constexpr WrapSettings low_poly_wrap{1.0 / 10, 1.0 / 500};

SimplifyResult make(const SimplifyCommand& command, const Mesh& input, Control& control, RunRecord&) {
  return simplify(input, command.options, &control);
}

SimplifyResult make(const LowPolyCommand& command, const Mesh& input, Control& control, RunRecord& record) {
  if (command.no_wrap) return make_low_poly(input, nullptr, command.options, &control);
  if (!has_alpha_wrap()) {
    if (!command.quiet)
      fmt::print(stderr,
                 "prcage: no alpha wrap in this build: equal tolerances on both sides, hollows are not filled\n");
    return make_low_poly(input, nullptr, command.options, &control);
  }
  record.wrap = alpha_wrap(input, low_poly_wrap, &control);
  // What is wrong with the input is better said by the validation.
  if (record.wrap->status != Status::ok) return make_low_poly(input, nullptr, command.options, &control);
  const MeshView wrap(record.wrap->mesh);
  return make_low_poly(input, &wrap, command.options, &control);
}

int steps_of(const SimplifyCommand& command) { return cycles_of(command.options); }

// How many there will be is not known.
int steps_of(const LowPolyCommand&) { return 0; }

template <class AnyCommand>
class SurfaceRun : public MeshRun {
 public:
  explicit SurfaceRun(const AnyCommand& command) : MeshRun(command_), command_(command) {
    if (stores_floats(command_.format)) command_.options.precision = Precision::float32;
  }

 private:
  ExitCode make_and_write() override {
    make_surface();
    if (!result_->has_mesh()) {
      explain_failure();
      return exit_code_of(result_->status);
    }
    const Timer timer;
    const std::string comment = fmt::format("simplified by prcage {}", version());
    if (write_output(command_.output, command_.format, result_->mesh, comment) != ExitCode::ok)
      return fail("cannot_write", "the surface cannot be written", ExitCode::cannot_write);
    record_.write_seconds = timer.seconds();
    record_.cage_written = true;
    summarise();
    return exit_code_of(result_->status);
  }

  void make_surface() {
    Control control;
    const InterruptGuard interrupts(control);
    const std::optional<ProgressBar> bar = announce(control, 0, steps_of(command_));
    result_ = make(command_, input_mesh(), control, record_);
    set_status(result_->status, result_->message);
  }

  void explain_failure() const {
    const SimplifyResult& result = *result_;
    if (result.status == Status::invalid_input)
      explain_invalid_input(result.validation);
    else
      print_error(fmt::format("{}: {}; nothing written", to_string(result.status), result.message));
    if (result.status == Status::certificate_failed) fmt::print(stderr, "{}", certificate_text(result.certificate));
  }

  void summarise() const {
    const Wrap* wrap = record_.wrap && record_.wrap->status == Status::ok ? &*record_.wrap : nullptr;
    if (!command_.quiet)
      fmt::print(stderr, "{}",
                 surface_run_text(command_, command_.options.tau_mode, input_, *result_, wrap, timer_.seconds()));
    if (result_->status == Status::ok) return;
    fmt::print(stderr, "prcage: {}: {}; it is valid and written to {}\n", to_string(result_->status), result_->message,
               output_name(command_.output));
  }

  std::string statistics() const override {
    return surface_run_json(command_, known_input(), result_ ? &*result_ : nullptr, record_);
  }

  AnyCommand command_;
  std::optional<SimplifyResult> result_;
};

}  // namespace

ExitCode run(const SimplifyCommand& command) { return SurfaceRun(command).run(); }

ExitCode run(const LowPolyCommand& command) { return SurfaceRun(command).run(); }

}  // namespace prcage
