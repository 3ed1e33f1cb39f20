// The public interface of prcage: a dense closed triangle mesh in, a certified tight bounding cage out.
//
// A cage is a mesh of few faces that strictly encloses the input, has its topology, does not intersect itself
// and stays within a distance tau of it (PR-Cage: progressive feasibility relaxation). Every result carries a
// certificate computed from scratch with exact predicates on the coordinates that are returned.
//
// Contract of every function here: no global state, no exception leaves it except std::bad_alloc, any number
// of calls may run at the same time in one process, and the result is the same to the last bit for any number
// of threads. Lengths are in the input's unit unless they are said to be relative; `l` is the length of the
// diagonal of the input's bounding box.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace prcage {

// ------------------------------------------------------------------------------------------------ meshes

// Triangle mesh that owns its arrays. Positions are #V by 3, triangles #F by 3 vertex indices, counterclockwise
// seen from outside.
struct Mesh {
  std::vector<std::array<double, 3>> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

enum class Scalar { float32, float64 };

// The caller's arrays, borrowed for the duration of a call and never written. Strides are in bytes; 0 means
// tightly packed. Triangles are three 32-bit vertex indices each.
struct MeshView {
  const void* positions = nullptr;
  std::size_t vertex_count = 0;
  std::size_t position_stride = 0;
  Scalar scalar = Scalar::float64;
  const std::uint32_t* triangles = nullptr;
  std::size_t triangle_count = 0;
  std::size_t triangle_stride = 0;

  MeshView() = default;
  MeshView(const Mesh& mesh)  // NOLINT(google-explicit-constructor): a mesh is a view of itself
      : positions(mesh.positions.data()),
        vertex_count(mesh.positions.size()),
        triangles(mesh.triangles.empty() ? nullptr : mesh.triangles.front().data()),
        triangle_count(mesh.triangles.size()) {}
};

// ------------------------------------------------------------------------------------------------ status

enum class Status {
  ok,
  face_budget_not_reached,  // the cage is valid, but within tau no fewer faces than it has were reached
  cancelled,                // the cage is valid: what had been reached when the caller cancelled
  deadline_reached,         // the same at the deadline; none if that passed before there was a cage
  invalid_options,          // nothing computed; Result::message names the option
  invalid_input,            // nothing computed; Result::validation lists the defects
  displacement_failed,      // the input could not be moved off itself without a collision: no cage
  certificate_failed,       // no cage: a defect of prcage, or rounding to floats (Options::precision) broke it
  internal_error,           // a defect of prcage or of a library; Result::message says what is known
};

// Stable lower-case identifier of a status, e.g. "face_budget_not_reached".
const char* to_string(Status status);

// --------------------------------------------------------------------------------------------- validation

enum class DefectKind {
  no_faces,
  index_out_of_range,   // a triangle names a vertex that does not exist
  repeated_vertex,      // a triangle names one vertex twice
  not_finite,           // NaN or infinite coordinate of a vertex in use
  too_large,            // coordinates beyond 1e15 or so small that l underflows
  boundary_edge,        // edge with one face
  non_manifold_edge,    // edge with more than two faces
  inconsistent_edge,    // two faces pass the edge in the same direction
  non_manifold_vertex,  // faces of the vertex do not form one fan
  duplicate_face,       // two faces on the same three vertices
  self_intersection,    // two faces meet outside their common vertices and edges
  degenerate_face,      // zero-area face that no exact local repair removes
  inside_out,           // every component is turned inside out
  nested_orientation,   // a component's orientation contradicts its nesting: overlapping solids
};

const char* to_string(DefectKind kind);

// One place where a defect was found. Unused element slots are no_element.
struct DefectExample {
  static constexpr std::uint32_t no_element = 0xffffffffu;
  std::array<std::uint32_t, 2> faces{no_element, no_element};     // zero-based
  std::array<std::uint32_t, 2> vertices{no_element, no_element};  // zero-based
  std::array<double, 3> position{};                               // a point on the element
};

struct Defect {
  DefectKind kind{};
  std::size_t count = 0;
  std::vector<DefectExample> examples;  // at most five, lowest element numbers first
};

// What validate() finds. A mesh is a legal input exactly if `defects` is empty.
struct Validation {
  std::vector<Defect> defects;
  std::size_t vertices = 0;               // as given
  std::size_t faces = 0;                  // as given
  std::size_t unreferenced_vertices = 0;  // legal, dropped
  std::size_t duplicate_vertices = 0;     // legal: vertices at the position of another one
  std::size_t degenerate_faces = 0;       // legal, removed by exact local repair that keeps the point set
  std::size_t components = 0;             // of the surface
  std::size_t cavities = 0;               // components that bound a hollow of a solid
  long long euler_characteristic = 0;
  double diagonal = 0;  // l
  double area = 0;
  double volume = 0;  // signed, cavities subtracted

  bool valid() const { return defects.empty(); }
};

// ------------------------------------------------------------------------------------------- certificate

// The answer, from exact predicates on final coordinates, to "is this cage what it claims to be".
struct Certificate {
  bool closed = false;
  bool manifold = false;            // edges and vertices
  bool oriented = false;            // consistently
  bool no_degenerate_face = false;  // no three collinear corners
  bool self_intersection_free = false;
  bool no_contact = false;  // no face of the cage touches a face of the input
  bool encloses = false;    // every component of the input is inside, the cage bounds a volume
  bool euler_characteristic_equal = false;
  bool component_count_equal = false;

  std::size_t components = 0;
  long long euler_characteristic = 0;
  std::size_t self_intersections = 0;  // intersecting pairs of cage faces
  std::size_t contacts = 0;            // pairs (cage face, input face) that touch

  bool valid() const {
    return closed && manifold && oriented && no_degenerate_face && self_intersection_free && no_contact && encloses &&
           euler_characteristic_equal && component_count_equal;
  }
};

// The same question of a simplified surface, which encloses nothing.
struct SurfaceCertificate {
  bool closed = false;
  bool manifold = false;            // edges and vertices
  bool oriented = false;            // consistently
  bool no_degenerate_face = false;  // no three collinear corners
  bool self_intersection_free = false;
  bool bounds_solid = false;  // every face looks out of the solid: no component is turned inside out or misplaced
  bool euler_characteristic_equal = false;
  bool component_count_equal = false;
  bool cavity_count_equal = false;

  std::size_t components = 0;
  std::size_t cavities = 0;
  long long euler_characteristic = 0;
  std::size_t self_intersections = 0;  // intersecting pairs of faces

  bool valid() const {
    return closed && manifold && oriented && no_degenerate_face && self_intersection_free && bounds_solid &&
           euler_characteristic_equal && component_count_equal && cavity_count_equal;
  }
};

// The four conditions by which the paper counts a cage as a success (sec. 4.1), in terms of the certificate. The last
// one is weaker than the certificate, which also compares the numbers of components.
struct PaperConditions {
  bool self_intersection_free = false;
  bool manifold = false;           // closed and consistently oriented as well
  bool strictly_encloses = false;  // no contact with the input
  bool topology_equal = false;     // Euler characteristic

  bool success() const { return self_intersection_free && manifold && strictly_encloses && topology_equal; }
};

PaperConditions paper_conditions(const Certificate& certificate);

// ---------------------------------------------------------------------------------------------- options

enum class TauMode {
  strict,  // the paper's, and proved: no point of the cage is ever farther than tau from the input
  paper,   // in cycle k the centroids of faces are within tau_k, eq. 4
};

// Which distances tau bounds: that of the points of the cage to the input only, or that of the input to the cage as
// well, at up to 40,000 samples of the input, from the time on when the cage has 20,000 faces.
enum class Bound { cage, both };

enum class Precision { float64, float32 };

// What a run may cost, for tightness: how finely the thickness grows, in the end above all, and how often vertices are
// moved back inward. With `best` three cages are made, with the seed and the two after it, and the closest one is
// taken.
enum class Quality { fast, standard, best };

const char* to_string(Quality quality);

struct Options {
  // Thickness of the band outside the input that the cage may use. Relative to l unless tau_absolute > 0,
  // which is in the input's unit and then takes precedence. Range (0, 1]; or 0, with a face budget: the smallest
  // thickness that reaches the budget, found in growing steps.
  double tau = 1.0 / 40;
  double tau_absolute = 0;
  TauMode tau_mode = TauMode::strict;
  Bound bound = Bound::cage;

  // Staircase schedule (paper eq. 6): cycle k works within beta_k * tau. Empty means `cycles` uniform steps
  // beta_k = k / cycles; otherwise a strictly increasing list in (0, 1] that ends at 1. Not used if tau is 0.
  int cycles = 10;
  std::vector<double> schedule;

  // Stop at this many faces, or one below where parity demands. 0: as few as tau allows.
  std::size_t face_budget = 0;

  Quality quality = Quality::standard;
  bool flips = true;               // edge flips after each cycle (paper sec. 3.2)
  double sigma = 1e-5;             // first displacement off the input, relative to l (paper sec. 3.2)
  std::uint64_t seed = 0;          // breaks ties between candidates of equal cost
  int threads = 0;                 // 0: as many as the machine has; TBB's limit of the process holds
  bool accept_inside_out = false;  // turn an inside-out input round instead of refusing it

  // Precision in which the caller will store the result. float32 places every vertex on a float, so that what is
  // certified is what is stored. Cages that stop early, with vertices that no collapse has moved, may fail that way.
  Precision precision = Precision::float64;
};

// Constrained simplification (paper sec. 5.3): the same engine in a band on both sides of the input.
struct SimplifyOptions {
  // How far the surface may go inside of the input and outside of it, in (0, 1] relative to l; or, if `absolute`,
  // positive lengths in the input's unit.
  double tau_inner = 1.0 / 100;
  double tau_outer = 1.0 / 100;
  bool absolute = false;
  TauMode tau_mode = TauMode::strict;  // strict: every point of the surface, each on its side
  // both: the input as well is within the larger of the two of the surface, at up to 180,000 samples. cage: no edge is
  // flipped, since nothing would keep flips from moving the surface away from the input.
  Bound bound = Bound::both;

  int cycles = 10;               // as in Options
  std::vector<double> schedule;  // as in Options
  std::size_t face_budget = 0;   // as in Options
  bool flips = true;
  std::uint64_t seed = 0;
  int threads = 0;
  bool accept_inside_out = false;
  Precision precision = Precision::float64;

  std::size_t samples = 20000;  // at which the deviation of the result is measured, on each surface; 0: it is not
};

// Low-poly meshes (paper sec. 5.4): as few faces as asked for, at the smallest tolerances that allow them, which are
// found in growing steps. What is convex stays where it is; hollows may be filled as far as the wrap reaches.
struct LowPolyOptions {
  std::size_t faces = 300;
  // The tolerance inside of the input over that outside of it, in (0, 1]. Where the wrap is nearer than the inner one,
  // that holds outside, too. It holds at the centroids of faces, as in the paper; every point keeps to the outer one.
  // Without a wrap both are the same.
  double inner_share = 0.5;
  TauMode tau_mode = TauMode::strict;
  Quality quality = Quality::standard;  // how finely the tolerances grow
  bool flips = true;
  std::uint64_t seed = 0;
  int threads = 0;
  bool accept_inside_out = false;
  Precision precision = Precision::float64;
  std::size_t samples = 20000;  // as in SimplifyOptions
};

// ------------------------------------------------------------------------------------- progress and cancel

// Shared between the caller and a run: the run writes progress, anybody may cancel or set a deadline. Thread-safe. One
// Control belongs to one run at a time. Both are sticky and answered within a round (milliseconds to a second on
// millions of faces); the run then certifies and returns the valid cage that it has. The first cage is the input moved
// by a little: a run that is cancelled before it goes on until there is one, at a deadline it ends without.
class Control {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Stage { start, wrap, validate, displace, collapse, flip, tighten, estimate, certify, done };

  void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }

  // Cancels at the n-th report of the run from now on. Unlike at a moment, what is left of it is always the same.
  void cancel_at_report(int n) noexcept { reports_left_.store(n, std::memory_order_relaxed); }

  void set_deadline(Clock::time_point deadline) noexcept { deadline_.store(deadline, std::memory_order_relaxed); }
  bool past_deadline() const noexcept { return Clock::now() >= deadline_.load(std::memory_order_relaxed); }
  bool stopped() const noexcept { return cancelled() || past_deadline(); }

  Stage stage() const noexcept { return stage_.load(std::memory_order_relaxed); }
  int level() const noexcept { return level_.load(std::memory_order_relaxed); }           // 1.., of make_cages()
  int cycle() const noexcept { return cycle_.load(std::memory_order_relaxed); }           // 1..cycles
  std::size_t faces() const noexcept { return faces_.load(std::memory_order_relaxed); }   // of the cage now
  double progress() const noexcept { return progress_.load(std::memory_order_relaxed); }  // 0..1, never falls

  // For the run itself. `progress` is that of the present level.
  void report(Stage stage, int cycle, std::size_t faces, double progress) noexcept {
    stage_.store(stage, std::memory_order_relaxed);
    cycle_.store(cycle, std::memory_order_relaxed);
    faces_.store(faces, std::memory_order_relaxed);
    progress = (level_.load(std::memory_order_relaxed) - 1 + progress) / levels_;
    if (progress > progress_.load(std::memory_order_relaxed)) progress_.store(progress, std::memory_order_relaxed);
    if (reports_left_.load(std::memory_order_relaxed) > 0 && reports_left_.fetch_sub(1, std::memory_order_relaxed) == 1)
      cancel();
  }
  void begin_level(int level, int levels) noexcept {
    levels_ = levels;
    level_.store(level, std::memory_order_relaxed);
  }

 private:
  std::atomic<bool> cancelled_{false};
  std::atomic<int> reports_left_{0};  // 0: as many as there are
  std::atomic<Clock::time_point> deadline_{Clock::time_point::max()};
  int levels_ = 1;  // touched by the run only
  std::atomic<int> level_{1};
  std::atomic<Stage> stage_{Stage::start};
  std::atomic<int> cycle_{0};
  std::atomic<std::size_t> faces_{0};
  std::atomic<double> progress_{0};
};

const char* to_string(Control::Stage stage);

// ------------------------------------------------------------------------------------------------ results

// Why candidates were tried, accepted and rejected; sums over a cycle or a run.
struct Counts {
  std::uint64_t evaluated = 0;             // edges whose placement problem was set up
  std::uint64_t rejected_link = 0;         // link condition
  std::uint64_t rejected_infeasible = 0;   // empty feasible region, eq. 4 and 5
  std::uint64_t selected = 0;              // members of an independent set
  std::uint64_t postponed = 0;             // dearer than thought, or not needed for the budget
  std::uint64_t rejected_orientation = 0;  // exact: a face would sweep inward, or turn over where that is allowed
  std::uint64_t rejected_degenerate = 0;   // exact: a new face is degenerate or the patch folds onto itself
  std::uint64_t rejected_tau = 0;  // a new face could not be proved within reach, or would uncover samples of the input
  std::uint64_t rejected_cage =
      0;  // exact: the patch would hit the rest of the cage, or sweep over a component of the input
  std::uint64_t rejected_conflict = 0;  // lost against another patch of the same round
  std::uint64_t collapses = 0;          // accepted
  std::uint64_t flips_tried = 0;
  std::uint64_t flips = 0;      // accepted
  std::uint64_t tightened = 0;  // moves of vertices inward, or of low-poly meshes to where they fit

  Counts& operator+=(const Counts& other);
};

struct CycleStatistics {
  double beta = 0;         // tau of the cycle over that of the run
  double tau = 0;          // beta * tau, input's unit
  std::size_t rounds = 0;  // of independent sets
  std::size_t faces = 0;   // at the end of the cycle
  double seconds = 0;
  Counts counts;
};

// Faces of an input of any kind that a cage cannot be asked to enclose.
struct DroppedFaces {
  std::size_t index_out_of_range = 0;  // of a vertex that does not exist
  std::size_t not_finite = 0;          // or beyond 1e15
  std::size_t no_area = 0;             // three collinear corners, or one named twice

  std::size_t total() const { return index_out_of_range + not_finite + no_area; }
};

// Wall seconds by stage.
struct StageSeconds {
  double total = 0;
  double validate = 0;
  double displace = 0;
  double evaluate = 0;  // constraints, QP, cost
  double select = 0;    // independent sets
  double build = 0;     // new patches, exact local tests
  double distance = 0;  // band around the input, strict tau
  double collide = 0;   // joins, exact triangle pairs, conflicts
  double commit = 0;    // topology, compaction, trees
  double flip = 0;
  double tighten = 0;
  double estimate = 0;  // of the thickness that the face budget needs
  double certify = 0;
};

struct Statistics {
  std::size_t input_vertices = 0;
  std::size_t input_faces = 0;
  DroppedFaces dropped;  // make_cage_around() only
  std::size_t cage_vertices = 0;
  std::size_t cage_faces = 0;
  double diagonal = 0;                // l
  double tau = 0;                     // absolute
  double needed_tau = 0;              // absolute: where tau did not allow the face budget, an upper estimate of one
                                      // that does; 0: none is known
  double sigma_min = 0;               // smallest displacement step used, absolute
  double sigma_max = 0;               // largest
  std::size_t singular_vertices = 0;  // displacement QP infeasible
  std::size_t capped_vertices = 0;    // of those: cut off; the others moved along a mean normal
  std::size_t halved_vertices = 0;    // sigma halved for them at least once
  int threads = 0;
  std::string simd;                     // instruction set of the kernels
  std::uint64_t peak_memory_bytes = 0;  // of the process, highest so far
  std::uint64_t band_voxels = 0;        // distance band: voxels ever filled
  StageSeconds seconds;
  Counts counts;
  std::vector<CycleStatistics> cycles;
};

struct Result {
  Status status = Status::internal_error;
  std::string message;      // empty if ok; one sentence for people otherwise
  Mesh cage;                // empty unless has_cage()
  Validation validation;    // of the input; of the wrap if there is one
  Certificate certificate;  // of the cage
  // Of a level after the first: of the cage, with the level before as the input.
  std::optional<Certificate> around_previous;
  Statistics statistics;

  // The cage is there and certified.
  bool has_cage() const {
    return !cage.triangles.empty() && (status == Status::ok || status == Status::face_budget_not_reached ||
                                       status == Status::cancelled || status == Status::deadline_reached);
  }
};

// How far a simplified surface is from its input, measured at samples, vertices and middles of faces, relative to l:
// lower bounds of the true distances.
struct TwoSidedDeviation {
  double outside = 0;     // of the points of the surface outside of the input, from it
  double inside = 0;      // of those inside of it
  double from_input = 0;  // of the points of the input, from the surface
};

struct SimplifyResult {
  Status status = Status::internal_error;
  std::string message;             // empty if ok; one sentence for people otherwise
  Mesh mesh;                       // empty unless has_mesh()
  Validation validation;           // of the input
  SurfaceCertificate certificate;  // of the mesh
  double tau_inner = 0;            // input's unit; found by the run where they are not given
  double tau_outer = 0;
  std::optional<TwoSidedDeviation> deviation;  // of the mesh, if samples were asked for
  Statistics statistics;                       // its "cage" is the mesh, its tau the larger of the two tolerances

  // The mesh is there and certified.
  bool has_mesh() const {
    return !mesh.triangles.empty() && (status == Status::ok || status == Status::face_budget_not_reached ||
                                       status == Status::cancelled || status == Status::deadline_reached);
  }
};

// --------------------------------------------------------------------------------------------- evaluation

struct MeasureOptions {
  // The thickness t of eq. 8, relative to l unless tau_absolute > 0, which is in the input's unit and then takes
  // precedence. 0 both: the violation of a thickness is not measured.
  double tau = 0;
  double tau_absolute = 0;

  std::size_t samples = 100000;  // points on each surface, at least one
  std::uint64_t seed = 0;        // of the points
  std::size_t views = 24;        // in which silhouettes are compared; 0: they are not
  int threads = 0;               // as in Options
};

// How far a surface is from another one, seen from points of the first. Means are over the samples, that is, over the
// area; the Hausdorff distance also looks at every vertex and at the middle of every edge. Distances are relative to l.
struct SurfaceDeviation {
  double hausdorff = 0;  // one-sided, a lower bound of the true one
  double mean_distance = 0;
  double normal_deviation = 0;  // mean angle between the face at the point and the closest face, degrees
};

// By how much the cage is farther from the input than tau: max(d(x, M) - tau, 0), eq. 8. Relative to l.
struct ThicknessViolation {
  double tau = 0;
  double max = 0;       // over samples, vertices and middles of edges of the cage
  double mean = 0;      // over the area of the cage
  double fraction = 0;  // of the area of the cage that is beyond tau
};

// By how much the outlines of two meshes differ: the area of the symmetric difference of their silhouettes over that of
// the input's, in orthographic views from all around.
struct SilhouetteDeviation {
  std::size_t views = 0;
  double mean = 0;
  double max = 0;
};

struct SmallestAngles {
  double min = 0;
  double fifth_percentile = 0;
  double mean = 0;
};

// The measures of the paper's sec. 4 of a cage around an input.
struct CageMeasures {
  Status status = Status::internal_error;  // ok, invalid_options or invalid_input: one of the meshes
  std::string message;                     // empty if ok; one sentence for people otherwise, and nothing is measured

  Certificate certificate;    // all false unless both meshes can be measured
  bool input_closed = false;  // and consistently oriented: otherwise nothing can be inside of it or around it
  std::size_t input_faces = 0;
  std::size_t cage_faces = 0;
  double diagonal = 0;  // l, input's unit
  SurfaceDeviation cage_to_input;
  SurfaceDeviation input_to_cage;
  std::optional<ThicknessViolation> violation;    // if tau was given
  std::optional<double> volume_ratio;             // cage to input, if both are closed and the input has a volume
  double area_ratio = 0;                          // cage to input
  SmallestAngles smallest_angle;                  // over the faces of the cage, degrees
  std::size_t inverted_faces = 0;                 // of the cage: at none of 15 points of such a face does a face of the
                                                  // input that is closest there look the same way
  std::optional<SilhouetteDeviation> silhouette;  // if views were asked for

  double hausdorff() const {  // in both directions
    return cage_to_input.hausdorff > input_to_cage.hausdorff ? cage_to_input.hausdorff : input_to_cage.hausdorff;
  }
};

// ------------------------------------------------------------------------------------------- deformation

struct BindOptions {
  // Only so many weights of each vertex are kept, those of the largest magnitude; 0: all. What is missing to the sum 1
  // is spread over them in proportion to their magnitudes.
  std::size_t keep = 0;
  Precision precision = Precision::float64;  // in which the weights are kept
  int threads = 0;                           // as in Options
};

// The mean value coordinates of a mesh with respect to a cage: positions of the mesh as weighted means of those of the
// cage (paper sec. 5.5).
struct CageWeights {
  Status status = Status::internal_error;  // ok or invalid_input
  std::string message;                     // empty if ok; one sentence for people otherwise, and there are no weights

  std::size_t vertices = 0;  // of the input
  std::size_t cage_vertices = 0;
  std::size_t cage_faces = 0;
  std::size_t keep = 0;                                 // weights of each vertex; cage_vertices: all
  std::vector<std::uint32_t> columns;                   // whose they are: `keep` vertices of the cage for each vertex,
                                                        // ascending; empty if all are kept
  std::vector<double> values;                           // `keep` for each vertex, or
  std::vector<float> float_values;                      // the same, the other of the two is empty
  std::vector<std::array<std::uint32_t, 3>> triangles;  // of the input

  // What truncation and rounding did. The share of the weights' magnitudes that a vertex lost, and its distance from
  // where it was when the cage is not deformed, relative to l. Over the vertices.
  double largest_loss = 0;
  double mean_loss = 0;
  double largest_rest_error = 0;
  double mean_rest_error = 0;

  bool dense() const { return columns.empty(); }
};

struct Deformation {
  Status status = Status::internal_error;  // ok or invalid_input
  std::string message;                     // empty if ok; one sentence for people otherwise, and the mesh is empty
  Mesh mesh;                               // the triangles of the input
};

// ---------------------------------------------------------------------------------------------- functions

// Checks with exact predicates whether a mesh is a legal input: closed, manifold, consistently and outwardly
// oriented, finite, free of self-intersections, solids not overlapping. threads as in Options.
Validation validate(const MeshView& input, int threads = 0);

// Certifies a cage against an input from scratch. Both must have indices in range and finite positions;
// anything else is answered by a certificate that is not valid.
Certificate certify(const MeshView& input, const MeshView& cage, int threads = 0);

// Certifies what make_cage_around() made: encloses every triangle of the input, has the topology of the wrap.
Certificate certify_around(const MeshView& input, const MeshView& wrap, const MeshView& cage, int threads = 0);

// Measures a cage as the paper does: certificate, distances, normals, thickness, sizes, angles. Neither mesh needs to
// be legal: both must have faces on three existing vertices each, finite positions and some area; unreferenced vertices
// do not count. The same samples are drawn for the same meshes, number and seed.
CageMeasures measure_cage(const MeshView& input, const MeshView& cage, const MeasureOptions& options = {});

// Makes a cage. `control` may be null.
Result make_cage(const MeshView& input, const Options& options = {}, Control* control = nullptr);

// Makes a cage around triangles of any kind (open, intersecting, without orientation) by way of a wrap: a legal input
// whose solid strictly encloses them, such as an alpha wrap. What the options and the result say of the input - tau, l,
// the topology, the defects - is then said of the wrap, except that the certificate proves that every triangle of
// `input` is strictly inside. Faces that have no area or no place are dropped and counted.
Result make_cage_around(const MeshView& input, const MeshView& wrap, const Options& options = {},
                        Control* control = nullptr);

// Binds a mesh to a cage. Of the input only the positions matter, which may lie anywhere; on the cage they are bound to
// the vertex, edge or face that they lie on. The cage must be closed: as many faces pass each edge in one direction as
// in the other; it may have several components and cavities. The weights of a vertex add up to 1 and reproduce its
// position, to some 1e-12 of l: the formula gives weights that do so already, and they are only scaled to the sum 1. So
// every affine map of the cage is one of the mesh.
CageWeights bind(const MeshView& input, const MeshView& cage, const BindOptions& options = {});

// The bound mesh when the cage is deformed. The deformed cage has the same vertices in the same order; its faces are
// only counted.
Deformation deform(const CageWeights& weights, const MeshView& deformed_cage, int threads = 0);

// bind() and deform() in one, the same to the last bit without the memory for the weights: all of them, in doubles.
Deformation deform(const MeshView& input, const MeshView& cage, const MeshView& deformed_cage, int threads = 0);

// Simplifies a mesh within a tolerance on each side of it: no face turns over, the surface does not intersect itself
// and keeps its topology. `control` may be null.
SimplifyResult simplify(const MeshView& input, const SimplifyOptions& options = {}, Control* control = nullptr);

// Makes a low-poly mesh, which keeps the topology of the input: simplification in a band that is wider where hollows
// are filled, with vertices that then move to where the two surfaces are closest in the mean. `wrap`, which may be
// null, is a closed surface round the input that passes over what is to be filled, such as a coarse alpha wrap; nothing
// is demanded of it. `control` may be null.
SimplifyResult make_low_poly(const MeshView& input, const MeshView* wrap, const LowPolyOptions& options = {},
                             Control* control = nullptr);

// Certifies a simplified surface from scratch. Both meshes must have indices in range and finite positions; anything
// else is answered by a certificate that is not valid.
SurfaceCertificate certify_surface(const MeshView& input, const MeshView& surface, int threads = 0);

// Makes nested cages of falling face budgets, finest first. Each strictly encloses the one before, and all enclose the
// input: both are certified, the former by Result::around_previous. Every thickness is around the input. So that there
// is room between the levels, the last one has all of tau and each one before it a hundredth of tau less. Where the
// thickness is to be found, the search for a level begins where that for the one before ended.
//
// One result for each level that was begun, at least one: all but the last have cages, and the last says why there are
// not more of them if there are fewer than budgets. A level that misses its budget, or was stopped, is kept if it has
// fewer faces than the one before. Options::face_budget is not used.
std::vector<Result> make_cages(const MeshView& input, const std::vector<std::size_t>& face_budgets,
                               const Options& options = {}, Control* control = nullptr);

// The same around triangles of any kind by way of a wrap.
std::vector<Result> make_cages_around(const MeshView& input, const MeshView& wrap,
                                      const std::vector<std::size_t>& face_budgets, const Options& options = {},
                                      Control* control = nullptr);

// Semantic version of the library, e.g. "0.1.0".
const char* version();

}  // namespace prcage
