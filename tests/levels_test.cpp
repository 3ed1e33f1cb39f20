// Nested cages, deadlines, and what is said of a face budget that tau does not allow. Enclosure of each level by the
// next is judged by certify(), by a certificate of its own for every pair, neighbours or not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "core/schedule.h"
#include "io/mesh_file.h"
#include "test_meshes.h"

namespace prcage {
namespace {

using Budgets = std::vector<std::size_t>;
using ::testing::HasSubstr;
using testing::same;
using testing::sampled_distance;
using testing::shape;

// Everything that must hold of a sequence, whatever became of its last level.
void expect_nested(const Mesh& input, const Budgets& budgets, const std::vector<Result>& levels) {
  ASSERT_FALSE(levels.empty());
  ASSERT_LE(levels.size(), budgets.size());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    SCOPED_TRACE("level " + std::to_string(i));
    const Result& level = levels[i];
    EXPECT_EQ(level.message.empty(), level.status == Status::ok) << level.message;
    if (i + 1 < levels.size()) {
      ASSERT_TRUE(level.has_cage()) << level.message;
    }
    if (!level.has_cage()) continue;
    EXPECT_TRUE(level.certificate.valid());
    EXPECT_TRUE(certify(input, level.cage).valid());
    EXPECT_EQ(level.around_previous.has_value(), i > 0);
    if (i > 0) {
      EXPECT_TRUE(level.around_previous->valid());
      EXPECT_LT(level.cage.triangles.size(), levels[i - 1].cage.triangles.size() + 1);
    }
    for (std::size_t finer = 0; finer < i; ++finer)
      EXPECT_TRUE(certify(levels[finer].cage, level.cage).valid()) << "around level " << finer;
    if (level.status == Status::ok) {
      EXPECT_LE(level.cage.triangles.size(), budgets[i]);
      EXPECT_GE(level.cage.triangles.size() + 1, budgets[i]);
    }
    EXPECT_EQ(level.statistics.cage_faces, level.cage.triangles.size());
    EXPECT_GT(level.statistics.seconds.total, 0);
    EXPECT_LE(sampled_distance(level.cage, input, 4), level.statistics.tau * (1 + 1e-9));
  }
}

Options with_tau(double tau) {
  Options options;
  options.tau = tau;
  return options;
}

Options finding_thickness() {
  Options options = with_tau(0);
  options.bound = Bound::both;
  return options;
}

// ------------------------------------------------------------------------------------------------ levels

TEST(Levels, AreNestedWithinTauAndWithTheThicknessFound) {
  const Mesh input = shape("bumpy", 600);
  const Budgets budgets{300, 150, 60};
  for (const Options& options : {with_tau(1.0 / 8), finding_thickness()}) {
    const std::vector<Result> levels = make_cages(input, budgets, options);
    expect_nested(input, budgets, levels);
    ASSERT_EQ(levels.size(), 3u);
    EXPECT_EQ(levels.back().status, Status::ok) << levels.back().message;
    for (std::size_t i = 1; i < levels.size(); ++i)
      EXPECT_GT(levels[i].statistics.tau, levels[i - 1].statistics.tau) << "room between the levels";
    if (options.tau > 0) {
      EXPECT_EQ(levels.back().statistics.tau, options.tau * levels[0].statistics.diagonal) << "the last has all of it";
    }
  }
}

class LevelsSlow : public ::testing::TestWithParam<testing::ShapeCase> {};

INSTANTIATE_TEST_SUITE_P(Shapes, LevelsSlow,
                         ::testing::Values(testing::ShapeCase{"sphere", 900, 0}, testing::ShapeCase{"spikes", 700, 1},
                                           testing::ShapeCase{"knot", 900, 1}, testing::ShapeCase{"gyroid", 900, 1},
                                           testing::ShapeCase{"bracket", 700, 1}, testing::ShapeCase{"nested", 900, 1},
                                           testing::ShapeCase{"slabs", 400, 1}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(LevelsSlow, AreNestedForEveryKindOfThickness) {
  const Mesh input = shape(GetParam().name, GetParam().faces, GetParam().seed);
  const std::size_t n = input.triangles.size();
  const Budgets budgets{2 * n / 3, n / 3, n / 6};
  Options both = with_tau(1.0 / 30);
  both.bound = Bound::both;
  both.tau_mode = TauMode::strict;
  Options floats = finding_thickness();
  floats.precision = Precision::float32;
  floats.quality = Quality::fast;
  for (const Options& options : {both, finding_thickness(), floats}) {
    const std::vector<Result> levels = make_cages(input, budgets, options);
    expect_nested(input, budgets, levels);
    EXPECT_EQ(levels.size(), budgets.size()) << to_string(levels.back().status) << ": " << levels.back().message;
  }
}

// Small components close outside a large one, whose cages must not take them in nor leave them out.
TEST(LevelsComponentsSlow, StayApartAndInside) {
  Mesh input = shape("bumpy", 1500);
  const double l = testing::diagonal_of(input);
  const Mesh large = input;
  for (std::size_t v = 0; v < large.positions.size(); v += 90) {
    const Vec3 p = vec(large.positions[v]);
    input = testing::merge(input, testing::moved(testing::scaled(testing::cube(), 1e-3 * l), 1.05 * p));
  }
  ASSERT_TRUE(validate(input).valid());
  const Budgets budgets{1000, 500, 300};
  const std::vector<Result> levels = make_cages(input, budgets, finding_thickness());
  expect_nested(input, budgets, levels);
  EXPECT_EQ(levels.size(), 3u);
}

TEST(Levels, AreTheSameForAnyNumberOfThreads) {
  const tbb::global_control more(tbb::global_control::max_allowed_parallelism, 4);
  const Mesh input = shape("knot", 800);
  Options options = finding_thickness();
  options.threads = 1;
  const std::vector<Result> one = make_cages(input, {400, 200}, options);
  options.threads = 4;
  const std::vector<Result> many = make_cages(input, {400, 200}, options);
  ASSERT_EQ(one.size(), 2u);
  ASSERT_EQ(many.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_TRUE(same(one[i].cage, many[i].cage)) << "level " << i;
}

TEST(Levels, ASingleOneIsAnOrdinaryCage) {
  const Mesh input = shape("bumpy", 500);
  Options options = finding_thickness();
  const std::vector<Result> levels = make_cages(input, {200}, options);
  options.face_budget = 200;
  ASSERT_EQ(levels.size(), 1u);
  EXPECT_TRUE(same(levels[0].cage, make_cage(input, options).cage));
}

// Levels that parity already gives: the level before has as few faces as the next one asks for.
TEST(Levels, MayHaveAsManyFacesAsTheOneBefore) {
  const Mesh input = shape("bumpy", 500);
  const Budgets budgets{201, 200};
  const std::vector<Result> levels = make_cages(input, budgets, finding_thickness());
  ASSERT_EQ(levels.size(), 2u);
  EXPECT_EQ(levels[0].cage.triangles.size(), 200u);
  EXPECT_EQ(levels[1].cage.triangles.size(), 200u);
  expect_nested(input, budgets, levels);
}

TEST(Levels, OneThatTauDoesNotAllowDoesNotEndTheSequence) {
  const Mesh input = shape("bumpy", 600);
  const Budgets budgets{400, 8, 7, 6, 5, 4};
  const std::vector<Result> levels = make_cages(input, budgets, with_tau(1.0 / 25));
  expect_nested(input, budgets, levels);
  ASSERT_GE(levels.size(), 3u);
  EXPECT_EQ(levels[0].status, Status::ok);
  EXPECT_EQ(levels[1].status, Status::face_budget_not_reached);
  EXPECT_TRUE(levels[1].has_cage());
  EXPECT_EQ(levels.back().status, Status::face_budget_not_reached);
  for (std::size_t i = 2; i < levels.size(); ++i)
    if (levels[i].has_cage()) {
      EXPECT_LT(levels[i].cage.triangles.size(), levels[i - 1].cage.triangles.size());
    }
}

TEST(Levels, RefuseBudgetsThatDoNotFallAndOptionsOutOfRange) {
  const Mesh input = testing::cube();
  for (const Budgets& budgets :
       {Budgets{}, Budgets{0}, Budgets{10, 0}, Budgets{10, 10}, Budgets{5, 10}, Budgets{30, 20, 25}, Budgets(51, 1)}) {
    const std::vector<Result> levels = make_cages(input, budgets);
    ASSERT_EQ(levels.size(), 1u);
    EXPECT_EQ(levels[0].status, Status::invalid_options);
    EXPECT_THAT(levels[0].message, HasSubstr("level"));
    EXPECT_FALSE(levels[0].has_cage());
  }
  EXPECT_EQ(make_cages(input, {10, 8}, with_tau(2))[0].status, Status::invalid_options);
  EXPECT_EQ(make_cages(Mesh{}, {10, 8})[0].status, Status::invalid_input);
}

TEST(Levels, AroundAWrapEncloseTheTriangles) {
  Mesh open = testing::sphere(3);
  open.triangles.resize(open.triangles.size() - 20);
  const Mesh wrap = testing::sphere(4, 1.05);
  const Options options = finding_thickness();
  const std::vector<Result> levels = make_cages_around(open, wrap, {500, 200, 50}, options);
  ASSERT_EQ(levels.size(), 3u);
  for (const Result& level : levels) {
    EXPECT_EQ(level.status, Status::ok) << level.message;
    EXPECT_TRUE(certify_around(open, wrap, level.cage).valid());
  }
  EXPECT_TRUE(certify(levels[0].cage, levels[1].cage).valid());
  EXPECT_TRUE(certify(levels[1].cage, levels[2].cage).valid());
}

// ------------------------------------------------------------------------------------------------ stopped

TEST(LevelsStopped, BeforeTheStartGiveTheFirstCageOrNone) {
  const Mesh input = shape("bumpy", 400);
  Control cancelled;
  cancelled.cancel();
  const std::vector<Result> levels = make_cages(input, {200, 100}, finding_thickness(), &cancelled);
  ASSERT_EQ(levels.size(), 1u);
  EXPECT_EQ(levels[0].status, Status::cancelled);
  expect_nested(input, {200, 100}, levels);

  Control late;
  late.set_deadline(Control::Clock::now());
  const std::vector<Result> none = make_cages(input, {200, 100}, finding_thickness(), &late);
  ASSERT_EQ(none.size(), 1u);
  EXPECT_EQ(none[0].status, Status::deadline_reached);
  EXPECT_FALSE(none[0].has_cage());
}

// Stops as soon as the run says that it is at a stage, of a level, in a cycle.
class StopAt {
 public:
  StopAt(Control& control, Control::Stage stage, int level, bool by_deadline)
      : thread_([&control, stage, level, by_deadline, this] {
          while (!done_.load()) {
            if (control.stage() != stage || control.level() < level) {
              std::this_thread::sleep_for(std::chrono::microseconds(20));
              continue;
            }
            if (by_deadline)
              control.set_deadline(Control::Clock::now());
            else
              control.cancel();
            return;
          }
        }) {}
  ~StopAt() {
    done_.store(true);
    thread_.join();
  }
  StopAt(const StopAt&) = delete;
  StopAt& operator=(const StopAt&) = delete;

 private:
  std::atomic<bool> done_{false};
  std::thread thread_;
};

TEST(LevelsStoppedSlow, AtEveryStageGiveValidLevels) {
  using enum Control::Stage;
  const Mesh input = shape("bumpy", 600);
  const Budgets budgets{300, 150, 60};
  int stopped = 0;
  for (const Control::Stage stage : {validate, displace, collapse, flip, tighten, certify})
    for (const int level : {1, 2}) {
      const bool by_deadline = level == 2;
      SCOPED_TRACE(std::string(to_string(stage)) + " of level " + std::to_string(level) +
                   (by_deadline ? ", deadline" : ", cancelled"));
      Control control;
      std::vector<Result> levels;
      {
        const StopAt stop(control, stage, level, by_deadline);
        levels = make_cages(input, budgets, finding_thickness(), &control);
      }
      expect_nested(input, budgets, levels);
      const Result& last = levels.back();
      if (last.status == Status::ok) continue;  // came too late
      ++stopped;
      EXPECT_EQ(last.status, by_deadline ? Status::deadline_reached : Status::cancelled);
      if (!last.has_cage()) {
        EXPECT_TRUE(last.cage.positions.empty());
        EXPECT_FALSE(last.certificate.valid());
      }
    }
  EXPECT_GT(stopped, 3);
}

TEST(DeadlineSlow, IsAnsweredSoonAndALateOneChangesNothing) {
  const Mesh input = shape("knot", 2500);
  Options options = finding_thickness();
  options.face_budget = 200;
  const Mesh complete = make_cage(input, options).cage;
  Control patient;
  patient.set_deadline(Control::Clock::now() + std::chrono::hours(24));
  const Result r = make_cage(input, options, &patient);
  EXPECT_EQ(r.status, Status::ok);
  EXPECT_TRUE(same(r.cage, complete));
  int reached = 0;
  for (const double part : {0.2, 0.5, 0.8}) {
    Control control;
    const auto deadline = Control::Clock::now() + std::chrono::duration_cast<Control::Clock::duration>(
                                                      std::chrono::duration<double>(part * r.statistics.seconds.total));
    control.set_deadline(deadline);
    const Result stopped = make_cage(input, options, &control);
    const std::chrono::duration<double> late = Control::Clock::now() - deadline;
    if (stopped.status == Status::ok) continue;
    ASSERT_EQ(stopped.status, Status::deadline_reached);
    ASSERT_TRUE(stopped.has_cage());
    EXPECT_TRUE(certify(input, stopped.cage).valid());
    EXPECT_THAT(stopped.message, HasSubstr("deadline"));
    EXPECT_LT(late.count(), 0.5 * r.statistics.seconds.total + 1);
    ++reached;
  }
  EXPECT_GT(reached, 0);
}

TEST(Deadline, OfThePastGivesNoCage) {
  Control control;
  control.set_deadline(Control::Clock::now() - std::chrono::seconds(1));
  const Result r = make_cage(shape("bumpy", 300), {}, &control);
  EXPECT_EQ(r.status, Status::deadline_reached);
  EXPECT_FALSE(r.has_cage());
  EXPECT_TRUE(r.cage.triangles.empty());
  EXPECT_THAT(r.message, HasSubstr("before there was a cage"));
}

// ------------------------------------------------------------------------------------------------ needed thickness

// The promise is an upper estimate, so a run with that thickness has to make it.
TEST(NeededThicknessSlow, IsEnough) {
  for (const char* name : {"sphere", "bumpy", "spikes", "knot", "gyroid", "bracket"})
    for (const std::size_t budget : {std::size_t{120}, std::size_t{300}}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(budget));
      const Mesh input = shape(name, 1500);
      Options options = with_tau(1.0 / 600);
      options.face_budget = budget;
      const Result missed = make_cage(input, options);
      ASSERT_EQ(missed.status, Status::face_budget_not_reached);
      EXPECT_TRUE(certify(input, missed.cage).valid());
      EXPECT_LE(sampled_distance(missed.cage, input, 4), missed.statistics.tau) << "the cage is the one within tau";
      const double needed = missed.statistics.needed_tau / missed.statistics.diagonal;
      ASSERT_GT(needed, options.tau);
      EXPECT_LT(needed, 0.5);
      options.tau = needed;
      EXPECT_EQ(make_cage(input, options).status, Status::ok) << missed.message;
    }
}

TEST(NeededThickness, IsSaidInTheUnitThatTauWasGivenIn) {
  const Mesh input = testing::scaled(shape("bumpy", 300), 100);
  Options options = with_tau(1.0 / 100);
  options.face_budget = 40;
  const Result relative = make_cage(input, options);
  ASSERT_EQ(relative.status, Status::face_budget_not_reached);
  EXPECT_THAT(relative.message, HasSubstr("would allow 40 (an upper estimate)"));
  EXPECT_THAT(relative.message, HasSubstr("about 0."));
  options.tau_absolute = options.tau * relative.statistics.diagonal;
  const Result absolute = make_cage(input, options);
  EXPECT_TRUE(same(absolute.cage, relative.cage));
  EXPECT_THAT(absolute.message, HasSubstr("in the unit of the input would allow 40"));
}

TEST(NeededThickness, IsNotKnownWhereNoneHelpsOrNoneIsAskedFor) {
  const Mesh input = testing::torus();
  Options options = with_tau(1.0 / 40);
  options.face_budget = 6;  // a torus has at least 14
  const Result r = make_cage(input, options);
  EXPECT_EQ(r.status, Status::face_budget_not_reached);
  EXPECT_EQ(r.statistics.needed_tau, 0);
  EXPECT_THAT(r.message, HasSubstr("no larger one"));
  options.face_budget = input.triangles.size();
  EXPECT_EQ(make_cage(input, options).statistics.needed_tau, 0);
}

TEST(NeededThickness, IsNotLookedForWhenTheRunIsStopped) {
  const Mesh input = shape("bumpy", 3000);
  Options options = with_tau(1.0 / 500);
  options.face_budget = 20;
  Control control;
  std::thread stopper([&] {
    while (control.stage() != Control::Stage::estimate && control.stage() != Control::Stage::done)
      std::this_thread::sleep_for(std::chrono::microseconds(20));
    control.cancel();
  });
  const Result r = make_cage(input, options, &control);
  stopper.join();
  EXPECT_EQ(r.status, Status::face_budget_not_reached) << "the cage was complete";
  EXPECT_TRUE(certify(input, r.cage).valid());
}

// ------------------------------------------------------------------------------------------------ real meshes

// A level that no thickness allows ends the sequence with a reason.
TEST(LevelsRealMeshes, AreNested) {
  const std::filesystem::path meshes = std::string(PRCAGE_SHARED_DIR) + "/meshes";
  if (!std::filesystem::is_directory(meshes)) GTEST_SKIP() << "there is no " << meshes;
  Options options = finding_thickness();
  options.quality = Quality::fast;
  const Budgets budgets{5000, 1000, 200};
  int made = 0, complete = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(meshes)) {
    const std::filesystem::path& path = entry.path();
    if (path.extension() != ".ply" || path.parent_path().filename() == "invalid") continue;
    const MeshFile file = read_mesh(path.string());
    const std::size_t faces = file.mesh.triangles.size();
    if (!file.ok || faces <= 10000 || faces > 16000 || !validate(file.mesh).valid()) continue;
    SCOPED_TRACE(path.filename().string());
    const std::vector<Result> levels = make_cages(file.mesh, budgets, options);
    std::size_t cages = 0;
    for (; cages < levels.size() && levels[cages].has_cage(); ++cages) {
      EXPECT_TRUE(certify(file.mesh, levels[cages].cage).valid()) << "level " << cages;
      if (cages > 0) {
        EXPECT_TRUE(certify(levels[cages - 1].cage, levels[cages].cage).valid());
      }
    }
    EXPECT_GE(cages, 1u);
    if (cages < budgets.size()) {
      EXPECT_NE(levels.back().message, "");
    }
    ++made;
    complete += cages == budgets.size() ? 1 : 0;
  }
  EXPECT_GT(made, 0);
  EXPECT_GE(complete, 3 * made / 4);
}

}  // namespace
}  // namespace prcage
