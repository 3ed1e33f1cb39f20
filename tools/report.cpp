#include "tools/report.h"

#include <iterator>
#include <vector>

#include <fmt/format.h>

namespace prcage {
namespace {

template <typename... Args>
void add(std::string& text, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
}

// "1 face", "2 faces".
std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string point(const std::array<double, 3>& p) { return fmt::format("({:.9g}, {:.9g}, {:.9g})", p[0], p[1], p[2]); }

std::string joined(const std::vector<std::string>& parts) { return fmt::format("{}", fmt::join(parts, ", ")); }

// --------------------------------------------------------------------------------------------------- defects

struct DefectText {
  const char* one;
  const char* many;  // null: of the mesh as a whole, not to be counted
  const char* meaning;
  const char* remedy;
};

DefectText text_of(DefectKind kind) {
  switch (kind) {
    case DefectKind::no_faces:
      return {"empty mesh", nullptr, "there is no face at all",
              "export the surface as triangles: a cage needs a closed triangle mesh"};
    case DefectKind::index_out_of_range:
      return {"index out of range", "indices out of range", "a face names a vertex that the file does not have",
              "the file is damaged: export it again"};
    case DefectKind::repeated_vertex:
      return {"face with a repeated vertex", "faces with a repeated vertex", "a face names one vertex twice",
              "delete these faces and close the surface where they were"};
    case DefectKind::not_finite:
      return {"vertex that is not finite", "vertices that are not finite", "a coordinate is NaN or infinite",
              "correct the coordinates, or delete these vertices and close the holes"};
    case DefectKind::too_large:
      return {"coordinate out of range", "coordinates out of range",
              "coordinates are beyond 1e15, or the whole mesh is too small for double precision",
              "scale the mesh, or move it to the origin"};
    case DefectKind::boundary_edge:
      return {"boundary edge", "boundary edges", "an edge has only one face: the surface is open",
              "close the holes of the surface (\"fill holes\" in a mesh editor)"};
    case DefectKind::non_manifold_edge:
      return {"non-manifold edge", "non-manifold edges", "more than two faces meet in an edge",
              "delete the inner or doubled faces, or separate the solids that share the edge"};
    case DefectKind::inconsistent_edge:
      return {"inconsistently oriented edge", "inconsistently oriented edges",
              "the two faces of an edge are oriented against each other",
              "orient the faces consistently (\"re-orient faces\" or \"recalculate outside\" in a mesh editor)"};
    case DefectKind::non_manifold_vertex:
      return {"non-manifold vertex", "non-manifold vertices", "parts of the surface touch in a single vertex",
              "split the vertex and move the parts slightly apart"};
    case DefectKind::duplicate_face:
      return {"duplicate face", "duplicate faces", "two faces have the same three vertices",
              "delete one of each, or both where they close a flat pocket"};
    case DefectKind::self_intersection:
      return {"self-intersection", "self-intersections", "two faces meet outside their common vertices and edges",
              "separate the parts that run into each other, or unite them (boolean union in a mesh editor)"};
    case DefectKind::degenerate_face:
      return {"degenerate face", "degenerate faces", "a face has no area and no local repair removes it",
              "collapse or delete these faces (\"remove zero area faces\" in a mesh editor)"};
    case DefectKind::inside_out:
      return {"inside-out mesh", nullptr, "its faces look inward, its volume is negative",
              "turn the faces round, or let `prcage cage --flip` do it"};
    case DefectKind::nested_orientation:
      return {"component that contradicts its nesting", "components that contradict their nesting",
              "a solid lies inside another solid, or a cavity outside of any",
              "delete the inner solid, or turn it round if it is meant to be a cavity"};
  }
  return {"defect", "defects", to_string(kind), "repair the mesh"};
}

// "face 3, faces 3 and 7", or nothing.
void add_elements(std::vector<std::string>& parts, const std::array<std::uint32_t, 2>& elements, const char* one,
                  const char* many) {
  if (elements[0] == DefectExample::no_element) return;
  if (elements[1] == DefectExample::no_element) {
    parts.push_back(fmt::format("{} {}", one, elements[0]));
  } else {
    parts.push_back(fmt::format("{} {} and {}", many, elements[0], elements[1]));
  }
}

std::string example_text(const DefectExample& example) {
  std::vector<std::string> parts;
  add_elements(parts, example.faces, "face", "faces");
  add_elements(parts, example.vertices, "vertex", "vertices");
  parts.push_back(fmt::format("at {}", point(example.position)));
  return joined(parts);
}

std::size_t count_of(const Validation& validation, DefectKind kind) {
  std::size_t count = 0;
  for (const Defect& defect : validation.defects) count += defect.kind == kind ? defect.count : 0;
  return count;
}

// Open only because its vertices were never merged? Then says what merging them would do: the other defects may well
// go with it.
std::string weld_hint(const InputMesh& input, const Validation& validation) {
  if (count_of(validation, DefectKind::boundary_edge) == 0) return {};
  const std::size_t before = count_boundary_edges(input.file.mesh);
  Mesh welded = input.file.mesh;
  if (weld_equal_positions(welded) == 0) return {};
  const std::size_t after = count_boundary_edges(welded);
  if (after >= before) return {};
  return fmt::format("  try --weld first: merging vertices at equal positions closes {} of {}\n", before - after,
                     counted(before, "boundary edge", "boundary edges"));
}

// Only such a surface has its zero-area faces removed.
bool is_closed_manifold(const Validation& validation) {
  using enum DefectKind;
  const auto none = [&](DefectKind kind) { return count_of(validation, kind) == 0; };
  return none(boundary_edge) && none(non_manifold_edge) && none(inconsistent_edge) && none(non_manifold_vertex) &&
         none(duplicate_face);
}

// What became of the zero-area faces of a mesh that has other defects.
std::string zero_area_note(const Validation& validation) {
  const std::size_t all = validation.degenerate_faces;
  const std::size_t left = count_of(validation, DefectKind::degenerate_face);
  if (all <= left) return {};
  if (!is_closed_manifold(validation)) {
    return fmt::format("  note: {}, left out of the test for self-intersections\n",
                       counted(all, "zero-area face", "zero-area faces"));
  }
  return fmt::format("  note: {}, removed by exact repair\n", counted(all - left, "zero-area face", "zero-area faces"));
}

void add_defect(std::string& text, const Defect& defect) {
  const DefectText words = text_of(defect.kind);
  const std::string what = words.many == nullptr ? words.one : counted(defect.count, words.one, words.many);
  add(text, "  {}: {}\n", what, words.meaning);
  for (const DefectExample& example : defect.examples) add(text, "    {}\n", example_text(example));
  if (defect.count > defect.examples.size() && !defect.examples.empty()) {
    add(text, "    and {} more\n", defect.count - defect.examples.size());
  }
  add(text, "    what to do: {}\n", words.remedy);
}

// ---------------------------------------------------------------------------------------- what was done to a mesh

void add_if(std::vector<std::string>& parts, std::size_t count, const char* one, const char* many) {
  if (count > 0) parts.push_back(counted(count, one, many));
}

// What the reader changed or left out.
std::string reader_text(const InputMesh& input) {
  std::vector<std::string> parts;
  add_if(parts, input.file.polygons, "polygon cut into triangles", "polygons cut into triangles");
  add_if(parts, input.file.skipped_elements, "element skipped that is no face", "elements skipped that are no faces");
  add_if(parts, input.file.welded_corners, "STL corner welded", "STL corners welded");
  add_if(parts, input.welded_vertices, "vertex welded", "vertices welded");
  add_if(parts, input.collapsed_faces, "face removed that welding collapsed", "faces removed that welding collapsed");
  return joined(parts);
}

// What is legal but not carried into the cage.
std::string dropped_text(const Validation& validation) {
  std::vector<std::string> parts;
  add_if(parts, validation.unreferenced_vertices, "unreferenced vertex", "unreferenced vertices");
  add_if(parts, validation.degenerate_faces, "zero-area face", "zero-area faces");
  return joined(parts);
}

// What is not even wrapped.
std::string dropped_text(const DroppedFaces& dropped) {
  std::vector<std::string> parts;
  add_if(parts, dropped.index_out_of_range, "face with an index out of range", "faces with an index out of range");
  add_if(parts, dropped.not_finite, "face that is not finite or too large", "faces that are not finite or too large");
  add_if(parts, dropped.no_area, "zero-area face", "zero-area faces");
  return joined(parts);
}

std::string wrap_text(const Wrap& wrap) {
  return fmt::format("{}, alpha {:.3g} and offset {:.3g} of the diagonal, {:.2f} s",
                     counted(wrap.mesh.triangles.size(), "face", "faces"), wrap.settings.alpha, wrap.settings.offset,
                     wrap.seconds);
}

void add_line(std::string& text, const char* label, const std::string& line) {
  if (!line.empty()) add(text, "  {:<14} {}\n", label, line);
}

// ----------------------------------------------------------------------------------------------- certificate

void add_check(std::string& text, const char* what, bool holds, const std::string& note = {}) {
  add(text, "  {:<28} {}{}\n", what, holds ? "yes" : "NO", note.empty() ? "" : fmt::format(" ({})", note));
}

std::string pairs_note(std::size_t pairs) {
  return pairs == 0 ? "" : counted(pairs, "pair of faces", "pairs of faces");
}

std::string displacement_text(const Statistics& statistics) {
  std::vector<std::string> parts{fmt::format("{:.3g} to {:.3g}", statistics.sigma_min, statistics.sigma_max)};
  add_if(parts, statistics.singular_vertices, "singular vertex", "singular vertices");
  add_if(parts, statistics.capped_vertices, "of them capped", "of them capped");
  add_if(parts, statistics.halved_vertices, "vertex with a halved step", "vertices with a halved step");
  return joined(parts);
}

std::string time_text(const Statistics& statistics, double seconds) {
  return fmt::format("{:.2f} s on {}, {:.0f} MB", seconds,
                     counted(static_cast<std::size_t>(statistics.threads), "thread", "threads"),
                     static_cast<double>(statistics.peak_memory_bytes) * 1e-6);
}

// ------------------------------------------------------------------------------------------------------ eval

std::string conditions_text(const CageMeasures& measures) {
  const PaperConditions conditions = paper_conditions(measures.certificate);
  std::string text = fmt::format("conditions: {}\n", conditions.success() ? "all four hold" : "NOT ALL HOLD");
  add_check(text, "no self-intersection", conditions.self_intersection_free,
            pairs_note(measures.certificate.self_intersections));
  add_check(text, "manifold", conditions.manifold);
  add_check(text, "strictly encloses the input", conditions.strictly_encloses,
            measures.input_closed ? pairs_note(measures.certificate.contacts)
                                  : "the input is not a closed surface: nothing can be said");
  add_check(text, "same Euler characteristic", conditions.topology_equal,
            std::to_string(measures.certificate.euler_characteristic));
  return text;
}

std::string deviation_text(const CageMeasures& measures) {
  const SurfaceDeviation& out = measures.cage_to_input;
  const SurfaceDeviation& in = measures.input_to_cage;
  std::string text = fmt::format("distances, relative to the diagonal of {:.9g}\n", measures.diagonal);
  add(text, "  {:<14} {:>13} {:>13} {:>13}\n", "", "cage to input", "input to cage", "both");
  add(text, "  {:<14} {:>13.6f} {:>13.6f} {:>13.6f}\n", "Hausdorff", out.hausdorff, in.hausdorff, measures.hausdorff());
  add(text, "  {:<14} {:>13.6f} {:>13.6f}\n", "mean", out.mean_distance, in.mean_distance);
  add(text, "  {:<14} {:>9.3f} deg {:>9.3f} deg\n", "normals, mean", out.normal_deviation, in.normal_deviation);
  if (!measures.violation) return text;
  const ThicknessViolation& violation = *measures.violation;
  add_line(text, "beyond tau",
           fmt::format("of {:.6g}: at most {:.6g}, mean {:.6g}, {:.3f} % of the cage", violation.tau, violation.max,
                       violation.mean, 100 * violation.fraction));
  return text;
}

std::string silhouette_text(const CageMeasures& measures) {
  if (!measures.silhouette) return {};
  const SilhouetteDeviation& silhouette = *measures.silhouette;
  std::string text = "outlines, difference over the area of the input's\n";
  add_line(text, "silhouettes",
           fmt::format("mean {:.4f} %, largest {:.4f} %, of {}", 100 * silhouette.mean, 100 * silhouette.max,
                       counted(silhouette.views, "view", "views")));
  return text;
}

std::string sizes_text(const CageMeasures& measures) {
  std::string text = "sizes\n";
  add_line(text, "faces", fmt::format("{} -> {}", measures.input_faces, measures.cage_faces));
  add_line(text, "volume ratio",
           measures.volume_ratio ? fmt::format("{:.6f}", *measures.volume_ratio) : "not known: a mesh has no volume");
  add_line(text, "area ratio", fmt::format("{:.6f}", measures.area_ratio));
  const SmallestAngles& angles = measures.smallest_angle;
  add_line(text, "least angle",
           fmt::format("{:.6g} deg, 5th percentile {:.6g} deg, mean {:.6g} deg", angles.min, angles.fifth_percentile,
                       angles.mean));
  add_line(text, "inverted", counted(measures.inverted_faces, "face", "faces"));
  return text;
}

// ------------------------------------------------------------------------------------------------------ info

std::string range_text(const ValueRange& range, const char* unit) {
  return fmt::format("{:.6g} to {:.6g}{}, mean {:.6g}{}", range.min, range.max, unit, range.mean, unit);
}

std::string surface_text(const MeshMeasures& measures) {
  std::vector<std::string> parts{counted(measures.components, "component", "components"),
                                 fmt::format("Euler characteristic {}", measures.euler_characteristic)};
  add_if(parts, measures.boundary_edges, "boundary edge", "boundary edges");
  add_if(parts, measures.non_manifold_edges, "non-manifold edge", "non-manifold edges");
  if (measures.boundary_edges == 0 && measures.non_manifold_edges == 0) parts.push_back("no open or non-manifold edge");
  return joined(parts);
}

}  // namespace

std::string validation_headline(const InputMesh& input, const Validation& validation) {
  const std::string name = input_name(input.path);
  if (validation.valid()) return fmt::format("{}: valid input", name);
  return fmt::format("{}: not a valid input: {} (faces and vertices are counted from 0)", name,
                     counted(validation.defects.size(), "kind of defect", "kinds of defects"));
}

std::string validation_details(const InputMesh& input, const Validation& validation) {
  std::string text = weld_hint(input, validation);
  for (const Defect& defect : validation.defects) add_defect(text, defect);
  if (!validation.valid()) return text + zero_area_note(validation);
  add_line(text, "size", fmt::format("{} vertices, {} faces", validation.vertices, validation.faces));
  add_line(text, "surface",
           fmt::format("{}, {}, Euler characteristic {}", counted(validation.components, "component", "components"),
                       counted(validation.cavities, "cavity", "cavities"), validation.euler_characteristic));
  add_line(text, "measures",
           fmt::format("diagonal {:.9g}, area {:.9g}, volume {:.9g}", validation.diagonal, validation.area,
                       validation.volume));
  add_line(text, "reader", reader_text(input));
  add_line(text, "would drop", dropped_text(validation));
  return text;
}

std::string pair_headline(const InputMesh& input, const InputMesh& cage) {
  return fmt::format("{}: cage of {} faces around {}, {} faces\n", input_name(cage.path),
                     cage.file.mesh.triangles.size(), input_name(input.path), input.file.mesh.triangles.size());
}

std::string wrap_hint() {
  return "  or take it as it is: --wrap cages an alpha wrap of it; the cage then encloses every face of\n"
         "  the input, but has the topology of the wrap\n";
}

std::string certificate_text(const Certificate& certificate, bool of_wrap) {
  std::string text = fmt::format("certificate: {}\n", certificate.valid() ? "valid" : "NOT VALID");
  add_check(text, "closed", certificate.closed);
  add_check(text, "manifold", certificate.manifold);
  add_check(text, "consistently oriented", certificate.oriented);
  add_check(text, "no degenerate face", certificate.no_degenerate_face);
  add_check(text, "no self-intersection", certificate.self_intersection_free,
            pairs_note(certificate.self_intersections));
  add_check(text, "no contact with the input", certificate.no_contact, pairs_note(certificate.contacts));
  add_check(text, "encloses the input", certificate.encloses);
  add_check(text, of_wrap ? "wrap's Euler characteristic" : "same Euler characteristic",
            certificate.euler_characteristic_equal, std::to_string(certificate.euler_characteristic));
  add_check(text, of_wrap ? "wrap's number of components" : "same number of components",
            certificate.component_count_equal, std::to_string(certificate.components));
  return text;
}

std::string evaluation_text(const InputMesh& input, const InputMesh& cage, const CageMeasures& measures) {
  std::string text = pair_headline(input, cage) + conditions_text(measures);
  if (measures.certificate.valid()) {
    text += "certificate: valid\n";
  } else {
    text += certificate_text(measures.certificate);
    add(text, "  where: prcage check {} --cage {}\n", input.path, cage.path);
  }
  return text + deviation_text(measures) + silhouette_text(measures) + sizes_text(measures);
}

std::string run_text(const CageCommand& command, const InputMesh& input, const Result& result, const Wrap* wrap,
                     double seconds) {
  const Statistics& statistics = result.statistics;
  std::string text = fmt::format("{} -> {}: {} -> {}\n", input_name(command.input), output_name(command.output),
                                 counted(statistics.input_faces, "face", "faces"), statistics.cage_faces);
  add_line(text, "time", time_text(statistics, seconds));
  add_line(text, "tau",
           fmt::format("{:.6g} = {:.6g} of the diagonal, {}{}", statistics.tau, statistics.tau / statistics.diagonal,
                       command.options.tau_mode == TauMode::strict ? "strict" : "at face centroids only",
                       wrap == nullptr ? "" : ", from the wrap"));
  if (wrap != nullptr) add_line(text, "wrap", wrap_text(*wrap));
  add_line(text, "displacement", displacement_text(statistics));
  add_line(text, "reader", reader_text(input));
  add_line(text, "dropped", wrap == nullptr ? dropped_text(result.validation) : dropped_text(wrap->dropped));
  return text + certificate_text(result.certificate, wrap != nullptr);
}

std::string certificate_text(const SurfaceCertificate& certificate) {
  std::string text = fmt::format("certificate: {}\n", certificate.valid() ? "valid" : "NOT VALID");
  add_check(text, "closed", certificate.closed);
  add_check(text, "manifold", certificate.manifold);
  add_check(text, "consistently oriented", certificate.oriented);
  add_check(text, "no degenerate face", certificate.no_degenerate_face);
  add_check(text, "no self-intersection", certificate.self_intersection_free,
            pairs_note(certificate.self_intersections));
  add_check(text, "every face looks outward", certificate.bounds_solid);
  add_check(text, "same Euler characteristic", certificate.euler_characteristic_equal,
            std::to_string(certificate.euler_characteristic));
  add_check(text, "same number of components", certificate.component_count_equal,
            std::to_string(certificate.components));
  add_check(text, "same number of cavities", certificate.cavity_count_equal, std::to_string(certificate.cavities));
  return text;
}

std::string surface_run_text(const MeshCommand& command, TauMode mode, const InputMesh& input,
                             const SimplifyResult& result, const Wrap* wrap, double seconds) {
  const Statistics& statistics = result.statistics;
  const double l = statistics.diagonal;
  std::string text = fmt::format("{} -> {}: {} -> {}\n", input_name(command.input), output_name(command.output),
                                 counted(statistics.input_faces, "face", "faces"), statistics.cage_faces);
  add_line(text, "time", time_text(statistics, seconds));
  add_line(text, "tolerance",
           fmt::format("{:.6g} inside, {:.6g} outside, of the diagonal of {:.9g}, {}", result.tau_inner / l,
                       result.tau_outer / l, l, mode == TauMode::strict ? "strict" : "at face centroids only"));
  if (wrap != nullptr) add_line(text, "wrap", wrap_text(*wrap));
  if (result.deviation) {
    const TwoSidedDeviation& deviation = *result.deviation;
    add_line(text, "measured",
             fmt::format("{:.6g} inside, {:.6g} outside, {:.6g} from the input to the surface", deviation.inside,
                         deviation.outside, deviation.from_input));
  }
  add_line(text, "reader", reader_text(input));
  add_line(text, "dropped", dropped_text(result.validation));
  return text + certificate_text(result.certificate);
}

std::string levels_text(const CageCommand& command, const InputMesh& input, const std::vector<Result>& levels,
                        const Wrap* wrap, double seconds) {
  const Statistics& first = levels.front().statistics;
  std::string text = fmt::format("{}: {}\n", input_name(command.input), counted(first.input_faces, "face", "faces"));
  add_line(text, "time",
           fmt::format("{:.2f} s on {}, {:.0f} MB", seconds,
                       counted(static_cast<std::size_t>(first.threads), "thread", "threads"),
                       static_cast<double>(levels.back().statistics.peak_memory_bytes) * 1e-6));
  if (wrap != nullptr) add_line(text, "wrap", wrap_text(*wrap));
  add_line(text, "reader", reader_text(input));
  add_line(text, "dropped", wrap == nullptr ? dropped_text(levels.front().validation) : dropped_text(wrap->dropped));
  add(text, "  {:>8} {:>12} {:>9}  certificate\n", "faces", "tau", "seconds");
  for (std::size_t i = 0; i < levels.size() && levels[i].has_cage(); ++i) {
    const Statistics& s = levels[i].statistics;
    add(text, "  {:>8} {:>12.6g} {:>9.2f}  valid around the input{} -> {}\n", s.cage_faces, s.tau / s.diagonal,
        s.seconds.total, levels[i].around_previous ? " and the level before" : "",
        level_path(command.output, command.levels[i]));
  }
  return text;
}

std::string info_text(const InputMesh& input, const MeshMeasures& measures) {
  std::string text = fmt::format("{}\n", input_name(input.path));
  add_line(text, "format",
           fmt::format("{}, {} positions", to_string(input.file.format),
                       input.file.float_positions ? "32-bit" : "64-bit or text"));
  add_line(text, "size", fmt::format("{} vertices, {} faces", measures.vertices, measures.faces));
  add_line(text, "reader", reader_text(input));
  if (measures.usable_faces < measures.faces) {
    add_line(text, "not usable",
             fmt::format("{} (index out of range or coordinate not finite)",
                         counted(measures.faces - measures.usable_faces, "face", "faces")));
  }
  if (measures.referenced_vertices < measures.vertices) {
    add_line(text, "not in use", counted(measures.vertices - measures.referenced_vertices, "vertex", "vertices"));
  }
  add_line(text, "box", fmt::format("{} to {}", point(measures.lower), point(measures.upper)));
  add_line(text, "diagonal", fmt::format("{:.9g}", measures.diagonal));
  add_line(text, "area", fmt::format("{:.9g}", measures.area));
  add_line(text, "volume", fmt::format("{:.9g}", measures.volume));
  add_line(text, "surface", surface_text(measures));
  add_line(text, "edge length", range_text(measures.edge_length, ""));
  add_line(text, "least angle", range_text(measures.smallest_angle, " deg"));
  add_line(text, "largest angle", fmt::format("{:.6g} deg", measures.largest_angle));
  return text;
}

}  // namespace prcage
