// make_cage() from end to end over shapes, sizes, places and options. Every result is certified again, its topology and
// its distance from the input are judged by code of the tests' own.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "core/schedule.h"
#include "engine_stages.h"
#include "io/mesh_file.h"
#include "parallel/engine.h"

namespace prcage {
namespace {

using testing::same;
using testing::sampled_distance;
using testing::shape;
using testing::topology;

const testing::ShapeCase cases[] = {{"sphere", 500, 0}, {"bumpy", 700, 1},   {"spikes", 400, 1}, {"knot", 500, 1},
                                    {"gyroid", 700, 1}, {"bracket", 300, 1}, {"nested", 500, 1}, {"slabs", 200, 1}};

bool is_float(double x) {
  const volatile float nearest = static_cast<float>(x);  // not to be optimised away, see round_to_float()
  return static_cast<double>(nearest) == x;
}

void expect_counts_add_up(const Result& r, const Options& options) {
  const Statistics& s = r.statistics;
  Counts sum;
  for (const CycleStatistics& cycle : s.cycles) sum += cycle.counts;
  const Counts& c = s.counts;
  EXPECT_EQ(sum.collapses, c.collapses);
  EXPECT_EQ(sum.selected, c.selected);
  EXPECT_EQ(sum.flips, c.flips);
  EXPECT_EQ(c.selected, c.postponed + c.collapses + c.rejected_orientation + c.rejected_degenerate + c.rejected_tau +
                            c.rejected_cage + c.rejected_conflict);
  EXPECT_GE(c.evaluated, c.rejected_link + c.rejected_infeasible);
  EXPECT_LE(c.flips, c.flips_tried);
  if (!options.flips) {
    EXPECT_EQ(c.flips_tried, 0u);
  }
  if (s.capped_vertices == 0 && r.validation.degenerate_faces == 0) {
    EXPECT_EQ(s.cage_faces, s.input_faces - 2 * c.collapses);
  }
}

// Where the thickness is found, the last step is taken in parts, as few as it needs.
void expect_cycles_follow_the_schedule(const Result& r, const Options& options) {
  const std::vector<double> steps = thickness_steps(options, r.statistics.diagonal, r.validation.area);
  const auto& cycles = r.statistics.cycles;
  std::size_t whole = 0;
  while (whole < cycles.size() && whole < steps.size() && cycles[whole].tau == steps[whole]) ++whole;
  if (whole < cycles.size()) {
    EXPECT_TRUE(finds_thickness(options));
    EXPECT_LT(cycles.size() - whole, static_cast<std::size_t>(last_step_parts(options)));
    ASSERT_LT(whole, steps.size());
    EXPECT_LT(cycles.back().tau, steps[whole]);
  }
  double tau = 0;
  std::size_t faces = std::numeric_limits<std::size_t>::max();
  for (const CycleStatistics& cycle : cycles) {
    EXPECT_GT(cycle.tau, tau);
    EXPECT_EQ(cycle.beta, cycle.tau / r.statistics.tau);
    EXPECT_LE(cycle.faces, faces);
    tau = cycle.tau;
    faces = cycle.faces;
  }
  if (!cycles.empty()) {
    EXPECT_EQ(faces, r.statistics.cage_faces);
  }
}

// Everything that must hold of a result with a cage, whatever the input and the options.
void expect_sound(const Mesh& input, const Options& options, const Result& r) {
  ASSERT_TRUE(r.has_cage()) << to_string(r.status) << ": " << r.message;
  EXPECT_EQ(r.message.empty(), r.status == Status::ok);
  EXPECT_TRUE(r.validation.valid());
  EXPECT_TRUE(r.certificate.valid());
  EXPECT_TRUE(certify(input, r.cage).valid());
  EXPECT_EQ(topology(r.cage), topology(input));
  const Statistics& s = r.statistics;
  EXPECT_EQ(s.input_faces, input.triangles.size());
  EXPECT_EQ(s.input_vertices, input.positions.size());
  EXPECT_EQ(s.cage_faces, r.cage.triangles.size());
  EXPECT_EQ(s.cage_vertices, r.cage.positions.size());
  EXPECT_NEAR(s.diagonal, testing::diagonal_of(input), 1e-12 * s.diagonal);
  if (!finds_thickness(options)) {
    EXPECT_EQ(s.tau, options.tau_absolute > 0 ? options.tau_absolute : options.tau * s.diagonal);
  } else if (!s.cycles.empty()) {
    EXPECT_EQ(s.tau, s.cycles.back().tau);
  }
  EXPECT_GT(s.sigma_min, 0);
  EXPECT_LE(s.sigma_min, s.sigma_max);
  EXPECT_LE(s.sigma_max, options.sigma * s.diagonal);
  EXPECT_LE(s.capped_vertices, s.singular_vertices);
  EXPECT_GE(s.threads, 1);
  EXPECT_GT(s.peak_memory_bytes, 0u);
  EXPECT_GE(s.seconds.total, s.seconds.evaluate + s.seconds.collide);
  expect_counts_add_up(r, options);
  expect_cycles_follow_the_schedule(r, options);
  if (options.tau_mode == TauMode::strict) {
    EXPECT_LE(sampled_distance(r.cage, input, 6), s.tau * (1 + 1e-9));
  }
  if (options.precision == Precision::float32) {
    for (const Position& p : r.cage.positions)
      for (const double x : p) ASSERT_TRUE(is_float(x));
  }
}

Result expect_cage(const Mesh& input, const Options& options) {
  Control control;
  Result r = make_cage(input, options, &control);
  expect_sound(input, options, r);
  EXPECT_EQ(control.stage(), Control::Stage::done);
  EXPECT_EQ(control.progress(), 1);
  EXPECT_EQ(control.faces(), r.statistics.cage_faces);
  return r;
}

Options options_with(double tau, TauMode mode = TauMode::strict) {
  Options options;
  options.tau = tau;
  options.tau_mode = mode;
  return options;
}

// ------------------------------------------------------------------------------------------ shapes and options

// All stages with several threads on small inputs, two runs at a time: what the sanitizers get to see. The Slow ones
// are too many for them.
TEST(MakeCage, AllStagesWithSeveralThreads) {
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  const Mesh inputs[] = {shape("bumpy", 250), shape("slabs", 60), testing::thin_sector(12, 4.7, 0.02)};
  Options options = options_with(1.0 / 15);
  options.cycles = 2;
  options.threads = 3;
  for (const Mesh& input : inputs) {
    Result other;
    std::thread beside([&] { other = make_cage(input, options); });
    const Result r = expect_cage(input, options);
    beside.join();
    EXPECT_TRUE(same(r.cage, other.cage));
    options.tau_mode = TauMode::paper;
    options.precision = Precision::float32;
  }
}

class MakeCageSlow : public ::testing::TestWithParam<testing::ShapeCase> {
 protected:
  Mesh input_ = shape(GetParam().name, GetParam().faces, GetParam().seed);
};

INSTANTIATE_TEST_SUITE_P(Shapes, MakeCageSlow, ::testing::ValuesIn(cases),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(MakeCageSlow, IsSoundForEveryTauAndMode) {
  for (const double tau : {1.0 / 20, 1.0 / 200})
    for (const TauMode mode : {TauMode::strict, TauMode::paper}) {
      SCOPED_TRACE(std::to_string(tau) + (mode == TauMode::strict ? " strict" : " paper"));
      expect_cage(input_, options_with(tau, mode));
    }
}

TEST_P(MakeCageSlow, IsSoundWithoutFlipsAndForOtherSeedsAndSchedules) {
  Options options = options_with(1.0 / 40);
  options.flips = false;
  options.seed = 1;
  options.schedule = {1};
  expect_cage(input_, options);
  options.flips = true;
  options.seed = 0xfedcba9876543210u;
  options.schedule = {0.07, 0.3, 1};
  expect_cage(input_, options);
  options.schedule.clear();
  options.cycles = 17;
  options.tau_mode = TauMode::paper;
  expect_cage(input_, options);
}

TEST_P(MakeCageSlow, KeepsFloatsIfAskedTo) {
  for (const double tau : {1.0 / 20, 1.0 / 80}) {
    Options options = options_with(tau);
    options.precision = Precision::float32;
    expect_cage(input_, options);
  }
}

TEST_P(MakeCageSlow, TighterBandsKeepMoreFaces) {
  std::size_t faces = 0;
  for (const double tau : {1.0 / 10, 1.0 / 40, 1.0 / 400}) {
    Options options = options_with(tau);
    options.cycles = 4;
    const std::size_t now = make_cage(input_, options).cage.triangles.size();
    EXPECT_GE(now, faces) << tau;
    faces = now;
  }
}

// Without tightening, all cages of a run are nested: the state after each cycle of the staircase contains the states
// before it.
TEST_P(MakeCageSlow, EveryCycleEnclosesTheCyclesBefore) {
  testing::in_arena(2, [&] {
    const testing::Stage stage(input_);
    CageState state = stage.displaced(1e-5 * stage.diagonal).state;
    std::vector<Mesh> cages{input_, state.mesh.to_mesh()};
    Options options;
    options.schedule = {1};
    options.quality = Quality::fast;  // nothing moves back inward
    for (const double tau : {1.0 / 200, 1.0 / 60, 1.0 / 20}) {
      Statistics statistics;
      const EngineContext context{&options,
                                  stage.diagonal,
                                  {tau * stage.diagonal},
                                  stage.tree.frame(),
                                  &stage.device,
                                  stage.band.get(),
                                  nullptr,
                                  nullptr,
                                  nullptr,
                                  &statistics};
      EXPECT_EQ(run_engine(state, context), EngineOutcome::schedule_finished);
      cages.push_back(state.mesh.to_mesh());
      EXPECT_LE(sampled_distance(cages.back(), input_, 4), tau * stage.diagonal);
    }
    for (std::size_t outer = 1; outer < cages.size(); ++outer)
      for (std::size_t inner = 0; inner < outer; ++inner)
        EXPECT_TRUE(testing::weakly_encloses(cages[outer], cages[inner], 1e-7 * stage.diagonal))
            << "cage " << outer << " and " << inner;
  });
}

TEST_P(MakeCageSlow, DoesNotDependOnPlaceSizeAndDirection) {
  const Options options = options_with(1.0 / 30);
  const std::size_t faces = expect_cage(input_, options).cage.triangles.size();
  const double l = testing::diagonal_of(input_);
  const Mesh elsewhere[] = {testing::moved(input_, {1e6 * l, -2e5 * l, 7e5 * l}), testing::scaled(input_, 1e-6),
                            testing::scaled(input_, 1e6), testing::turned(input_, 5)};
  for (const Mesh& input : elsewhere) {
    const auto now = static_cast<double>(expect_cage(input, options).cage.triangles.size());
    EXPECT_NEAR(now, static_cast<double>(faces), 0.25 * static_cast<double>(faces) + 8);
  }
}

TEST(MakeCageSizesSlow, AnyUnitOfLength) {
  const Mesh input = shape("bumpy", 400);
  const Options options = options_with(1.0 / 20);
  const auto faces = static_cast<double>(expect_cage(input, options).cage.triangles.size());
  for (const double scale : {1e-30, 1e-10, 1e14}) {
    SCOPED_TRACE(scale);
    const auto now = static_cast<double>(expect_cage(testing::scaled(input, scale), options).cage.triangles.size());
    EXPECT_NEAR(now, faces, 0.25 * faces + 8);
  }
}

// ------------------------------------------------------------------------------------------ small and odd inputs

TEST(MakeCageSmall, SolidsOfAFewFaces) {
  const Mesh solids[] = {testing::tetrahedron(), testing::cube(), testing::sphere(0), testing::wedge(0.1, 1, 0, 1),
                         testing::sphere(1)};
  for (const Mesh& input : solids)
    for (const double tau : {1e-3, 1.0 / 40, 1.0 / 5, 1.0})
      for (const TauMode mode : {TauMode::strict, TauMode::paper}) {
        SCOPED_TRACE(std::to_string(input.triangles.size()) + " faces, tau " + std::to_string(tau));
        expect_cage(input, options_with(tau, mode));
      }
}

TEST(MakeCageSmall, ATetrahedronStaysOne) {
  EXPECT_EQ(expect_cage(testing::tetrahedron(), options_with(0.5)).cage.triangles.size(), 4u);
  // All faces but four of a sphere can go when the band is wide enough.
  EXPECT_LE(expect_cage(testing::sphere(2), options_with(1)).cage.triangles.size(), 12u);
}

TEST(MakeCageSmall, UnusedVerticesAndOtherLayoutsOfTheInputDoNotMatter) {
  const Mesh input = shape("bumpy", 300);
  const Result plain = expect_cage(input, options_with(1.0 / 20));
  Mesh more = input;
  more.positions.push_back({1e9, 0, 0});
  const Result with_unused = make_cage(more, options_with(1.0 / 20));
  EXPECT_TRUE(same(plain.cage, with_unused.cage));
}

TEST(MakeCageSmall, InsideOutIsTurnedIfAccepted) {
  const Mesh input = shape("bumpy", 300);
  Options options = options_with(1.0 / 20);
  EXPECT_EQ(make_cage(testing::inside_out(input), options).status, Status::invalid_input);
  options.accept_inside_out = true;
  const Result r = make_cage(testing::inside_out(input), options);
  ASSERT_EQ(r.status, Status::ok) << r.message;
  EXPECT_TRUE(certify(input, r.cage).valid());
}

TEST(MakeCageTroubleSlow, SingularVerticesNeedlesAndFolds) {
  std::vector<Mesh> inputs;
  for (const double turn : {4.0, 5.9}) inputs.push_back(testing::thin_sector(16, turn, 0.02));
  for (const double rise : {0.5, 20.0}) inputs.push_back(testing::saddle_cone(12, rise));
  for (const double gap : {1e-2, 1e-6}) inputs.push_back(testing::z_fold(1e-3, gap));
  for (std::size_t i = 0; i < inputs.size(); ++i)
    for (const double tau : {1.0 / 20, 1.0 / 100})
      for (const double sigma : {1e-5, 1e-2}) {
        SCOPED_TRACE(std::to_string(i) + ", tau " + std::to_string(tau) + ", sigma " + std::to_string(sigma));
        Options options = options_with(tau);
        options.sigma = sigma;
        expect_cage(inputs[i], options);
      }
}

TEST(MakeCageTroubleSlow, PlatesWithHardlyAnyRoomBetweenThem) {
  const Mesh input = testing::merge(testing::flat_plate(6, 1, 0, 0.2), testing::flat_plate(6, 1, 0.2 + 2e-7, 0.4));
  const Result r = expect_cage(input, options_with(1.0 / 20));
  EXPECT_GT(r.statistics.halved_vertices, 0u);
}

TEST(MakeCageTroubleSlow, DegenerateFacesOfTheInputAreCarried) {
  // Snapped to a coarse grid, so that faces lose their area; only what stays legal is used.
  int legal = 0;
  for (const double grid : {64.0, 100.0}) {
    const Mesh input = testing::mapped(testing::flat_plate(12, 1, 0, 0.3), [&](const Vec3& p) -> Vec3 {
      const Vec3 bent(p.x() * p.x(), p.y() * p.y() * p.x(), p.z());
      return (bent * grid).array().round() / grid;
    });
    const Validation v = validate(input);
    if (!v.valid() || v.degenerate_faces == 0) continue;
    ++legal;
    SCOPED_TRACE(grid);
    const Result r = make_cage(input, options_with(1.0 / 20));
    ASSERT_EQ(r.status, Status::ok) << r.message;
    EXPECT_TRUE(certify(input, r.cage).valid());
  }
  EXPECT_GT(legal, 0);
}

TEST(MakeCageTroubleSlow, WideAndNarrowBands) {
  const Mesh input = shape("bumpy", 300);
  for (const double tau : {1e-12, 1e-9, 1e-7, 1e-5}) {
    SCOPED_TRACE(tau);
    const Result r = make_cage(input, options_with(tau));
    if (r.status == Status::displacement_failed) {
      EXPECT_FALSE(r.message.empty());
      EXPECT_LT(tau, 1e-11);
      continue;
    }
    expect_sound(input, options_with(tau), r);
  }
  Options absolute;
  for (const double tau : {0.01, 1.0, 100.0, 1e12}) {
    absolute.tau_absolute = tau;
    expect_cage(input, absolute);
  }
}

// ------------------------------------------------------------------------------------------ face budget

TEST(MakeCageBudgetSlow, IsMetExactlyOrOneBelow) {
  for (const char* name : {"bumpy", "knot"}) {
    const Mesh input = shape(name, 600);
    const std::size_t faces = input.triangles.size();
    for (const bool flips : {false, true})
      for (const std::size_t budget : {faces, faces - 1, faces - 2, faces - 101, faces / 2, faces / 2 + 1, faces / 3}) {
        SCOPED_TRACE(std::string(name) + " " + std::to_string(budget));
        Options options = options_with(1.0 / 10);
        options.face_budget = budget;
        options.flips = flips;
        const Result r = expect_cage(input, options);
        EXPECT_EQ(r.status, Status::ok);
        EXPECT_EQ(r.cage.triangles.size(), budget - (faces - budget) % 2);
      }
  }
}

// The triangles of C_0 in vertices of the input, from which those of C_0 are hardly moved; sorted, each from its lowest
// vertex on.
std::vector<Triangle> in_vertices_of(const Mesh& input, const Mesh& cage) {
  std::vector<Triangle> triangles = cage.triangles;
  for (Triangle& t : triangles) {
    for (std::uint32_t& v : t) {
      const auto distance = [&](const Position& p) { return (vec(p) - vec(cage.positions[v])).squaredNorm(); };
      const auto nearest = std::min_element(input.positions.begin(), input.positions.end(),
                                            [&](const auto& p, const auto& q) { return distance(p) < distance(q); });
      v = static_cast<std::uint32_t>(nearest - input.positions.begin());
    }
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

TEST(MakeCageBudget, LargerThanTheInputGivesTheFirstCage) {
  const Mesh input = shape("bumpy", 300);
  Options options;
  options.face_budget = 100000;
  const Result r = expect_cage(input, options);
  EXPECT_EQ(r.status, Status::ok);
  EXPECT_EQ(in_vertices_of(input, r.cage), in_vertices_of(input, input));
  EXPECT_EQ(r.statistics.counts.collapses, 0u);
}

TEST(MakeCageBudget, OutOfReachIsSaidAndTheCageIsTheSmallestOne) {
  const Mesh input = shape("bumpy", 300);
  const Result smallest = expect_cage(input, options_with(1.0 / 40));
  for (const std::size_t budget : {std::size_t{1}, std::size_t{3}, smallest.cage.triangles.size() - 1}) {
    Options options = options_with(1.0 / 40);
    options.face_budget = budget;
    const Result r = expect_cage(input, options);
    EXPECT_EQ(r.status, Status::face_budget_not_reached);
    EXPECT_TRUE(same(r.cage, smallest.cage));
    EXPECT_NE(r.message.find(std::to_string(r.cage.triangles.size())), std::string::npos) << r.message;
  }
}

// ------------------------------------------------------------------------------------------ determinism

// The machine may have fewer cores than the runs have threads.
class MakeCageRepeatsSlow : public ::testing::TestWithParam<testing::ShapeCase> {
  tbb::global_control allow_{tbb::global_control::max_allowed_parallelism, 8};
};

INSTANTIATE_TEST_SUITE_P(Shapes, MakeCageRepeatsSlow, ::testing::ValuesIn(cases),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(MakeCageRepeatsSlow, BitByBitForAnyNumberOfThreads) {
  const Mesh input = shape(GetParam().name, 2 * GetParam().faces, GetParam().seed);
  for (const TauMode mode : {TauMode::strict, TauMode::paper}) {
    Options options = options_with(1.0 / 40, mode);
    options.cycles = 3;
    options.threads = 1;
    const Result expected = make_cage(input, options);
    ASSERT_EQ(expected.status, Status::ok) << expected.message;
    for (const int threads : {1, 2, 4}) {
      options.threads = threads;
      const Result r = make_cage(input, options);
      EXPECT_EQ(r.statistics.threads, threads);
      EXPECT_TRUE(same(r.cage, expected.cage)) << threads << " threads";
      EXPECT_EQ(r.statistics.counts.evaluated, expected.statistics.counts.evaluated);
      EXPECT_EQ(r.statistics.counts.rejected_conflict, expected.statistics.counts.rejected_conflict);
      EXPECT_EQ(r.statistics.halved_vertices, expected.statistics.halved_vertices);
    }
  }
}

TEST(MakeCageConcurrentSlow, RunsAtTheSameTimeDoNotDisturbEachOther) {
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  std::vector<Mesh> inputs{shape("bumpy", 1500), shape("knot", 900), shape("gyroid", 900)};
  std::vector<Mesh> expected;
  for (const Mesh& input : inputs) expected.push_back(make_cage(input).cage);
  std::vector<Mesh> found(2 * inputs.size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < found.size(); ++i)
    threads.emplace_back([&, i] {
      Options options;
      options.threads = 1 + static_cast<int>(i % 3);
      found[i] = make_cage(inputs[i % inputs.size()], options).cage;
    });
  for (std::thread& t : threads) t.join();
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_TRUE(same(found[i], expected[i % inputs.size()])) << i;
}

TEST(MakeCageSeedsSlow, BreakTiesAndNothingElse) {
  const Mesh input = testing::sphere(4);
  Options options = options_with(1.0 / 40);
  const Result a = expect_cage(input, options);
  options.seed = 1;
  const Result b = expect_cage(input, options);
  EXPECT_FALSE(same(a.cage, b.cage)) << "a sphere is full of ties";
  EXPECT_NEAR(static_cast<double>(a.cage.triangles.size()), static_cast<double>(b.cage.triangles.size()),
              0.2 * static_cast<double>(a.cage.triangles.size()) + 4);
}

// ------------------------------------------------------------------------------------------ thickness and tightness

Options options_for(std::size_t faces, Quality quality) {
  Options options;
  options.tau = 0;
  options.face_budget = faces;
  options.bound = Bound::both;
  options.quality = quality;
  return options;
}

TEST(MakeCageThicknessSlow, IsFoundForABudgetAndBoundsBothDirections) {
  for (const char* name : {"bumpy", "knot", "bracket", "gyroid", "slabs"})
    for (const std::size_t budget : {std::size_t{150}, std::size_t{500}}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(budget));
      const Mesh input = shape(name, 1500);
      const Result r = expect_cage(input, options_for(budget, Quality::standard));
      if (r.status == Status::face_budget_not_reached) continue;  // a matter of topology
      EXPECT_LE(r.cage.triangles.size(), budget);
      EXPECT_LE(sampled_distance(r.cage, input, 6), r.statistics.tau);
      const Mesh vertices{input.positions, input.triangles};
      EXPECT_LE(sampled_distance(vertices, r.cage, 1), r.statistics.tau) << "all vertices are samples";
      EXPECT_LT(r.statistics.tau, 0.3 * r.statistics.diagonal);
    }
}

TEST(MakeCageThicknessSlow, GrowsAsTheBudgetFalls) {
  const Mesh input = shape("bumpy", 4000);
  double tau = 0;
  for (const std::size_t budget : {1000u, 400u, 100u, 30u}) {
    const Result r = expect_cage(input, options_for(budget, Quality::fast));
    EXPECT_EQ(r.status, Status::ok);
    EXPECT_GT(r.statistics.tau, tau);
    tau = r.statistics.tau;
  }
}

TEST(MakeCageThickness, NeedsABudget) {
  Options options;
  options.tau = 0;
  EXPECT_EQ(make_cage(shape("bumpy", 100), options).status, Status::invalid_options);
}

// What tightening is for, at equal faces; and what it must not do: every result is certified.
TEST(MakeCageTighteningSlow, LeavesLessBetweenCageAndInput) {
  for (const char* name : {"bumpy", "knot", "spikes"})
    for (std::uint64_t seed = 0; seed < 2; ++seed) {
      const Mesh input = shape(name, 800);
      Options loose = options_for(200, Quality::fast), tight = options_for(200, Quality::standard);
      loose.seed = tight.seed = seed;
      const Result a = expect_cage(input, loose), b = expect_cage(input, tight);
      EXPECT_EQ(a.statistics.counts.tightened, 0u);
      EXPECT_GT(b.statistics.counts.tightened, 100u);
      if (a.cage.triangles.size() > 200 || b.cage.triangles.size() > 200) continue;
      const double volume = validate(input).volume;
      EXPECT_LT(validate(b.cage).volume - volume, 0.9 * (validate(a.cage).volume - volume)) << name;
    }
}

TEST(MakeCageTightening, IsTheSameForAnyNumberOfThreads) {
  const Mesh input = shape("bumpy", 200);
  const tbb::global_control more(tbb::global_control::max_allowed_parallelism, 4);
  Options options = options_for(100, Quality::standard);
  options.threads = 1;
  const Mesh one = expect_cage(input, options).cage;
  for (const int threads : {2, 4}) {
    options.threads = threads;
    const Mesh many = make_cage(input, options).cage;
    EXPECT_EQ(many.positions, one.positions);
    EXPECT_EQ(many.triangles, one.triangles);
  }
}

TEST(MakeCageTighteningSlow, TheBestIsCloser) {
  const Mesh input = shape("bumpy", 400);
  const auto distance = [&](Quality quality) {
    const Result r = expect_cage(input, options_for(120, quality));
    EXPECT_LE(r.cage.triangles.size(), 120u);
    return measure_cage(input, r.cage).hausdorff();
  };
  EXPECT_LT(distance(Quality::best), distance(Quality::fast));
}

TEST(MakeCageTighteningSlow, TheBestIsTheSameForAnyNumberOfThreads) {
  const Mesh input = shape("bumpy", 200);
  const tbb::global_control more(tbb::global_control::max_allowed_parallelism, 4);
  Options options = options_for(60, Quality::best);
  options.threads = 1;
  const Mesh one = expect_cage(input, options).cage;
  options.threads = 4;
  EXPECT_TRUE(testing::same(make_cage(input, options).cage, one));
}

// Small components close inside the cage of a large one: none may be swept out.
TEST(MakeCageTightening, LeavesNoComponentBehind) {
  Mesh input = testing::scaled(shape("bumpy", 2000), 1);
  const double l = testing::diagonal_of(input);
  const Mesh grain = testing::scaled(testing::cube(), 1e-3 * l);
  const Mesh large = input;
  for (std::size_t v = 0; v < large.positions.size(); v += 40) {
    Vec3 p = vec(large.positions[v]);
    Vec3 centre = Vec3::Zero();
    for (const Position& q : large.positions) centre += vec(q) / static_cast<double>(large.positions.size());
    p += 0.02 * l * (p - centre).normalized();
    input = testing::merge(input, testing::moved(grain, p));
  }
  for (const std::size_t budget : {std::size_t{600}, std::size_t{900}}) {
    const Result r = expect_cage(input, options_for(budget, Quality::standard));
    EXPECT_TRUE(r.certificate.encloses);
    EXPECT_TRUE(r.certificate.component_count_equal);
  }
}

// ------------------------------------------------------------------------------------------ cancel and progress

TEST(MakeCageCancel, BeforeTheStartGivesTheFirstCage) {
  const Mesh input = shape("bumpy", 500);
  Control control;
  control.cancel();
  const Result r = make_cage(input, {}, &control);
  EXPECT_EQ(r.status, Status::cancelled);
  expect_sound(input, {}, r);
  EXPECT_EQ(in_vertices_of(input, r.cage), in_vertices_of(input, input));
}

TEST(MakeCageCancelSlow, AtAnyTimeGivesAValidCage) {
  const Mesh input = shape("bumpy", 1500);
  Options options;
  options.quality = Quality::fast;  // nothing moves back inward, so that cages are nested
  const auto start = std::chrono::steady_clock::now();
  const Result complete = make_cage(input, options);
  const auto duration = std::chrono::steady_clock::now() - start;
  int cancelled = 0;
  for (int i = 0; i < 8; ++i) {
    Control control;
    std::thread canceller([&] {
      std::this_thread::sleep_for(duration * i / 8);
      control.cancel();
    });
    const Result r = make_cage(input, options, &control);
    canceller.join();
    ASSERT_TRUE(r.status == Status::cancelled || r.status == Status::ok) << to_string(r.status);
    expect_sound(input, options, r);
    cancelled += r.status == Status::cancelled ? 1 : 0;
    // Whatever it had reached is on the way to the complete result.
    EXPECT_TRUE(testing::weakly_encloses(complete.cage, r.cage, 1e-7 * r.statistics.diagonal));
  }
  EXPECT_GT(cancelled, 0);
}

// Ends runs at their reports, every `step`-th, which come before each round of collapses and each stage. While the last
// step is divided the cage has more faces again than it had, and must not be left with them.
void expect_budget_kept_once_reached(const Options& options, int step) {
  const Mesh input = shape("bumpy", 200);
  const Result complete = make_cage(input, options);
  double tau = std::numeric_limits<double>::infinity();  // that the budget was first reached with
  int before = 0, after = 0;
  for (int n = step;; n += step) {
    SCOPED_TRACE(n);
    Control control;
    control.cancel_at_report(n);
    const Result r = make_cage(input, options, &control);
    ASSERT_TRUE(r.certificate.valid()) << r.message;
    const bool reached = r.cage.triangles.size() <= options.face_budget;
    EXPECT_EQ(r.status, reached ? Status::ok : Status::cancelled);
    EXPECT_TRUE(reached || after == 0);
    if (!control.cancelled()) {
      EXPECT_TRUE(same(r.cage, complete.cage));
      break;
    }
    (reached ? after : before) += 1;
    if (!reached) continue;
    expect_sound(input, options, r);
    if (after == 1) tau = r.statistics.tau;
    EXPECT_LE(r.statistics.tau, tau);
    EXPECT_GE(r.statistics.tau, complete.statistics.tau);
    if (options.bound == Bound::both) {
      EXPECT_LE(sampled_distance(input, r.cage, 1), r.statistics.tau) << "all vertices are samples";
    }
  }
  EXPECT_LT(complete.statistics.tau, tau) << "the whole of the last step was not needed";
  EXPECT_GT(before * step, 5);
  EXPECT_GT(after * step, 5);
}

TEST(MakeCageCancelSlow, AtAnyReportKeepsTheBudgetOnceItWasReached) {
  Options options = options_for(80, Quality::fast);
  expect_budget_kept_once_reached(options, 8);  // samples of the input take most of the time
  options.bound = Bound::cage;
  expect_budget_kept_once_reached(options, 1);
}

TEST(MakeCageProgressSlow, RisesFromZeroToOneAndFacesFall) {
  const Mesh input = shape("bumpy", 2500);
  Control control;
  std::atomic<bool> done{false};
  std::vector<double> seen;
  std::thread watcher([&] {
    while (!done.load()) {
      seen.push_back(control.progress());
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  });
  const Result r = make_cage(input, {}, &control);
  done.store(true);
  watcher.join();
  ASSERT_EQ(r.status, Status::ok);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_GE(seen.front(), 0);
  EXPECT_LE(seen.back(), 1);
  EXPECT_GT(std::set<double>(seen.begin(), seen.end()).size(), 5u);
  EXPECT_EQ(control.progress(), 1);
  EXPECT_EQ(control.stage(), Control::Stage::done);
}

TEST(MakeCageProgress, ControlNeverFallsBack) {
  Control control;
  control.report(Control::Stage::collapse, 1, 10, 0.5);
  control.report(Control::Stage::flip, 1, 10, 0.25);
  EXPECT_EQ(control.progress(), 0.5);
  EXPECT_EQ(control.stage(), Control::Stage::flip);
  EXPECT_FALSE(control.cancelled());
  control.cancel();
  control.cancel();
  EXPECT_TRUE(control.cancelled());
}

// ------------------------------------------------------------------------------------------ refusals

void expect_refused(const MeshView& input, const Options& options, Status status, const std::string& word) {
  Control control;
  const Result r = make_cage(input, options, &control);
  EXPECT_EQ(r.status, status) << to_string(r.status);
  EXPECT_NE(r.message.find(word), std::string::npos) << r.message;
  EXPECT_FALSE(r.has_cage());
  EXPECT_TRUE(r.cage.triangles.empty());
  EXPECT_TRUE(r.cage.positions.empty());
  EXPECT_FALSE(r.certificate.valid());
  EXPECT_NE(control.stage(), Control::Stage::done);
}

TEST(MakeCageRefuses, OptionsOutOfRangeByName) {
  const Mesh input = testing::cube();
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const auto expect_bad = [&](const std::string& name, const auto& change) {
    Options options;
    change(options);
    expect_refused(input, options, Status::invalid_options, name);
  };
  for (const double x : {0.0, -0.1, 1.0000001, nan, inf}) expect_bad("tau", [x](Options& o) { o.tau = x; });
  for (const double x : {-1.0, nan, inf, -inf}) expect_bad("tau_absolute", [x](Options& o) { o.tau_absolute = x; });
  for (const double x : {0.0, -1e-5, 0.011, nan, inf}) expect_bad("sigma", [x](Options& o) { o.sigma = x; });
  for (const int n : {0, -1, 10001}) expect_bad("cycles", [n](Options& o) { o.cycles = n; });
  for (const int n : {-1, 4097}) expect_bad("threads", [n](Options& o) { o.threads = n; });
  const std::vector<std::vector<double>> schedules{{0.5},      {0.0, 1}, {-0.5, 1},  {0.5, 0.5, 1}, {0.7, 0.3, 1},
                                                   {0.5, 1.5}, {nan, 1}, {0.5, nan}, {1, 1}};
  for (const auto& list : schedules) expect_bad("schedule", [&](Options& o) { o.schedule = list; });
}

TEST(MakeCageRefuses, InputsThatAreNotLegal) {
  Mesh open = testing::cube();
  open.triangles.pop_back();
  Mesh bad_index = testing::cube();
  bad_index.triangles[3][1] = 99;
  Mesh not_finite = testing::cube();
  not_finite.positions[2][1] = std::numeric_limits<double>::quiet_NaN();
  const Mesh crossing = testing::merge(testing::cube(), testing::cube(1, {0.5, 0.25, 0.125}));
  const std::pair<const Mesh*, DefectKind> inputs[] = {{&open, DefectKind::boundary_edge},
                                                       {&bad_index, DefectKind::index_out_of_range},
                                                       {&not_finite, DefectKind::not_finite},
                                                       {&crossing, DefectKind::self_intersection}};
  for (const auto& [mesh, kind] : inputs) {
    expect_refused(*mesh, {}, Status::invalid_input, "defect");
    const Result r = make_cage(*mesh);
    ASSERT_FALSE(r.validation.defects.empty());
    EXPECT_EQ(r.validation.defects[0].kind, kind);
  }
  expect_refused(MeshView{}, {}, Status::invalid_input, "");
  expect_refused(Mesh{}, {}, Status::invalid_input, "");
}

// Two solids so close that doubles cannot hold a surface between them.
TEST(MakeCageRefuses, SolidsWithoutRoomBetweenThem) {
  const double top = 1;
  const Mesh input =
      testing::merge(testing::flat_plate(2, 1, 0, top), testing::flat_plate(2, 1, std::nextafter(top, 2.0), 2));
  ASSERT_TRUE(validate(input).valid());
  expect_refused(input, {}, Status::displacement_failed, "collision");
}

// ------------------------------------------------------------------------------------------ real meshes

class MakeCageRealMeshes : public ::testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Meshes, MakeCageRealMeshes,
                         ::testing::Values("cad/anchor", "cad/joint", "cad/tablet_stand", "multi/platonic_shelf",
                                           "multi/embossed_text", "thin/fan_grill", "genus/filter_grill",
                                           "organic/gargoyle"),
                         [](const auto& test) {
                           const std::string name = test.param;
                           return name.substr(name.find('/') + 1);
                         });

TEST_P(MakeCageRealMeshes, IsSoundInBothModes) {
  const std::filesystem::path path = std::string(PRCAGE_SHARED_DIR) + "/meshes/" + GetParam() + ".ply";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "there is no " << path;
  const MeshFile file = read_mesh(path.string());
  ASSERT_TRUE(file.ok) << file.error;
  for (const TauMode mode : {TauMode::strict, TauMode::paper}) {
    const Options options = options_with(1.0 / 40, mode);
    const Result r = make_cage(file.mesh, options);
    ASSERT_EQ(r.status, Status::ok) << r.message;
    EXPECT_TRUE(certify(file.mesh, r.cage).valid());
    EXPECT_EQ(topology(r.cage), topology(file.mesh));
    if (mode == TauMode::strict) {
      EXPECT_LE(sampled_distance(r.cage, file.mesh, 4), r.statistics.tau * (1 + 1e-9));
    }
  }
}

}  // namespace
}  // namespace prcage
