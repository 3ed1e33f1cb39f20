// Binding and deforming through the public interface: what a deformation by mean value coordinates must preserve,
// truncation and its errors, the file of the weights and all that can be wrong with it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "core/prcage.h"
#include "io/weights_file.h"
#include "random.h"
#include "tools/pose.h"

namespace prcage {
namespace {

using ::testing::AllOf;
using testing::diagonal_of;
using ::testing::HasSubstr;
using testing::mapped;
using testing::Random;
using testing::shape;

using Map = std::function<Vec3(const Vec3&)>;

struct Pair {
  std::string name;
  Mesh input;
  Mesh cage;
};

Mesh cage_of(const Mesh& input, std::size_t faces) {
  Options options;
  options.face_budget = faces;
  return make_cage(input, options).cage;
}

// Cages that prcage made, of one piece and of several, with cavities and tunnels; and simple ones.
const std::vector<Pair>& pairs() {
  static const std::vector<Pair> all = [] {
    std::vector<Pair> made{{"cube", shape("bumpy", 500, 3), testing::cube(4)},
                           {"coarse", shape("knot", 1000), testing::scaled(testing::sphere(2), 5)}};
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      for (const char* name : {"bumpy", "spikes", "knot", "bracket", "nested", "slabs"}) {
        const Mesh input = shape(name, 2000, seed);
        made.push_back({name + std::to_string(seed), input, cage_of(input, 300)});
      }
    }
    return made;
  }();
  return all;
}

CageWeights bound(const Mesh& input, const Mesh& cage, const BindOptions& options = {}) {
  CageWeights weights = bind(input, cage, options);
  EXPECT_EQ(weights.status, Status::ok) << weights.message;
  return weights;
}

Mesh deformed(const CageWeights& weights, const Mesh& pose, int threads = 0) {
  const Deformation result = deform(weights, pose, threads);
  EXPECT_EQ(result.status, Status::ok) << result.message;
  return result.mesh;
}

BindOptions options_of(std::size_t keep, Precision precision = Precision::float64, int threads = 0) {
  BindOptions options;
  options.keep = keep;
  options.precision = precision;
  options.threads = threads;
  return options;
}

double largest_distance(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(a.positions.size(), b.positions.size());
  double largest = 0;
  for (std::size_t v = 0; v < a.positions.size(); ++v)
    largest = std::max(largest, (vec(a.positions[v]) - vec(b.positions[v])).norm());
  return largest;
}

// ------------------------------------------------------------------------------------------- invariants

// Each affine map of the cage is one of the mesh.
void expect_reproduced(const Map& map) {
  for (const Pair& pair : pairs()) {
    ASSERT_FALSE(pair.cage.triangles.empty()) << pair.name;
    const Mesh expected = mapped(pair.input, map);
    const double l = std::max(diagonal_of(pair.input), diagonal_of(expected));
    const Mesh got = deformed(bound(pair.input, pair.cage), mapped(pair.cage, map));
    EXPECT_LT(largest_distance(got, expected), 1e-9 * l) << pair.name;
    EXPECT_EQ(got.triangles, pair.input.triangles);
  }
}

TEST(Deform, WeightsAddUpToOne) {
  for (const Pair& pair : pairs()) {
    const CageWeights weights = bound(pair.input, pair.cage);
    ASSERT_EQ(weights.keep, pair.cage.positions.size());
    for (auto row = weights.values.begin(); row != weights.values.end();
         row += static_cast<std::ptrdiff_t>(weights.keep))
      EXPECT_NEAR(std::accumulate(row, row + static_cast<std::ptrdiff_t>(weights.keep), 0.0), 1, 1e-12) << pair.name;
    EXPECT_LT(weights.largest_rest_error, 1e-9) << pair.name;
    EXPECT_EQ(weights.largest_loss, 0);
  }
}

TEST(Deform, ReproducesTheIdentity) {
  expect_reproduced([](const Vec3& p) { return p; });
}

TEST(Deform, ReproducesTranslations) {
  expect_reproduced([](const Vec3& p) -> Vec3 { return p + Vec3(3, -70, 0.1); });
}

TEST(Deform, ReproducesRotations) {
  const Eigen::Matrix3d m = Eigen::AngleAxisd(2.0, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  expect_reproduced([m](const Vec3& p) -> Vec3 { return m * p; });
}

TEST(Deform, ReproducesAffineMaps) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Random random(seed);
    Eigen::Matrix3d m;
    for (Eigen::Index i = 0; i < 3; ++i) m.row(i) = random.uniform(0.2, 3) * random.unit();
    const Vec3 offset = random.uniform(0, 10) * random.unit();
    expect_reproduced([=](const Vec3& p) -> Vec3 { return m * p + offset; });
  }
}

TEST(Deform, MovesTheCageItselfWithTheCage) {
  Random random(9);
  for (const Pair& pair : pairs()) {
    const Mesh pose = mapped(pair.cage, [&](const Vec3& p) -> Vec3 { return p + 0.1 * random.unit(); });
    EXPECT_LT(largest_distance(deformed(bound(pair.cage, pair.cage), pose), pose), 1e-12 * diagonal_of(pose));
  }
}

// A vertex of the cage moves what is near to it, and what is far less.
TEST(Deform, ActsNearTheVertexThatMoves) {
  const Pair& pair = pairs().front();
  Mesh pose = pair.cage;
  pose.positions[7] = position(vec(pose.positions[7]) + Vec3(1, 1, 1));
  const Mesh got = deformed(bound(pair.input, pair.cage), pose);
  const auto moved_by = [&](const Vec3& towards) {
    std::size_t nearest = 0;
    for (std::size_t v = 0; v < pair.input.positions.size(); ++v)
      if (vec(pair.input.positions[v]).dot(towards) > vec(pair.input.positions[nearest]).dot(towards)) nearest = v;
    return (vec(got.positions[nearest]) - vec(pair.input.positions[nearest])).norm();
  };
  EXPECT_GT(moved_by({1, 1, 1}), 3 * moved_by({-1, -1, -1}));
  EXPECT_GT(moved_by({-1, -1, -1}), 0);
}

TEST(Deform, DoesNotDependOnTheOrientationOfTheCage) {
  const Pair& pair = pairs()[2];
  const CageWeights outward = bound(pair.input, pair.cage);
  const CageWeights inward = bound(pair.input, testing::inside_out(pair.cage));
  for (std::size_t i = 0; i < outward.values.size(); ++i) EXPECT_NEAR(outward.values[i], inward.values[i], 1e-12);
}

TEST(Deform, DoesNotDependOnThreads) {
  for (const Pair& pair : {pairs()[2], pairs()[5]}) {
    for (const BindOptions& options : {options_of(0), options_of(7), options_of(0, Precision::float32)}) {
      BindOptions alone = options, together = options;
      alone.threads = 1;
      together.threads = 3;
      const CageWeights a = bound(pair.input, pair.cage, alone), b = bound(pair.input, pair.cage, together);
      EXPECT_EQ(a.values, b.values);
      EXPECT_EQ(a.float_values, b.float_values);
      EXPECT_EQ(a.columns, b.columns);
      EXPECT_EQ(a.mean_loss, b.mean_loss);
      EXPECT_EQ(a.mean_rest_error, b.mean_rest_error);
      const Mesh pose = testing::turned(pair.cage, 4);
      EXPECT_EQ(deformed(a, pose, 1).positions, deformed(b, pose, 3).positions);
    }
  }
}

TEST(Deform, InOneStepIsTheSame) {
  for (const Pair& pair : pairs()) {
    const Mesh pose = posed(pair.cage, {30, 60, {}});
    const Deformation once = deform(pair.input, pair.cage, pose);
    ASSERT_EQ(once.status, Status::ok) << once.message;
    EXPECT_TRUE(testing::same(once.mesh, deformed(bound(pair.input, pair.cage), pose))) << pair.name;
  }
}

TEST(Deform, VerticesThatNoFaceNamesHaveNoWeight) {
  const Pair& pair = pairs()[2];
  Mesh cage = pair.cage;
  cage.positions.insert(cage.positions.begin() + 5, pair.input.positions[0]);
  for (Triangle& t : cage.triangles)
    for (std::uint32_t& v : t) v += v >= 5 ? 1 : 0;
  const CageWeights with = bound(pair.input, cage), without = bound(pair.input, pair.cage);
  for (std::size_t v = 0; v < with.vertices; ++v) {
    EXPECT_EQ(with.values[v * with.keep + 5], 0);
    EXPECT_EQ(with.values[v * with.keep + 6], without.values[v * without.keep + 5]);
  }
  const Deformation once = deform(pair.input, cage, testing::turned(cage, 1));
  EXPECT_EQ(once.mesh.positions, deformed(with, testing::turned(cage, 1)).positions);
}

// --------------------------------------------------------------------------------------------- truncation

TEST(Deform, TruncationKeepsTheLargestAndSaysWhatItCosts) {
  for (const Pair& pair : pairs()) {
    const std::size_t keep = std::min<std::size_t>(6, pair.cage.positions.size() - 1);
    const CageWeights all = bound(pair.input, pair.cage), few = bound(pair.input, pair.cage, options_of(keep));
    ASSERT_EQ(few.keep, keep);
    double largest_loss = 0, loss = 0;
    for (std::size_t v = 0; v < all.vertices; ++v) {
      const double* row = &all.values[v * all.keep];
      std::vector<double> sizes;
      for (std::size_t c = 0; c < all.keep; ++c) sizes.push_back(std::abs(row[c]));
      const double total = std::accumulate(sizes.begin(), sizes.end(), 0.0);
      std::sort(sizes.rbegin(), sizes.rend());
      double kept = 0, sum = 0;
      for (std::size_t k = 0; k < keep; ++k) {
        const std::uint32_t c = few.columns[v * keep + k];
        if (k > 0) {
          EXPECT_GT(c, few.columns[v * keep + k - 1]);
        }
        EXPECT_GE(std::abs(row[c]), sizes[keep - 1]);
        kept += std::abs(row[c]);
        sum += few.values[v * keep + k];
      }
      EXPECT_NEAR(sum, 1, 1e-12);
      largest_loss = std::max(largest_loss, 1 - kept / total);
      loss += 1 - kept / total;
    }
    EXPECT_NEAR(few.largest_loss, largest_loss, 1e-12) << pair.name;
    EXPECT_NEAR(few.mean_loss, loss / static_cast<double>(all.vertices), 1e-12);
  }
}

TEST(Deform, ErrorAtRestIsThatOfTheUndeformedCage) {
  for (const Pair& pair : pairs()) {
    for (const BindOptions& options :
         {options_of(4), options_of(7, Precision::float32), options_of(0, Precision::float32)}) {
      const CageWeights weights = bound(pair.input, pair.cage, options);
      const double l = diagonal_of(pair.input);
      EXPECT_NEAR(weights.largest_rest_error, largest_distance(deformed(weights, pair.cage), pair.input) / l, 1e-15);
      EXPECT_LE(weights.mean_rest_error, weights.largest_rest_error);
      EXPECT_GT(weights.mean_rest_error, 0);
    }
  }
}

TEST(Deform, KeepingMoreIsBetterAndKeepingAllIsExact) {
  const Pair& pair = pairs()[2];
  double before = std::numeric_limits<double>::infinity();
  for (const std::size_t keep : {4u, 16u, 64u}) {
    const CageWeights weights = bound(pair.input, pair.cage, options_of(keep));
    EXPECT_LT(weights.mean_loss, before);
    before = weights.mean_loss;
  }
  const CageWeights all = bound(pair.input, pair.cage, options_of(100000));
  EXPECT_TRUE(all.dense());
  EXPECT_EQ(all.values, bound(pair.input, pair.cage).values);
}

TEST(Deform, FloatsAreTheNearest) {
  const Pair& pair = pairs()[3];
  const CageWeights doubles = bound(pair.input, pair.cage);
  const CageWeights floats = bound(pair.input, pair.cage, options_of(0, Precision::float32));
  ASSERT_EQ(floats.float_values.size(), doubles.values.size());
  EXPECT_TRUE(floats.values.empty());
  for (std::size_t i = 0; i < doubles.values.size(); ++i)
    EXPECT_EQ(floats.float_values[i], static_cast<float>(doubles.values[i]));
  EXPECT_LT(floats.largest_rest_error, 1e-6);
}

// ------------------------------------------------------------------------------------------------ refusals

TEST(Deform, RefusesWhatCannotBeBound) {
  const Mesh cube = testing::cube();
  Mesh open = cube;
  open.triangles.pop_back();
  EXPECT_THAT(bind(cube, open).message, HasSubstr("not closed, 3 of its edges"));
  Mesh turned = cube;
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  EXPECT_THAT(bind(cube, turned).message, HasSubstr("not closed"));
  Mesh broken = cube;
  broken.triangles[3][1] = 8;
  EXPECT_THAT(bind(cube, broken).message, HasSubstr("existing vertices"));
  EXPECT_THAT(bind(broken, cube).message, HasSubstr("face 3 of the input"));
  Mesh nan = cube;
  nan.positions[2][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(bind(nan, cube).message, HasSubstr("vertex 2 of the input"));
  EXPECT_EQ(bind(cube, nan).status, Status::invalid_input);
  EXPECT_EQ(bind(cube, Mesh{}).status, Status::invalid_input);
  EXPECT_EQ(bind(Mesh{}, cube).status, Status::invalid_input);
  EXPECT_EQ(deform(cube, open, open).status, Status::invalid_input);
}

TEST(Deform, RefusesAnotherCage) {
  const Mesh cube = testing::cube();
  const CageWeights weights = bound(cube, cube);
  Mesh more = cube;
  more.positions.push_back({0, 0, 0});
  EXPECT_THAT(deform(weights, more).message, AllOf(HasSubstr("9 vertices"), HasSubstr("has 8")));
  Mesh fewer = cube;
  fewer.triangles.pop_back();
  EXPECT_THAT(deform(weights, fewer).message, AllOf(HasSubstr("11 faces"), HasSubstr("has 12")));
  EXPECT_THAT(deform(cube, cube, testing::sphere(1)).message, AllOf(HasSubstr("vertices"), HasSubstr("faces")));
  Mesh nan = cube;
  nan.positions[2][1] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(deform(weights, nan).message, HasSubstr("vertex 2 of the deformed cage"));
  EXPECT_EQ(deform(CageWeights{}, cube).status, Status::invalid_input);
  CageWeights damaged = weights;
  damaged.values.pop_back();
  EXPECT_EQ(deform(damaged, cube).status, Status::invalid_input);
}

// ------------------------------------------------------------------------------------------------ the file

class WeightsFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    directory_ = ::testing::TempDir() + "/prcage_weights_XXXXXX";
    ASSERT_NE(mkdtemp(directory_.data()), nullptr);
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  std::string path() const { return directory_ + "/weights"; }

  std::string bytes() const {
    std::ifstream file(path(), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  std::string written(const CageWeights& weights) const {
    const WriteResult result = write_weights(path(), weights);
    EXPECT_TRUE(result.ok) << result.error;
    return bytes();
  }

  WeightsFile read(const std::string& bytes) const {
    std::ofstream(path(), std::ios::binary) << bytes;
    return read_weights(path());
  }

  // The error, which names the file.
  std::string error_of(const std::string& bytes) const {
    const WeightsFile file = read(bytes);
    EXPECT_FALSE(file.ok);
    EXPECT_THAT(file.error, ::testing::StartsWith(path() + ": "));
    EXPECT_EQ(file.error.find('\n'), std::string::npos);
    EXPECT_NE(file.weights.status, Status::ok);
    return file.error;
  }

 private:
  std::string directory_;
};

template <class T>
std::string with(std::string bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
  return bytes;
}

CageWeights small(std::size_t keep = 3, Precision precision = Precision::float64) {
  return bound(testing::tetrahedron(), testing::cube(5), options_of(keep, precision));
}

TEST_F(WeightsFiles, RoundTrip) {
  for (const Pair& pair : {pairs()[0], pairs()[4]}) {
    for (const BindOptions& options :
         {options_of(0), options_of(5), options_of(0, Precision::float32), options_of(5, Precision::float32)}) {
      const CageWeights weights = bound(pair.input, pair.cage, options);
      const std::size_t number = options.precision == Precision::float32 ? 4 : 8;
      EXPECT_EQ(written(weights).size(), 88 + 12 * weights.triangles.size() + 4 * weights.columns.size() +
                                             number * weights.vertices * weights.keep + 8);
      const WeightsFile file = read_weights(path());
      ASSERT_TRUE(file.ok) << file.error;
      EXPECT_EQ(file.weights.values, weights.values);
      EXPECT_EQ(file.weights.float_values, weights.float_values);
      EXPECT_EQ(file.weights.columns, weights.columns);
      EXPECT_EQ(file.weights.triangles, weights.triangles);
      EXPECT_EQ(file.weights.keep, weights.keep);
      EXPECT_EQ(file.weights.mean_loss, weights.mean_loss);
      EXPECT_EQ(file.weights.largest_loss, weights.largest_loss);
      EXPECT_EQ(file.weights.mean_rest_error, weights.mean_rest_error);
      EXPECT_EQ(file.weights.largest_rest_error, weights.largest_rest_error);
      const Mesh pose = testing::turned(pair.cage, 3);
      EXPECT_TRUE(testing::same(deformed(file.weights, pose), deformed(weights, pose)));
    }
  }
}

TEST_F(WeightsFiles, EveryTruncationIsRefused) {
  for (const CageWeights& weights : {small(), small(0), small(3, Precision::float32)}) {
    const std::string whole = written(weights);
    for (std::size_t size = 0; size < whole.size(); ++size)
      EXPECT_THAT(error_of(whole.substr(0, size)), AllOf(HasSubstr("byte " + std::to_string(size)), HasSubstr("bind")));
    EXPECT_THAT(error_of(whole + '\0'), HasSubstr("follows"));
  }
}

TEST_F(WeightsFiles, EveryFlippedBitIsRefused) {
  const std::string whole = written(small());
  for (std::size_t i = 0; i < 8 * whole.size(); ++i) {
    std::string bytes = whole;
    bytes[i / 8] = static_cast<char>(bytes[i / 8] ^ (1 << i % 8));
    EXPECT_FALSE(read(bytes).ok) << i;
  }
}

TEST_F(WeightsFiles, ForeignFilesAreNamed) {
  EXPECT_THAT(error_of("ply\nformat ascii 1.0\n"), HasSubstr("PRCAGE-W"));
  EXPECT_THAT(read_weights(path() + ".none").error, HasSubstr("cannot open"));
  EXPECT_THAT(read_weights(std::filesystem::path(path()).parent_path()).error, HasSubstr("irectory"));
}

TEST_F(WeightsFiles, AbsurdHeadersAreRefusedWithTheirPlace) {
  const std::string whole = written(small());
  EXPECT_THAT(error_of(with<std::uint32_t>(whole, 8, 2)), AllOf(HasSubstr("byte 8: version 2"), HasSubstr("another")));
  EXPECT_THAT(error_of(with<std::uint32_t>(whole, 12, 5)), HasSubstr("byte 12: weights of 5 bytes"));
  EXPECT_THAT(error_of(with<std::uint64_t>(whole, 16, 0)), HasSubstr("byte 16: "));
  constexpr std::uint64_t huge = std::uint64_t{1} << 62;
  for (const std::size_t offset : {16u, 24u, 32u, 40u, 48u})
    EXPECT_THAT(error_of(with(whole, offset, huge)), HasSubstr("byte " + std::to_string(offset) + ": the header"));
  // Large, but not absurd: the size of the file tells.
  for (const std::size_t offset : {16u, 24u})
    EXPECT_THAT(error_of(with<std::uint64_t>(whole, offset, 0xfffffff0)), HasSubstr("truncated"));
  EXPECT_THAT(error_of(with<std::uint64_t>(
                  with<std::uint64_t>(with<std::uint64_t>(whole, 16, 0xffffffff), 32, 0xffffffff), 48, 0xffffffff)),
              HasSubstr("more numbers than can be"));
}

TEST_F(WeightsFiles, ImpossibleElementsAreRefusedWithTheirPlace) {
  const std::string whole = written(small());
  const std::size_t columns = 88 + 12 * 4, values = columns + 4 * 4 * 3;
  EXPECT_THAT(error_of(with<std::uint32_t>(whole, 88 + 12 + 4, 4)),
              HasSubstr("byte 104: triangle 1 names vertex 4 of 4"));
  EXPECT_THAT(error_of(with<std::uint32_t>(whole, columns + 4 * 5, 8)),
              HasSubstr("byte " + std::to_string(columns + 20) + ": weight 2 of vertex 1: vertex 8 of the cage"));
  EXPECT_THAT(error_of(with(whole, values + 8 * 4, std::numeric_limits<double>::infinity())),
              HasSubstr("byte " + std::to_string(values + 32) + ": weight 1 of vertex 1 is not finite"));
  EXPECT_THAT(error_of(with(whole, values, 0.5)), HasSubstr("checksum"));
}

TEST_F(WeightsFiles, CannotBeWrittenNowhere) { EXPECT_FALSE(write_weights(path() + "/none", small()).ok); }

// ---------------------------------------------------------------------------------------------------- poses

TEST(Pose, BendsTheMiddleLineIntoAnArc) {
  // A bar along y whose thinnest side is z.
  Mesh bar = mapped(testing::cube(1), [](const Vec3& p) -> Vec3 { return {2 * p.x(), 10 * p.y() + 3, p.z()}; });
  bar.positions.push_back({0, -2, 0});
  bar.positions.push_back({0, 3, 0});
  bar.positions.push_back({0, 8, 0});
  const Mesh bent = posed(bar, {180, 0, {}});
  const double radius = 10 / std::numbers::pi;
  const auto expect = [&](std::size_t v, const Vec3& p) { EXPECT_LT((vec(bent.positions[v]) - p).norm(), 1e-14); };
  expect(8, {0, 3 - radius, radius});
  expect(9, {0, 3, 0});
  expect(10, {0, 3 + radius, radius});
  EXPECT_EQ(bent.triangles, bar.triangles);
}

TEST(Pose, TwistsTheEndsAgainstEachOther) {
  const Mesh bar = mapped(testing::cube(1), [](const Vec3& p) -> Vec3 { return {4 * p.x(), p.y(), p.z()}; });
  const Mesh twisted = posed(bar, {0, 180, {}});
  for (std::size_t v = 0; v < 8; ++v) {
    const Vec3 p = vec(bar.positions[v]), q = vec(twisted.positions[v]);
    const double side = p.x() > 0 ? 1 : -1;
    EXPECT_LT((q - Vec3(p.x(), -side * p.z(), side * p.y())).norm(), 1e-14) << v;
  }
  EXPECT_EQ(posed(bar, {0, 0, 1}).positions, bar.positions);
  const Mesh other = posed(bar, {0, 180, 1});
  for (std::size_t v = 0; v < 8; ++v) EXPECT_EQ(other.positions[v][1], bar.positions[v][1]);
}

}  // namespace
}  // namespace prcage
