// simplify() from end to end over shapes, seeds, tolerances and threads, judged by code of the tests' own; and the
// tests of the engine that only a band on both sides needs, provoked on purpose.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "engine_stages.h"
#include "parallel/conflicts.h"
#include "parallel/engine.h"
#include "parallel/flips.h"
#include "parallel/obstacle.h"
#include "parallel/side_test.h"
#include "parallel/turned_components.h"
#include "parallel/winding.h"
#include "solids.h"

namespace prcage {
namespace {

using testing::BruteDistance;
using testing::corners;
using testing::in_arena;
using testing::same;
using testing::sampled_distance;
using testing::shape;
using testing::Stage;
using testing::topology;

const testing::ShapeCase cases[] = {{"sphere", 500, 0}, {"bumpy", 500, 1},   {"spikes", 400, 1}, {"knot", 500, 1},
                                    {"gyroid", 500, 1}, {"bracket", 300, 1}, {"nested", 400, 1}, {"slabs", 200, 1}};

Vec3 unit_normal(const std::array<Vec3, 3>& t) { return (t[1] - t[0]).cross(t[2] - t[0]).normalized(); }

// Faces that are inverted beyond what coarseness explains: at none of the samples of such a face there is a face of the
// input within `tolerance` that looks the same way, by less than a right angle.
std::size_t inverted_faces(const Mesh& surface, const Mesh& input, double tolerance) {
  std::vector<std::array<Vec3, 3>> input_faces;
  for (const Triangle& t : input.triangles) input_faces.push_back(corners(input, t));
  std::size_t inverted = 0;
  for (const Triangle& t : surface.triangles) {
    const auto face = corners(surface, t);
    const Vec3 n = unit_normal(face);
    bool looks_out = false;
    testing::for_each_sample(face, 3, [&](const Vec3& x) {
      for (std::size_t f = 0; f < input_faces.size() && !looks_out; ++f)
        looks_out =
            unit_normal(input_faces[f]).dot(n) > 0 && testing::triangle_distance(x, input_faces[f]) <= tolerance;
    });
    inverted += looks_out ? 0 : 1;
  }
  return inverted;
}

struct Excess {
  double outside = 0;
  double inside = 0;
};

// The largest distances of samples of the surface from the input, by the side on which they are.
Excess sampled_excess(const Mesh& surface, const Mesh& input, int n) {
  const BruteDistance distance(input);
  Excess excess;
  for (const Triangle& t : surface.triangles)
    testing::for_each_sample(corners(surface, t), n, [&](const Vec3& x) {
      const double d = distance(x);
      double& side = testing::winding_number(input, x) == 0 ? excess.outside : excess.inside;
      side = std::max(side, d);
    });
  return excess;
}

double distance_of_vertices(const Mesh& from, const Mesh& to) {
  const BruteDistance distance(to);
  double worst = 0;
  for (const Position& p : from.positions) worst = std::max(worst, distance(vec(p)));
  return worst;
}

CageMeasures measured(const Mesh& surface, const Mesh& input, std::size_t views = 0) {
  MeasureOptions options;
  options.samples = 1;
  options.views = views;
  return measure_cage(input, surface, options);
}

double silhouette(const Mesh& input, const Mesh& surface) { return measured(surface, input, 24).silhouette->mean; }

// Everything that must hold of a result with a mesh.
void expect_sound(const Mesh& input, const SimplifyOptions& options, const SimplifyResult& r) {
  ASSERT_TRUE(r.has_mesh()) << to_string(r.status) << ": " << r.message;
  EXPECT_EQ(r.message.empty(), r.status == Status::ok);
  EXPECT_TRUE(r.certificate.valid());
  EXPECT_TRUE(certify_surface(input, r.mesh).valid());
  const Validation validation = validate(r.mesh);
  EXPECT_TRUE(validation.valid());
  EXPECT_EQ(validation.cavities, r.validation.cavities);
  EXPECT_EQ(topology(r.mesh), topology(input));
  EXPECT_EQ(r.statistics.cage_faces, r.mesh.triangles.size());
  EXPECT_LE(r.mesh.triangles.size(), input.triangles.size());
  const double unit = options.absolute ? 1 : r.statistics.diagonal;
  const double tau = std::max(options.tau_inner, options.tau_outer) * unit;
  EXPECT_DOUBLE_EQ(r.statistics.tau, tau);
  if (options.tau_mode == TauMode::strict) {
    EXPECT_LE(sampled_distance(r.mesh, input, 4), tau * (1 + 1e-9));
  }
  if (options.bound == Bound::both) {
    EXPECT_LE(distance_of_vertices(input, r.mesh), tau * (1 + 1e-6));
  }
  EXPECT_EQ(inverted_faces(r.mesh, input, tau), 0u);
  EXPECT_EQ(measured(r.mesh, input).inverted_faces, 0u);
}

class Simplify : public ::testing::TestWithParam<testing::ShapeCase> {};

TEST_P(Simplify, KeepsWhatItPromises) {
  const Mesh input = shape(GetParam().name, GetParam().faces, GetParam().seed);
  for (const double tau : {0.02, 0.05}) {
    SCOPED_TRACE(tau);
    SimplifyOptions options;
    options.tau_inner = options.tau_outer = tau;
    const SimplifyResult r = simplify(input, options);
    expect_sound(input, options, r);
    EXPECT_EQ(r.status, Status::ok);
    ASSERT_TRUE(r.deviation);
    EXPECT_LE(std::max(r.deviation->inside, r.deviation->outside), tau * (1 + 1e-9));
  }
}

TEST_P(Simplify, KeepsToUnequalSides) {
  const Mesh input = shape(GetParam().name, GetParam().faces, GetParam().seed);
  for (const auto& [inner, outer] : {std::pair(0.02, 0.05), std::pair(0.05, 0.02)}) {
    SCOPED_TRACE(inner);
    SimplifyOptions options;
    options.tau_inner = inner;
    options.tau_outer = outer;
    const SimplifyResult r = simplify(input, options);
    expect_sound(input, options, r);
    const Excess excess = sampled_excess(r.mesh, input, 3);
    const double l = r.statistics.diagonal;
    EXPECT_LE(excess.inside, inner * l * (1 + 1e-9));
    EXPECT_LE(excess.outside, outer * l * (1 + 1e-9));
    EXPECT_LE(r.deviation->inside, inner * (1 + 1e-9));
    EXPECT_LE(r.deviation->outside, outer * (1 + 1e-9));
  }
}

TEST_P(Simplify, IsTheSameForAnyNumberOfThreads) {
  const Mesh input = shape(GetParam().name, GetParam().faces, GetParam().seed);
  SimplifyOptions options;
  options.tau_inner = 0.02;
  options.tau_outer = 0.05;
  options.threads = 1;
  const SimplifyResult one = simplify(input, options);
  for (const int threads : {2, 4}) {
    options.threads = threads;
    const SimplifyResult r = simplify(input, options);
    EXPECT_TRUE(same(r.mesh, one.mesh));
    EXPECT_EQ(r.deviation->outside, one.deviation->outside);
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, Simplify, ::testing::ValuesIn(cases),
                         [](const auto& c) { return testing::label(c.param); });

TEST(SimplifyResults, FacesTurnAwayFromTheNearestFaceByLessThanARightAngleOnSmoothShapes) {
  for (const char* name : {"sphere", "bumpy"}) {
    const Mesh input = shape(name, 2000);
    SimplifyOptions options;
    options.face_budget = 300;
    const SimplifyResult r = simplify(input, options);
    const BruteDistance nearest(input);
    for (const Triangle& t : r.mesh.triangles) {
      const auto face = corners(r.mesh, t);
      const auto [f, d] = nearest.nearest((face[0] + face[1] + face[2]) / 3);
      EXPECT_GT(unit_normal(face).dot(unit_normal(corners(input, input.triangles[f]))), 0) << name;
    }
  }
}

TEST(SimplifyResults, UseFewerFacesThanACageAndReachBudgets) {
  const Mesh input = shape("bumpy", 1000);
  SimplifyOptions options;
  options.tau_inner = options.tau_outer = 0.02;
  const SimplifyResult free = simplify(input, options);
  Options cage_options;
  cage_options.tau = 0.02;
  EXPECT_LT(free.mesh.triangles.size(), make_cage(input, cage_options).cage.triangles.size());
  options.face_budget = free.mesh.triangles.size() + 51;
  const SimplifyResult some = simplify(input, options);
  EXPECT_EQ(some.status, Status::ok);
  EXPECT_LE(some.mesh.triangles.size(), options.face_budget);
  EXPECT_GE(some.mesh.triangles.size() + 1, options.face_budget);
  options.face_budget = 4;
  const SimplifyResult few = simplify(input, options);
  EXPECT_EQ(few.status, Status::face_budget_not_reached);
  expect_sound(input, options, few);
}

TEST(SimplifyResults, FlipsAreLeftOutWhereTheInputIsNotBounded) {
  const Mesh input = shape("bumpy", 800);
  SimplifyOptions options;
  EXPECT_GT(simplify(input, options).statistics.counts.flips, 0u);
  options.bound = Bound::cage;
  const SimplifyResult r = simplify(input, options);
  expect_sound(input, options, r);
  EXPECT_EQ(r.statistics.counts.flips_tried, 0u);
}

TEST(SimplifyResults, FlatFacesCostNothing) {
  const Mesh input = testing::flat_plate(12, 1, 0, 0.2);
  const SimplifyResult r = simplify(input, {});
  expect_sound(input, {}, r);
  EXPECT_EQ(r.mesh.triangles.size(), 12u);
  EXPECT_LE(r.deviation->from_input, 1e-4);
}

TEST(SimplifyResults, AbsoluteTolerancesAreInTheUnitOfTheInput) {
  const Mesh input = testing::scaled(shape("bumpy", 800), 37);
  const double l = testing::diagonal_of(input);
  SimplifyOptions relative, absolute;
  relative.tau_inner = relative.tau_outer = 0.5 / l;
  absolute.tau_inner = absolute.tau_outer = 0.5;
  absolute.absolute = true;
  const SimplifyResult r = simplify(input, absolute);
  expect_sound(input, absolute, r);
  EXPECT_NEAR(static_cast<double>(r.mesh.triangles.size()),
              static_cast<double>(simplify(input, relative).mesh.triangles.size()), 4);
}

TEST(SimplifyResults, FloatsArePlacedOnFloats) {
  const Mesh input = shape("bumpy", 600);
  SimplifyOptions options;
  options.precision = Precision::float32;
  const SimplifyResult r = simplify(input, options);
  ASSERT_TRUE(r.has_mesh()) << r.message;
  for (const Position& p : r.mesh.positions) EXPECT_EQ(p, round_to_floats(vec(p)));
}

TEST(SimplifyResults, RefuseWhatCannotBe) {
  const Mesh input = shape("sphere", 200);
  SimplifyOptions options;
  options.tau_inner = 0;
  EXPECT_EQ(simplify(input, options).status, Status::invalid_options);
  options.tau_inner = 2;
  EXPECT_EQ(simplify(input, options).status, Status::invalid_options);
  options.absolute = true;
  EXPECT_TRUE(simplify(input, options).has_mesh());
  options.tau_outer = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(simplify(input, options).status, Status::invalid_options);
  Mesh open = input;
  open.triangles.pop_back();
  const SimplifyResult refused = simplify(open, {});
  EXPECT_EQ(refused.status, Status::invalid_input);
  EXPECT_TRUE(refused.mesh.triangles.empty());
  EXPECT_FALSE(refused.validation.valid());
}

TEST(SimplifyResults, CancelledRunsHaveAValidMesh) {
  const Mesh input = shape("bumpy", 2000);
  Control control;
  control.cancel();
  const SimplifyResult r = simplify(input, {}, &control);
  EXPECT_EQ(r.status, Status::cancelled);
  expect_sound(input, {}, r);
}

TEST(SimplifyResults, CertificateSeesWhatIsWrong) {
  const Mesh input = testing::sphere(3);
  const Mesh good = testing::sphere(2);
  EXPECT_TRUE(certify_surface(input, good).valid());
  EXPECT_FALSE(certify_surface(input, testing::inside_out(good)).bounds_solid);
  EXPECT_FALSE(certify_surface(input, testing::torus()).euler_characteristic_equal);
  EXPECT_FALSE(certify_surface(input, testing::merge(good, testing::sphere(1, 1, {5, 0, 0}))).component_count_equal);
  const Mesh hollow = testing::merge(good, testing::inside_out(testing::sphere(1, 0.3)));
  const Mesh apart = testing::merge(good, testing::sphere(1, 0.3, {5, 0, 0}));
  EXPECT_FALSE(certify_surface(hollow, apart).cavity_count_equal);
  Mesh crossing = testing::merge(good, testing::sphere(1, 0.3, {1, 0, 0}));
  EXPECT_FALSE(certify_surface(apart, crossing).self_intersection_free);
  Mesh open = good;
  open.triangles.pop_back();
  EXPECT_FALSE(certify_surface(input, open).closed);
  EXPECT_FALSE(certify_surface(input, Mesh{}).valid());
}

// ------------------------------------------------------------------------------------------------- low poly

// A box that a dent goes into from above, and a closed surface round it that passes over the dent.
Mesh dented_plate() {
  const auto top = [](double x, double y) {
    const double r = std::hypot(x - 0.5, y - 0.5);
    return r < 0.2 ? 0.4 - 0.1 * (1 + std::cos(r * std::numbers::pi / 0.2)) / 2 : 0.4;
  };
  return testing::plate(
      16, 1, [](double, double) { return 0.0; }, top);
}

TEST(LowPoly, KeepsTopologyAndReachesTheNumberOfFaces) {
  for (const testing::ShapeCase& c :
       {cases[4], cases[5], cases[6]}) {  // of high genus, with sharp edges, with a cavity
    SCOPED_TRACE(testing::label(c));
    const Mesh input = shape(c.name, c.faces, c.seed);
    LowPolyOptions options;
    options.faces = 150;
    options.quality = Quality::fast;
    options.samples = 0;
    const SimplifyResult r = make_low_poly(input, nullptr, options);
    ASSERT_TRUE(r.has_mesh()) << r.message;
    EXPECT_EQ(topology(r.mesh), topology(input));
    EXPECT_TRUE(validate(r.mesh).valid());
    EXPECT_EQ(r.tau_inner, r.tau_outer);
    EXPECT_LE(sampled_distance(r.mesh, input, 3), r.tau_outer * (1 + 1e-9));
    EXPECT_EQ(measured(r.mesh, input).inverted_faces, 0u);
    if (r.status == Status::ok) {
      EXPECT_LE(r.mesh.triangles.size(), 150u);
      EXPECT_GE(r.mesh.triangles.size(), 149u);
    }
  }
}

Mesh cover_of_plate() {
  const Mesh cover = testing::plate(
      2, 1.02, [](double, double) { return -0.01; }, [](double, double) { return 0.41; });
  return testing::moved(cover, {-0.01, -0.01, 0});
}

TEST(LowPoly, FillsHollowsUpToTheWrapAndAnchorsTheRest) {
  const Mesh input = dented_plate();
  const Mesh wrap = cover_of_plate();
  const MeshView view(wrap);
  LowPolyOptions options;
  options.faces = 24;
  options.inner_share = 0.1;
  const SimplifyResult r = make_low_poly(input, &view, options);
  ASSERT_TRUE(r.has_mesh()) << r.message;
  EXPECT_NEAR(r.tau_inner, options.inner_share * r.tau_outer, 1e-12);
  EXPECT_LE(sampled_distance(r.mesh, input, 4), r.tau_outer * (1 + 1e-9));
  EXPECT_EQ(topology(r.mesh), topology(input));
  const BruteDistance distance(r.mesh);
  double dent = 0;
  for (const Position& p : input.positions) {
    const double d = distance(vec(p));
    if (p[2] > 0 && p[2] < 0.39)
      dent = std::max(dent, d);
    else
      EXPECT_LE(d, std::max(0.0201, r.tau_inner));  // up to 0.02 from the wrap, or anchored
  }
  EXPECT_GT(dent, 2 * r.tau_inner);
}

TEST(LowPoly, OutlinesAreNearerToTheInputThanThoseOfASimplification) {
  const Mesh input = shape("knot", 1000, 1);
  LowPolyOptions options;
  options.faces = 100;
  options.quality = Quality::fast;
  const SimplifyResult low = make_low_poly(input, nullptr, options);
  SimplifyOptions plain;
  plain.face_budget = low.mesh.triangles.size();
  plain.tau_inner = plain.tau_outer = 0.05;
  const SimplifyResult simplified = simplify(input, plain);
  ASSERT_EQ(low.status, Status::ok);
  ASSERT_EQ(simplified.status, Status::ok);
  EXPECT_LT(silhouette(input, low.mesh), 0.9 * silhouette(input, simplified.mesh));
}

TEST(LowPoly, IsTheSameForAnyNumberOfThreads) {
  const Mesh input = dented_plate();
  const Mesh wrap = cover_of_plate();
  const MeshView view(wrap);
  LowPolyOptions options;
  options.faces = 40;
  options.quality = Quality::fast;
  options.threads = 1;
  const Mesh one = make_low_poly(input, &view, options).mesh;
  options.threads = 4;
  EXPECT_TRUE(same(make_low_poly(input, &view, options).mesh, one));
}

TEST(LowPoly, RefusesWhatCannotBe) {
  const Mesh input = shape("sphere", 200);
  LowPolyOptions options;
  options.faces = 0;
  EXPECT_EQ(make_low_poly(input, nullptr, options).status, Status::invalid_options);
  options.faces = 20;
  options.inner_share = 0;
  EXPECT_EQ(make_low_poly(input, nullptr, options).status, Status::invalid_options);
}

TEST(Silhouettes, DifferByTheAreaBetweenTheOutlines) {
  const Mesh cube = testing::cube(1);
  EXPECT_EQ(silhouette(cube, cube), 0);
  EXPECT_NEAR(silhouette(cube, testing::cube(0.9)), 1 - 0.81, 0.01);
  EXPECT_NEAR(silhouette(cube, testing::cube(1.1)), 1.21 - 1, 0.01);
  EXPECT_NEAR(silhouette(cube, testing::cube(1, {5, 5, 5})), 2, 0.35);  // some views are along the diagonal
  // What an outline does not show does not count.
  EXPECT_LT(silhouette(testing::merge(cube, testing::inside_out(testing::cube(0.5))), cube), 1e-12);
}

TEST(Silhouettes, AreLeftOutIfNoViewsAreAskedFor) {
  EXPECT_FALSE(measured(testing::cube(0.9), testing::cube(1)).silhouette);
}

// ------------------------------------------------------------------------------------------------- the tests

// A tetrahedron of the given size just above the middle of a plate's top, and the patch that lifts the vertex there.
struct Lifted {
  explicit Lifted(double height, double size)
      : mesh(testing::merge(testing::flat_plate(2, 1, 0, 0.2), tetrahedron_above(height, size))) {}

  static Mesh tetrahedron_above(double height, double size) {
    Mesh t = testing::scaled(testing::tetrahedron(), size);
    for (Position& p : t.positions) p = {p[0] + 0.5, p[1] + 0.5, p[2] + 0.2 + height};
    return t;
  }

  Mesh mesh;
};

Verdict verdict_of_lift(const Lifted& lifted, double by) {
  Verdict verdict{};
  in_arena(1, [&] {
    const Stage stage(lifted.mesh);
    CageState state = stage.state_of(lifted.mesh);
    state.components = 2;
    state.vertex_component.assign(lifted.mesh.positions.size(), 0);
    for (std::size_t v = lifted.mesh.positions.size() - 4; v < lifted.mesh.positions.size(); ++v)
      state.vertex_component[v] = 1;
    std::uint32_t middle = none;
    for (std::uint32_t v = 0; v + 4 < lifted.mesh.positions.size(); ++v) {
      const Position& p = lifted.mesh.positions[v];
      if (p[0] == 0.5 && p[1] == 0.5 && p[2] == 0.2) middle = v;
    }
    const std::uint32_t h = state.mesh.vertex_halfedge[middle];
    PatchBatch batch = build_moves(state, stage.tree.frame(), {{0, h}}, {{0.5, 0.5, 0.2 + by}});
    reject_sweeps_of_components(state, stage.device, batch);
    verdict = batch.verdict[0];
  });
  return verdict;
}

TEST(SimplifyStages, PatchesThatSweepOverAComponentAreRejected) {
  EXPECT_EQ(verdict_of_lift(Lifted(0.02, 0.001), 0.1), Verdict::hits_input);
  EXPECT_EQ(verdict_of_lift(Lifted(0.12, 0.001), 0.1), Verdict::accepted);
  EXPECT_EQ(verdict_of_lift(Lifted(0.02, 0.001), 0.01), Verdict::accepted);
}

// Two pyramids of n faces on the same base, with their apexes at the given heights; apexes are the last two vertices.
Mesh bipyramid(std::uint32_t n, double above, double below) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    mesh.positions.push_back({std::cos(angle), std::sin(angle), 0});
    mesh.triangles.push_back({i, (i + 1) % n, n});
    mesh.triangles.push_back({(i + 1) % n, i, n + 1});
  }
  mesh.positions.push_back({0.01, 0, above});
  mesh.positions.push_back({0, 0.01, below});
  return mesh;
}

// The verdicts on moves of the apexes to the given heights, the upper one first. They touch nothing.
std::vector<Verdict> verdicts_of_apexes(const Mesh& mesh, double upper, double lower) {
  std::vector<Verdict> verdicts;
  in_arena(1, [&] {
    const Stage stage(mesh);
    const CageState state = stage.state_of(mesh);
    std::vector<Candidate> selected;
    std::vector<Position> points;
    for (const auto& [v, z] :
         {std::pair{mesh.positions.size() - 2, upper}, std::pair{mesh.positions.size() - 1, lower}}) {
      selected.push_back({selected.size(), state.mesh.vertex_halfedge[v]});
      points.push_back({mesh.positions[v][0], mesh.positions[v][1], z});
    }
    PatchBatch batch = build_moves(state, stage.tree.frame(), selected, points);
    reject_hits_on_cage(state, stage.device, batch);
    reject_conflicts(state, stage.device, batch);
    EXPECT_EQ(batch.count(Verdict::accepted), 2u);
    reject_turned_components(state, batch);
    verdicts = batch.verdict;
  });
  return verdicts;
}

TEST(SimplifyStages, PatchesThatTurnTheirComponentInsideOutAreRejected) {
  using enum Verdict;
  for (const std::uint32_t n : {3u, 4u, 9u}) {
    SCOPED_TRACE(n);
    const Mesh flat = bipyramid(n, 0.1, -0.1);
    EXPECT_EQ(verdicts_of_apexes(flat, 0.2, -0.2), (std::vector{accepted, conflict})) << "one at a time";
    EXPECT_EQ(verdicts_of_apexes(flat, 0.02, 0.05), (std::vector{accepted, conflict})) << "together they would";
    EXPECT_EQ(verdicts_of_apexes(flat, -0.2, -0.1), (std::vector{turns_over, conflict}));
    const Mesh cavity = testing::inside_out(flat);
    EXPECT_EQ(verdicts_of_apexes(cavity, 0.2, -0.2), (std::vector{accepted, conflict}));
    EXPECT_EQ(verdicts_of_apexes(cavity, -0.2, -0.1), (std::vector{turns_over, conflict}));
  }
}

TEST(SimplifyStages, PatchesThatTurnFacesOverAreRejected) {
  const Mesh plate = testing::flat_plate(4, 1, 0, 0.2);
  in_arena(1, [&] {
    const Stage stage(plate);
    CageState state = stage.state_of(plate);
    std::uint32_t middle = none;
    for (std::uint32_t v = 0; v < plate.positions.size(); ++v)
      if (plate.positions[v] == Position{0.5, 0.5, 0.2}) middle = v;
    const auto verdict = [&](const Position& point) {
      PatchBatch batch = build_moves(state, stage.tree.frame(), {{0, state.mesh.vertex_halfedge[middle]}}, {point});
      test_patches_locally(state, batch, Sides::both);
      return batch.verdict[0];
    };
    EXPECT_EQ(verdict({0.55, 0.5, 0.2}), Verdict::accepted);
    EXPECT_EQ(verdict({0.5, 0.5, 0.15}), Verdict::accepted);    // inward
    EXPECT_EQ(verdict({0.9, 0.5, 0.2}), Verdict::turns_over);   // beyond its star
    EXPECT_EQ(verdict({0.75, 0.5, 0.2}), Verdict::turns_over);  // onto its rim
  });
}

TEST(SimplifyStages, WithoutConstraintsNothingButTheTopologyIsKept) {
  const Mesh input = shape("gyroid", 2000);
  in_arena(2, [&] {
    Stage stage(input);
    const auto faces_at = [&](bool constrained) {
      CageState state = stage.state_of(input);
      Options options;
      options.face_budget = 600;
      options.flips = false;
      Statistics statistics;
      EngineContext context{};
      context.options = &options;
      context.diagonal = stage.diagonal;
      context.thickness = {1e-6 * stage.diagonal};
      context.frame = stage.tree.frame();
      context.device = &stage.device;
      context.band = stage.band.get();
      context.statistics = &statistics;
      context.band_shape.sides = Sides::both;
      context.constrained = constrained;
      run_engine(state, context);
      EXPECT_EQ(topology(state.mesh.to_mesh()), topology(input));
      return state.live_faces;
    };
    EXPECT_GT(faces_at(true), 1000u);
    EXPECT_EQ(faces_at(false), 600u);
  });
}

TEST(SimplifyStages, BandsOnBothSidesKnowWhereTheFaceIs) {
  const Band band{2, 1, Sides::both};
  EXPECT_EQ(band(0).lower, -1);
  EXPECT_EQ(band(0).upper, 2);
  EXPECT_EQ(band(-1).lower, 0);
  EXPECT_EQ(band(-1).upper, 3);
  EXPECT_EQ(band(2).lower, -3);
  EXPECT_EQ(band(2).upper, 0);
  EXPECT_EQ(band(5).upper, 0);   // out of the band: never farther out,
  EXPECT_EQ(band(-5).lower, 0);  // nor farther in
  const Band cage{2, 0, Sides::outer};
  EXPECT_EQ(cage(1).lower, 0);
  EXPECT_EQ(cage(1).upper, 1);
}

}  // namespace
}  // namespace prcage
