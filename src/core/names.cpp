#include "core/prcage.h"

namespace prcage {

const char* version() { return PRCAGE_VERSION; }

const char* to_string(Status status) {
  switch (status) {
    case Status::ok:
      return "ok";
    case Status::face_budget_not_reached:
      return "face_budget_not_reached";
    case Status::cancelled:
      return "cancelled";
    case Status::deadline_reached:
      return "deadline_reached";
    case Status::invalid_options:
      return "invalid_options";
    case Status::invalid_input:
      return "invalid_input";
    case Status::displacement_failed:
      return "displacement_failed";
    case Status::certificate_failed:
      return "certificate_failed";
    case Status::internal_error:
      return "internal_error";
  }
  return "unknown";
}

const char* to_string(Quality quality) {
  switch (quality) {
    case Quality::fast:
      return "fast";
    case Quality::standard:
      return "default";
    case Quality::best:
      return "best";
  }
  return "unknown";
}

const char* to_string(DefectKind kind) {
  switch (kind) {
    case DefectKind::no_faces:
      return "no_faces";
    case DefectKind::index_out_of_range:
      return "index_out_of_range";
    case DefectKind::repeated_vertex:
      return "repeated_vertex";
    case DefectKind::not_finite:
      return "not_finite";
    case DefectKind::too_large:
      return "too_large";
    case DefectKind::boundary_edge:
      return "boundary_edge";
    case DefectKind::non_manifold_edge:
      return "non_manifold_edge";
    case DefectKind::inconsistent_edge:
      return "inconsistent_edge";
    case DefectKind::non_manifold_vertex:
      return "non_manifold_vertex";
    case DefectKind::duplicate_face:
      return "duplicate_face";
    case DefectKind::self_intersection:
      return "self_intersection";
    case DefectKind::degenerate_face:
      return "degenerate_face";
    case DefectKind::inside_out:
      return "inside_out";
    case DefectKind::nested_orientation:
      return "nested_orientation";
  }
  return "unknown";
}

const char* to_string(Control::Stage stage) {
  switch (stage) {
    case Control::Stage::start:
      return "start";
    case Control::Stage::wrap:
      return "wrap";
    case Control::Stage::validate:
      return "validate";
    case Control::Stage::displace:
      return "displace";
    case Control::Stage::collapse:
      return "collapse";
    case Control::Stage::flip:
      return "flip";
    case Control::Stage::tighten:
      return "tighten";
    case Control::Stage::estimate:
      return "estimate";
    case Control::Stage::certify:
      return "certify";
    case Control::Stage::done:
      return "done";
  }
  return "unknown";
}

PaperConditions paper_conditions(const Certificate& c) {
  return {c.self_intersection_free, c.closed && c.manifold && c.oriented, c.no_contact && c.encloses,
          c.euler_characteristic_equal};
}

Counts& Counts::operator+=(const Counts& o) {
  evaluated += o.evaluated;
  rejected_link += o.rejected_link;
  rejected_infeasible += o.rejected_infeasible;
  selected += o.selected;
  postponed += o.postponed;
  rejected_orientation += o.rejected_orientation;
  rejected_degenerate += o.rejected_degenerate;
  rejected_tau += o.rejected_tau;
  rejected_cage += o.rejected_cage;
  rejected_conflict += o.rejected_conflict;
  collapses += o.collapses;
  flips_tried += o.flips_tried;
  flips += o.flips;
  tightened += o.tightened;
  return *this;
}

}  // namespace prcage
