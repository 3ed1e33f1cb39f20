// What the pipelines behind the public functions have in common, from the check of the input to the rounding of what
// comes out: make_cage.cpp, simplify.cpp.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/mesh_view.h"
#include "parallel/cage_state.h"
#include "parallel/engine.h"
#include "parallel/stopwatch.h"
#include "parallel/validate.h"

namespace prcage {

template <class AnyResult>
class PipelineBase {
 protected:
  // All must outlive this. `control` may be null.
  PipelineBase(const MeshView& input, Control* control, AnyResult& result)
      : input_(input), control_(control), result_(result) {}

  StageSeconds& seconds() { return result_.statistics.seconds; }
  const ValidSurface& valid() const { return checked_->valid; }
  bool stopped() const { return control_ != nullptr && control_->stopped(); }

  void report(Control::Stage stage, std::size_t faces, double progress) const {
    if (control_ != nullptr) control_->report(stage, 0, faces, progress);
  }

  void fail(Status status, const std::string& message) {
    result_.status = status;
    result_.message = message;
  }

  // For a run that has been stopped; `where` goes on with the sentence.
  void stop(const std::string& where) {
    if (control_->cancelled())
      fail(Status::cancelled, "cancelled" + where);
    else
      fail(Status::deadline_reached, "the deadline has passed" + where);
  }

  void validate_input(bool accept_inside_out) {
    report(Control::Stage::validate, input_.triangle_count, 0);
    const Stopwatch watch(seconds().validate);
    checked_ = std::make_unique<CheckedMesh>(validate_mesh(to_mesh(input_), device_, accept_inside_out));
    result_.validation = checked_->validation;
    result_.statistics.diagonal = result_.validation.diagonal;
  }

  // What is left, about to be certified. Collapses place vertices on floats where these are wanted; vertices that never
  // moved are still doubles.
  Mesh take_mesh(const CageState& state, Precision precision) {
    Mesh mesh = state.mesh.to_mesh();
    if (precision == Precision::float32)
      for (Position& p : mesh.positions) p = round_to_floats(vec(p));
    result_.statistics.cage_vertices = mesh.positions.size();
    result_.statistics.cage_faces = mesh.triangles.size();
    report(Control::Stage::certify, mesh.triangles.size(), 0.95);
    return mesh;
  }

  void fail_certificate(const std::string& what, Precision precision) {
    fail(Status::certificate_failed,
         what + (precision == Precision::float32
                     ? " does not survive the rounding of its coordinates to floats; store it in a format that holds "
                       "doubles"
                     : " failed its certificate; this is a defect of prcage, please report it"));
  }

  const MeshView& input_;
  Control* control_;
  AnyResult& result_;
  TreeDevice device_;
  std::vector<double> thickness_;         // of each cycle
  std::unique_ptr<CheckedMesh> checked_;  // the input, or its wrap
  EngineOutcome outcome_ = EngineOutcome::schedule_finished;
};

}  // namespace prcage
