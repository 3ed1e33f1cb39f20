// prcage cage: a cage of a mesh, or nested ones, written if they are certified.
#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "core/schedule.h"
#include "tools/cli_commands.h"
#include "tools/cli_run.h"
#include "tools/report.h"

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

class CageRun : public MeshRun {
 public:
  explicit CageRun(const CageCommand& command) : MeshRun(command_), command_(command) {
    if (stores_floats(command_.format)) command_.options.precision = Precision::float32;
  }

 private:
  ExitCode make_and_write() override {
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

  bool outputs_writable() const override {
    const auto asked_for = [](const std::string& path) { return !path.empty(); };
    const std::vector<std::string> cages = cage_paths();
    return std::all_of(cages.begin(), cages.end(), writable) &&
           (!asked_for(command_.stats) || writable(command_.stats)) &&
           (!asked_for(command_.wrap_output) || writable(command_.wrap_output));
  }

  void make() {
    Control control;
    if (command_.deadline > 0) {
      const std::chrono::duration<double> left(command_.deadline - timer_.seconds());
      control.set_deadline(Control::Clock::now() + std::chrono::duration_cast<Control::Clock::duration>(left));
    }
    const InterruptGuard interrupts(control);
    const std::optional<ProgressBar> bar = announce(control, command_.levels.size(), cycles());
    results_ = command_.wrap ? cages_of_wrap(control) : cages_of_input(control);
    for (Result& result : results_) distrust_without_certificate(result);
    set_status(decisive(results_).status, decisive(results_).message);
  }

  std::vector<Result> cages_of_input(Control& control) const {
    const Mesh& input = input_mesh();
    if (!command_.levels.empty()) return make_cages(input, command_.levels, command_.options, &control);
    return {make_cage(input, command_.options, &control)};
  }

  std::vector<Result> cages_of_wrap(Control& control) {
    const Mesh& input = input_mesh();
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

  int cycles() const { return finds_thickness(command_.options) ? 0 : cycles_of(command_.options); }

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
      explain_invalid_input(result.validation);
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

  std::string statistics() const override { return run_json(command_, known_input(), results_, record_); }

  CageCommand command_;
  std::vector<Result> results_;  // one, unless levels are made
};

}  // namespace

ExitCode run(const CageCommand& command) { return CageRun(command).run(); }

}  // namespace prcage
