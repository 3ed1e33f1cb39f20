#include "tools/cli_run.h"

#include <new>

#include <fmt/core.h>
#include <unistd.h>

#include "tools/report.h"

namespace prcage {

ExitCode MeshRun::run() {
  try {
    record_.exit_code = read_make_write();
  } catch (const std::bad_alloc&) {
    record_.exit_code = fail(to_string(Status::internal_error), out_of_memory_text, ExitCode::internal_error);
    print_error(record_.message);
  }
  record_.total_seconds = timer_.seconds();
  return write_statistics();
}

bool MeshRun::outputs_writable() const {
  return writable(files_.output) && (files_.stats.empty() || writable(files_.stats));
}

ExitCode MeshRun::fail(const char* status, const std::string& message, ExitCode code) {
  record_.status = status;
  record_.message = message;
  return code;
}

void MeshRun::set_status(Status status, const std::string& message) {
  record_.status = to_string(status);
  record_.message = message;
}

std::optional<ProgressBar> MeshRun::announce(const Control& control, std::size_t levels, int cycles) const {
  if (files_.quiet) return std::nullopt;
  fmt::print(stderr, "{}: {} vertices, {} faces\n", input_name(files_.input), input_mesh().positions.size(),
             input_mesh().triangles.size());
  if (isatty(STDERR_FILENO) == 0) return std::nullopt;
  return std::optional<ProgressBar>(std::in_place, [&control, levels, cycles](double seconds) {
    return progress_line(control, levels, cycles, seconds);
  });
}

void MeshRun::explain_invalid_input(const Validation& validation) const {
  print_error(validation_headline(input_, validation));
  fmt::print(stderr, "{}", validation_details(input_, validation));
}

ExitCode MeshRun::read_make_write() {
  if (!outputs_writable()) return fail("cannot_write", "an output cannot be written", ExitCode::cannot_write);
  input_ = read_input(files_.input, files_.weld);
  if (!input_.file.ok) return fail("cannot_read", input_.file.error, ExitCode::cannot_read);
  return make_and_write();
}

// The code to exit with: that of the run, unless it went well and only its statistics cannot be written.
ExitCode MeshRun::write_statistics() const {
  if (files_.stats.empty()) return record_.exit_code;
  const ExitCode written = write_text(files_.stats, statistics());
  return record_.exit_code == ExitCode::ok ? written : record_.exit_code;
}

}  // namespace prcage
