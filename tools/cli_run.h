// What the commands have in common that read a mesh, make others of it and write those: the way from the command to the
// exit code. What is known is kept as it comes, for the statistics, which are also written when a run fails.
#pragma once

#include <optional>
#include <string>

#include "tools/cli_files.h"
#include "tools/cli_options.h"
#include "tools/cli_progress.h"
#include "tools/report_json.h"

namespace prcage {

class MeshRun {
 public:
  virtual ~MeshRun() = default;
  ExitCode run();

 protected:
  // `command` must outlive this.
  explicit MeshRun(const MeshCommand& command) : files_(command) {}

  virtual bool outputs_writable() const;
  // With the input read. What is written carries a certificate.
  virtual ExitCode make_and_write() = 0;
  virtual std::string statistics() const = 0;

  ExitCode fail(const char* status, const std::string& message, ExitCode code);
  void set_status(Status status, const std::string& message);

  // Says what is being worked on, and from then on how far it has come: when Ctrl-C starts to mean "stop with what you
  // have", not before. `cycles` 0: as many as it takes.
  std::optional<ProgressBar> announce(const Control& control, std::size_t levels, int cycles) const;
  void explain_invalid_input(const Validation& validation) const;

  const InputMesh* known_input() const { return input_.file.ok ? &input_ : nullptr; }
  const Mesh& input_mesh() const { return input_.file.mesh; }

  Timer timer_;
  InputMesh input_;
  RunRecord record_;

 private:
  ExitCode read_make_write();
  ExitCode write_statistics() const;

  const MeshCommand& files_;
};

// Of a run with these steps, which are as many as there are in the schedule if there is one.
template <class AnyOptions>
int cycles_of(const AnyOptions& options) {
  return options.schedule.empty() ? options.cycles : static_cast<int>(options.schedule.size());
}

}  // namespace prcage
