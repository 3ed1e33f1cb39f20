#include "tools/report_json.h"

#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/schedule.h"
#include "tools/cli_files.h"

namespace prcage {
namespace {

using Json = nlohmann::ordered_json;

constexpr int schema = 1;

// A key and value of an object: the key is the member's name, so it cannot drift from the code.
#define PRCAGE_FIELD(object, member) \
  { #member, (object).member }

Json header() { return {{"schema", schema}, {"tool", {{"name", "prcage"}, {"version", version()}}}}; }

// File names need not be UTF-8: what is not is replaced, so that the text is always JSON.
std::string text_of(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

Json json_of(const InputMesh& input) {
  return {{"path", input.path},
          {"format", to_string(input.file.format)},
          {"vertices", input.file_vertices},
          {"faces", input.file_faces},
          {"content_hash", fmt::format("xxh3_64:{:016x}", input.content_hash)},
          PRCAGE_FIELD(input.file, float_positions),
          PRCAGE_FIELD(input.file, polygons),
          PRCAGE_FIELD(input.file, skipped_elements),
          PRCAGE_FIELD(input.file, welded_corners),
          PRCAGE_FIELD(input, welded_vertices),
          PRCAGE_FIELD(input, collapsed_faces)};
}

Json json_of(const std::array<std::uint32_t, 2>& elements) {
  Json numbers = Json::array();
  for (const std::uint32_t element : elements) {
    if (element != DefectExample::no_element) numbers.push_back(element);
  }
  return numbers;
}

Json json_of(const Defect& defect) {
  Json examples = Json::array();
  for (const DefectExample& example : defect.examples) {
    examples.push_back(
        {{"faces", json_of(example.faces)}, {"vertices", json_of(example.vertices)}, PRCAGE_FIELD(example, position)});
  }
  return {{"kind", to_string(defect.kind)}, PRCAGE_FIELD(defect, count), {"examples", examples}};
}

Json json_of(const Validation& validation) {
  Json defects = Json::array();
  for (const Defect& defect : validation.defects) defects.push_back(json_of(defect));
  return {{"valid", validation.valid()},
          {"defects", defects},
          PRCAGE_FIELD(validation, vertices),
          PRCAGE_FIELD(validation, faces),
          PRCAGE_FIELD(validation, unreferenced_vertices),
          PRCAGE_FIELD(validation, duplicate_vertices),
          PRCAGE_FIELD(validation, degenerate_faces),
          PRCAGE_FIELD(validation, components),
          PRCAGE_FIELD(validation, cavities),
          PRCAGE_FIELD(validation, euler_characteristic),
          PRCAGE_FIELD(validation, diagonal),
          PRCAGE_FIELD(validation, area),
          PRCAGE_FIELD(validation, volume)};
}

Json json_of(const Certificate& certificate) {
  return {{"valid", certificate.valid()},
          PRCAGE_FIELD(certificate, closed),
          PRCAGE_FIELD(certificate, manifold),
          PRCAGE_FIELD(certificate, oriented),
          PRCAGE_FIELD(certificate, no_degenerate_face),
          PRCAGE_FIELD(certificate, self_intersection_free),
          PRCAGE_FIELD(certificate, no_contact),
          PRCAGE_FIELD(certificate, encloses),
          PRCAGE_FIELD(certificate, euler_characteristic_equal),
          PRCAGE_FIELD(certificate, component_count_equal),
          PRCAGE_FIELD(certificate, components),
          PRCAGE_FIELD(certificate, euler_characteristic),
          PRCAGE_FIELD(certificate, self_intersections),
          PRCAGE_FIELD(certificate, contacts)};
}

Json json_of(const Counts& counts) {
  return {PRCAGE_FIELD(counts, evaluated),
          PRCAGE_FIELD(counts, rejected_link),
          PRCAGE_FIELD(counts, rejected_infeasible),
          PRCAGE_FIELD(counts, selected),
          PRCAGE_FIELD(counts, postponed),
          PRCAGE_FIELD(counts, rejected_orientation),
          PRCAGE_FIELD(counts, rejected_degenerate),
          PRCAGE_FIELD(counts, rejected_tau),
          PRCAGE_FIELD(counts, rejected_cage),
          PRCAGE_FIELD(counts, rejected_conflict),
          PRCAGE_FIELD(counts, collapses),
          PRCAGE_FIELD(counts, flips_tried),
          PRCAGE_FIELD(counts, flips),
          PRCAGE_FIELD(counts, tightened)};
}

Json json_of(const CycleStatistics& cycle) {
  return {PRCAGE_FIELD(cycle, beta),  PRCAGE_FIELD(cycle, tau),     PRCAGE_FIELD(cycle, rounds),
          PRCAGE_FIELD(cycle, faces), PRCAGE_FIELD(cycle, seconds), {"counts", json_of(cycle.counts)}};
}

Json json_of(const StageSeconds& seconds) {
  return {PRCAGE_FIELD(seconds, total),    PRCAGE_FIELD(seconds, validate), PRCAGE_FIELD(seconds, displace),
          PRCAGE_FIELD(seconds, evaluate), PRCAGE_FIELD(seconds, select),   PRCAGE_FIELD(seconds, build),
          PRCAGE_FIELD(seconds, distance), PRCAGE_FIELD(seconds, collide),  PRCAGE_FIELD(seconds, commit),
          PRCAGE_FIELD(seconds, flip),     PRCAGE_FIELD(seconds, tighten),  PRCAGE_FIELD(seconds, estimate),
          PRCAGE_FIELD(seconds, certify)};
}

Json json_of(const DroppedFaces& dropped) {
  return {PRCAGE_FIELD(dropped, index_out_of_range), PRCAGE_FIELD(dropped, not_finite), PRCAGE_FIELD(dropped, no_area)};
}

Json json_of(const Wrap& wrap) {
  return {{"status", to_string(wrap.status)},
          {"alpha", wrap.settings.alpha * wrap.diagonal},
          {"offset", wrap.settings.offset * wrap.diagonal},
          {"vertices", wrap.mesh.positions.size()},
          {"faces", wrap.mesh.triangles.size()},
          {"dropped", json_of(wrap.dropped)},
          PRCAGE_FIELD(wrap, seconds)};
}

Json json_of(const WrapSettings& settings) { return {PRCAGE_FIELD(settings, alpha), PRCAGE_FIELD(settings, offset)}; }

Json json_of(const Statistics& statistics) {
  Json cycles = Json::array();
  for (const CycleStatistics& cycle : statistics.cycles) cycles.push_back(json_of(cycle));
  return {PRCAGE_FIELD(statistics, input_vertices),
          PRCAGE_FIELD(statistics, input_faces),
          PRCAGE_FIELD(statistics, cage_vertices),
          PRCAGE_FIELD(statistics, cage_faces),
          PRCAGE_FIELD(statistics, diagonal),
          PRCAGE_FIELD(statistics, tau),
          {"needed_tau", statistics.needed_tau > 0 ? Json(statistics.needed_tau) : Json()},
          PRCAGE_FIELD(statistics, sigma_min),
          PRCAGE_FIELD(statistics, sigma_max),
          PRCAGE_FIELD(statistics, singular_vertices),
          PRCAGE_FIELD(statistics, capped_vertices),
          PRCAGE_FIELD(statistics, halved_vertices),
          PRCAGE_FIELD(statistics, threads),
          PRCAGE_FIELD(statistics, simd),
          PRCAGE_FIELD(statistics, peak_memory_bytes),
          PRCAGE_FIELD(statistics, band_voxels),
          {"seconds", json_of(statistics.seconds)},
          {"counts", json_of(statistics.counts)},
          {"cycles", cycles}};
}

// Steps as shares of tau; empty if the thickness is found by the run, whose cycles are then those of the statistics.
std::vector<double> resolved_schedule(Options options) {
  if (finds_thickness(options)) return {};
  options.tau_absolute = 1;
  return thickness_steps(options, 1, 0);
}

// Tau in both units, whichever was given, once the diagonal that relates them is known. 0 if it was to be found.
void resolve_tau(Options& options, double diagonal) {
  if (!(diagonal > 0)) return;
  if (options.tau_absolute > 0) {
    options.tau = options.tau_absolute / diagonal;
  } else {
    options.tau_absolute = options.tau * diagonal;
  }
}

Json json_of(const CageCommand& command, double diagonal) {
  Options options = command.options;
  const std::vector<double> schedule = resolved_schedule(options);
  resolve_tau(options, diagonal);
  return {PRCAGE_FIELD(command, input),
          PRCAGE_FIELD(command, output),
          {"format", to_string(command.format)},
          PRCAGE_FIELD(command, weld),
          {"wrap", command.wrap ? json_of(*command.wrap) : Json()},
          PRCAGE_FIELD(options, tau),
          PRCAGE_FIELD(options, tau_absolute),
          {"tau_mode", options.tau_mode == TauMode::strict ? "strict" : "paper"},
          {"cycles", schedule.size()},
          {"schedule", schedule},
          PRCAGE_FIELD(options, face_budget),
          PRCAGE_FIELD(command, levels),
          {"deadline", command.deadline > 0 ? Json(command.deadline) : Json()},
          {"bound", options.bound == Bound::both ? "both" : "cage"},
          {"quality", to_string(options.quality)},
          PRCAGE_FIELD(options, flips),
          PRCAGE_FIELD(options, sigma),
          PRCAGE_FIELD(options, seed),
          PRCAGE_FIELD(options, threads),
          PRCAGE_FIELD(options, accept_inside_out),
          {"precision", options.precision == Precision::float32 ? "float32" : "float64"}};
}

// What the options of simplify and lowpoly have in common.
template <class AnyCommand>
Json surface_options(const AnyCommand& command) {
  const auto& options = command.options;
  return {PRCAGE_FIELD(command, input),
          PRCAGE_FIELD(command, output),
          {"format", to_string(command.format)},
          PRCAGE_FIELD(command, weld),
          {"tau_mode", options.tau_mode == TauMode::strict ? "strict" : "paper"},
          PRCAGE_FIELD(options, flips),
          PRCAGE_FIELD(options, seed),
          PRCAGE_FIELD(options, threads),
          PRCAGE_FIELD(options, accept_inside_out),
          {"precision", options.precision == Precision::float32 ? "float32" : "float64"}};
}

Json json_of(const SimplifyCommand& command) {
  const SimplifyOptions& options = command.options;
  Json json = surface_options(command);
  json.update({PRCAGE_FIELD(options, tau_inner),
               PRCAGE_FIELD(options, tau_outer),
               PRCAGE_FIELD(options, absolute),
               {"bound", options.bound == Bound::both ? "both" : "surface"},
               PRCAGE_FIELD(options, cycles),
               PRCAGE_FIELD(options, schedule),
               PRCAGE_FIELD(options, face_budget)});
  return json;
}

Json json_of(const LowPolyCommand& command) {
  const LowPolyOptions& options = command.options;
  Json json = surface_options(command);
  json.update({PRCAGE_FIELD(options, faces),
               PRCAGE_FIELD(options, inner_share),
               {"quality", to_string(options.quality)},
               PRCAGE_FIELD(command, no_wrap)});
  return json;
}

Json json_of(const SurfaceCertificate& certificate) {
  return {{"valid", certificate.valid()},
          PRCAGE_FIELD(certificate, closed),
          PRCAGE_FIELD(certificate, manifold),
          PRCAGE_FIELD(certificate, oriented),
          PRCAGE_FIELD(certificate, no_degenerate_face),
          PRCAGE_FIELD(certificate, self_intersection_free),
          PRCAGE_FIELD(certificate, bounds_solid),
          PRCAGE_FIELD(certificate, euler_characteristic_equal),
          PRCAGE_FIELD(certificate, component_count_equal),
          PRCAGE_FIELD(certificate, cavity_count_equal),
          PRCAGE_FIELD(certificate, components),
          PRCAGE_FIELD(certificate, cavities),
          PRCAGE_FIELD(certificate, euler_characteristic),
          PRCAGE_FIELD(certificate, self_intersections)};
}

Json json_of(const TwoSidedDeviation& deviation) {
  return {PRCAGE_FIELD(deviation, outside), PRCAGE_FIELD(deviation, inside), PRCAGE_FIELD(deviation, from_input)};
}

Json json_of(const ValueRange& range) {
  return {PRCAGE_FIELD(range, min), PRCAGE_FIELD(range, mean), PRCAGE_FIELD(range, max)};
}

Json json_of(const MeshMeasures& measures) {
  return {PRCAGE_FIELD(measures, vertices),
          PRCAGE_FIELD(measures, faces),
          PRCAGE_FIELD(measures, usable_faces),
          PRCAGE_FIELD(measures, referenced_vertices),
          PRCAGE_FIELD(measures, lower),
          PRCAGE_FIELD(measures, upper),
          PRCAGE_FIELD(measures, diagonal),
          PRCAGE_FIELD(measures, area),
          PRCAGE_FIELD(measures, volume),
          PRCAGE_FIELD(measures, components),
          PRCAGE_FIELD(measures, edges),
          PRCAGE_FIELD(measures, boundary_edges),
          PRCAGE_FIELD(measures, non_manifold_edges),
          PRCAGE_FIELD(measures, euler_characteristic),
          {"edge_length", json_of(measures.edge_length)},
          {"smallest_angle", json_of(measures.smallest_angle)},
          PRCAGE_FIELD(measures, largest_angle)};
}

Json json_of(const PaperConditions& conditions) {
  return {{"success", conditions.success()},
          PRCAGE_FIELD(conditions, self_intersection_free),
          PRCAGE_FIELD(conditions, manifold),
          PRCAGE_FIELD(conditions, strictly_encloses),
          PRCAGE_FIELD(conditions, topology_equal)};
}

Json json_of(const SurfaceDeviation& deviation) {
  return {PRCAGE_FIELD(deviation, hausdorff), PRCAGE_FIELD(deviation, mean_distance),
          PRCAGE_FIELD(deviation, normal_deviation)};
}

Json json_of(const ThicknessViolation& violation) {
  return {PRCAGE_FIELD(violation, tau), PRCAGE_FIELD(violation, max), PRCAGE_FIELD(violation, mean),
          PRCAGE_FIELD(violation, fraction)};
}

Json json_of(const SilhouetteDeviation& silhouette) {
  return {PRCAGE_FIELD(silhouette, views), PRCAGE_FIELD(silhouette, mean), PRCAGE_FIELD(silhouette, max)};
}

Json json_of(const SmallestAngles& angles) {
  return {PRCAGE_FIELD(angles, min), PRCAGE_FIELD(angles, fifth_percentile), PRCAGE_FIELD(angles, mean)};
}

// What was not measured is null.
Json json_of(const CageMeasures& measures) {
  return {PRCAGE_FIELD(measures, input_closed),
          PRCAGE_FIELD(measures, input_faces),
          PRCAGE_FIELD(measures, cage_faces),
          PRCAGE_FIELD(measures, diagonal),
          {"hausdorff", measures.hausdorff()},
          {"cage_to_input", json_of(measures.cage_to_input)},
          {"input_to_cage", json_of(measures.input_to_cage)},
          {"violation", measures.violation ? json_of(*measures.violation) : Json()},
          {"volume_ratio", measures.volume_ratio ? Json(*measures.volume_ratio) : Json()},
          PRCAGE_FIELD(measures, area_ratio),
          {"smallest_angle", json_of(measures.smallest_angle)},
          PRCAGE_FIELD(measures, inverted_faces),
          {"silhouette", measures.silhouette ? json_of(*measures.silhouette) : Json()}};
}

Json json_of(const MeasureOptions& options) {
  return {PRCAGE_FIELD(options, samples), PRCAGE_FIELD(options, seed), PRCAGE_FIELD(options, views),
          PRCAGE_FIELD(options, threads)};
}

// What was asked for and did not come about has no entry, unless it is what ended the sequence.
Json levels_json(const CageCommand& command, const std::vector<Result>& results, const RunRecord& record) {
  Json levels = Json::array();
  for (std::size_t i = 0; i < results.size() && i < command.levels.size(); ++i) {
    const Result& result = results[i];
    levels.push_back({{"face_budget", command.levels[i]},
                      {"output", level_path(command.output, command.levels[i])},
                      {"cage_written", i < record.levels_written},
                      {"status", to_string(result.status)},
                      PRCAGE_FIELD(result, message),
                      {"statistics", json_of(result.statistics)},
                      {"certificate", json_of(result.certificate)},
                      {"around_previous", result.around_previous ? json_of(*result.around_previous) : Json()}});
  }
  return levels;
}

#undef PRCAGE_FIELD

}  // namespace

std::string run_json(const CageCommand& command, const InputMesh* input, const std::vector<Result>& results,
                     const RunRecord& record) {
  Json json = header();
  json["status"] = record.status;
  json["message"] = record.message;
  json["exit_code"] = static_cast<int>(record.exit_code);
  json["cage_written"] = record.cage_written;
  json["options"] = json_of(command, results.empty() ? 0 : results.front().statistics.diagonal);
  json["seconds"] = {
      {"total", record.total_seconds}, {"read", input ? input->seconds : 0}, {"write", record.write_seconds}};
  if (input) json["input"] = json_of(*input);
  if (record.wrap) json["wrap"] = json_of(*record.wrap);
  if (results.empty()) return text_of(json);
  json["validation"] = json_of(results.front().validation);
  if (!command.levels.empty()) {
    json["levels"] = levels_json(command, results, record);
  } else {
    json["statistics"] = json_of(results.front().statistics);
    json["certificate"] = json_of(results.front().certificate);
  }
  return text_of(json);
}

namespace {

template <class AnyCommand>
std::string any_surface_run_json(const AnyCommand& command, const InputMesh* input, const SimplifyResult* result,
                                 const RunRecord& record) {
  Json json = header();
  json["status"] = record.status;
  json["message"] = record.message;
  json["exit_code"] = static_cast<int>(record.exit_code);
  json["written"] = record.cage_written;
  json["options"] = json_of(command);
  json["seconds"] = {
      {"total", record.total_seconds}, {"read", input ? input->seconds : 0}, {"write", record.write_seconds}};
  if (input) json["input"] = json_of(*input);
  if (record.wrap) json["wrap"] = json_of(*record.wrap);
  if (result) {
    json["tau_inner"] = result->tau_inner;
    json["tau_outer"] = result->tau_outer;
    json["statistics"] = json_of(result->statistics);
    json["validation"] = json_of(result->validation);
    json["certificate"] = json_of(result->certificate);
    json["deviation"] = result->deviation ? json_of(*result->deviation) : Json();
  }
  return text_of(json);
}

}  // namespace

std::string surface_run_json(const SimplifyCommand& command, const InputMesh* input, const SimplifyResult* result,
                             const RunRecord& record) {
  return any_surface_run_json(command, input, result, record);
}

std::string surface_run_json(const LowPolyCommand& command, const InputMesh* input, const SimplifyResult* result,
                             const RunRecord& record) {
  return any_surface_run_json(command, input, result, record);
}

std::string validation_json(const InputMesh& input, const Validation& validation) {
  Json json = header();
  json["input"] = json_of(input);
  json["validation"] = json_of(validation);
  return text_of(json);
}

std::string certificate_json(const InputMesh& input, const InputMesh& cage, const Certificate& certificate) {
  Json json = header();
  json["input"] = json_of(input);
  json["cage"] = json_of(cage);
  json["certificate"] = json_of(certificate);
  return text_of(json);
}

std::string evaluation_json(const EvalCommand& command, const InputMesh& input, const InputMesh& cage,
                            const CageMeasures& measures, double seconds) {
  Json json = header();
  json["options"] = json_of(command.options);
  json["seconds"] = {{"total", input.seconds + cage.seconds + seconds}, {"measure", seconds}};
  json["input"] = json_of(input);
  json["cage"] = json_of(cage);
  json["conditions"] = json_of(paper_conditions(measures.certificate));
  json["certificate"] = json_of(measures.certificate);
  json["measures"] = json_of(measures);
  return text_of(json);
}

std::string info_json(const InputMesh& input, const MeshMeasures& measures) {
  Json json = header();
  json["file"] = json_of(input);
  json["measures"] = json_of(measures);
  return text_of(json);
}

}  // namespace prcage
