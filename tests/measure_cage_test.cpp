// The measures of a cage: against integrals where the shapes are simple, against loops over all faces where they are
// not, and the same for any number of threads. How the samples are drawn is tested by itself.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/area_samples.h"
#include "core/counter_random.h"
#include "core/prcage.h"
#include "test_meshes.h"

namespace prcage {
namespace {

constexpr double degree = 180 / std::numbers::pi;

MeasureOptions sampled(std::size_t samples, std::uint64_t seed = 0, int threads = 0) {
  MeasureOptions options;
  options.samples = samples;
  options.seed = seed;
  options.threads = threads;
  options.views = 0;
  return options;
}

CageMeasures measured(const Mesh& input, const Mesh& cage, const MeasureOptions& options = sampled(100000)) {
  CageMeasures measures = measure_cage(input, cage, options);
  EXPECT_EQ(measures.status, Status::ok) << measures.message;
  return measures;
}

// Mean of f(u, v) over the square [-1, 1]^2, by the midpoint rule.
template <class F>
double square_mean(const F& f) {
  constexpr int n = 1000;
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) sum += f((2 * i + 1.0) / n - 1, (2 * j + 1.0) / n - 1);
  return sum / (n * n);
}

// ----------------------------------------------------------------------------------------------- samples

TEST(CounterRandom, IsUniformAndDependsOnSeedStreamAndCounter) {
  const CounterRandom random(1, 0);
  EXPECT_EQ(random.uniform(7), CounterRandom(1, 0).uniform(7));
  EXPECT_NE(random.uniform(7), CounterRandom(1, 0).uniform(8));
  EXPECT_NE(random.uniform(7), CounterRandom(1, 1).uniform(7));
  EXPECT_NE(random.uniform(7), CounterRandom(2, 0).uniform(7));
  constexpr std::uint64_t n = 100000;
  std::vector<int> count(10);
  double products = 0;
  for (std::uint64_t k = 0; k < n; ++k) {
    const double u = random.uniform(k);
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    ++count[static_cast<std::size_t>(10 * u)];
    products += (u - 0.5) * (random.uniform(k + 1) - 0.5);
  }
  for (const int c : count) EXPECT_NEAR(c, n / 10, 5 * std::sqrt(0.09 * n));
  EXPECT_NEAR(products / n, 0, 5.0 / 12 / std::sqrt(n));
}

TEST(AreaSamples, LieOnTheirFacesEachWithItsShareOfTheArea) {
  // A square of two halves, one of them cut into a tenth and nine tenths by a face without area.
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.1, 1, 0}, {0.5, 1, 0}},
                  {{0, 1, 2}, {3, 4, 5}, {0, 4, 3}, {0, 2, 4}}};
  constexpr std::size_t n = 10000;
  const AreaSamples samples(mesh.positions, mesh.triangles, n, CounterRandom(5, 0));
  std::vector<std::size_t> count(mesh.triangles.size());
  std::vector<Vec3> sum(mesh.triangles.size(), Vec3::Zero());
  for (std::size_t i = 0; i < n; ++i) {
    const auto [point, face] = samples[i];
    EXPECT_LT(testing::triangle_distance(point, testing::corners(mesh, mesh.triangles[face])), 1e-15);
    ++count[face];
    sum[face] += point;
  }
  EXPECT_EQ(count[1], 0u) << "a face without area";
  const double share[] = {0.5, 0, 0.05, 0.45};
  for (const std::size_t f : {0u, 2u, 3u}) {
    EXPECT_NEAR(static_cast<double>(count[f]), n * share[f], 1) << "one for each part of the area";
    const auto [a, b, c] = testing::corners(mesh, mesh.triangles[f]);
    const double noise = 5 * 0.25 / std::sqrt(n * share[f]);
    EXPECT_LT((sum[f] / static_cast<double>(count[f]) - (a + b + c) / 3).norm(), noise) << f;
  }
}

// ---------------------------------------------------------------------------------------------- integrals

// The cube [-1/2, 1/2]^3 in the cube [-3/4, 3/4]^3.
class CubeInCube : public ::testing::Test {
 protected:
  const Mesh input_ = testing::cube(1);
  const Mesh cage_ = testing::cube(1.5);
  const double l_ = std::sqrt(3.0);

  // Distance from (x, y) on the face z = 3/4 of the cage, in units of 3/4.
  static double distance(double u, double v) {
    const auto outside = [](double t) { return std::max(0.75 * std::abs(t) - 0.5, 0.0); };
    return std::hypot(outside(u), outside(v), 0.25);
  }
};

TEST_F(CubeInCube, Sizes) {
  const CageMeasures measures = measured(input_, cage_);
  EXPECT_TRUE(measures.certificate.valid());
  EXPECT_TRUE(paper_conditions(measures.certificate).success());
  EXPECT_TRUE(measures.input_closed);
  EXPECT_EQ(measures.input_faces, 12u);
  EXPECT_EQ(measures.cage_faces, 12u);
  EXPECT_DOUBLE_EQ(measures.diagonal, l_);
  EXPECT_DOUBLE_EQ(measures.volume_ratio.value(), 1.5 * 1.5 * 1.5);
  EXPECT_DOUBLE_EQ(measures.area_ratio, 1.5 * 1.5);
  EXPECT_DOUBLE_EQ(measures.smallest_angle.min, 45);
  EXPECT_DOUBLE_EQ(measures.smallest_angle.fifth_percentile, 45);
  EXPECT_DOUBLE_EQ(measures.smallest_angle.mean, 45);
  EXPECT_FALSE(measures.violation.has_value());
}

TEST_F(CubeInCube, Distances) {
  const CageMeasures measures = measured(input_, cage_);
  EXPECT_DOUBLE_EQ(measures.input_to_cage.hausdorff, 0.25 / l_);
  EXPECT_NEAR(measures.input_to_cage.mean_distance, 0.25 / l_, 1e-12);
  EXPECT_DOUBLE_EQ(measures.input_to_cage.normal_deviation, 0);
  EXPECT_DOUBLE_EQ(measures.cage_to_input.hausdorff, 0.25) << "at the corners: 1/4 sqrt(3) over l";
  EXPECT_NEAR(measures.cage_to_input.mean_distance, square_mean(distance) / l_, 1e-4);
  EXPECT_EQ(measures.hausdorff(), 0.25);
}

TEST_F(CubeInCube, ThicknessBeyondTauIsThatOfEquation8) {
  MeasureOptions options = sampled(100000);
  options.tau_absolute = 0.3;
  const CageMeasures absolute = measured(input_, cage_, options);
  ASSERT_TRUE(absolute.violation.has_value());
  const auto excess = [](double u, double v) { return std::max(distance(u, v) - 0.3, 0.0); };
  EXPECT_DOUBLE_EQ(absolute.violation->tau, 0.3 / l_);
  EXPECT_NEAR(absolute.violation->max, 0.25 - 0.3 / l_, 1e-15);
  EXPECT_NEAR(absolute.violation->mean, square_mean(excess) / l_, 1e-4);
  EXPECT_NEAR(absolute.violation->fraction, square_mean([&](double u, double v) { return excess(u, v) > 0; }), 3e-3);

  options.tau_absolute = 0;
  options.tau = 0.3 / l_;
  EXPECT_NEAR(measured(input_, cage_, options).violation->mean, absolute.violation->mean, 1e-12);
  options.tau = 0.2501;
  EXPECT_EQ(measured(input_, cage_, options).violation->max, 0);
  EXPECT_EQ(measured(input_, cage_, options).violation->fraction, 0);
}

// The unit sphere in the cube of side 3. With rho(u, v) = |(u, v, 1)| for points (u, v) on a face, a solid angle is
// rho^-3 du dv, and the normal of the sphere there makes the angle acos(1 / rho) with that of the face.
TEST(MeasureCage, SphereInACube) {
  constexpr double h = 1.5;
  const CageMeasures measures = measured(testing::sphere(5), testing::cube(2 * h));
  const double l = 2 * std::sqrt(3.0);
  const auto rho = [](double u, double v) { return std::hypot(u, v, 1.0); };
  const auto sphere_mean = [&](auto f) {
    return 6 / std::numbers::pi * square_mean([&](double u, double v) { return f(u, v) * std::pow(rho(u, v), -3); });
  };
  const auto angle = [&](double u, double v) { return degree * std::acos(1 / rho(u, v)); };

  const double facets = 1e-3;  // how far the mesh is from the sphere
  const double tilt = 0.1;     // of the normals of its facets, on average
  EXPECT_NEAR(measures.cage_to_input.hausdorff * l, h * std::sqrt(3.0) - 1, facets);
  EXPECT_NEAR(measures.cage_to_input.mean_distance * l, h * square_mean(rho) - 1, facets);
  EXPECT_NEAR(measures.cage_to_input.normal_deviation, square_mean(angle), tilt);
  EXPECT_NEAR(measures.input_to_cage.hausdorff * l, h - 1 / std::sqrt(3.0), facets);
  const double mean_height = sphere_mean([&](double u, double v) { return 1 / rho(u, v); });
  EXPECT_NEAR(measures.input_to_cage.mean_distance * l, h - mean_height, facets);
  EXPECT_NEAR(measures.input_to_cage.normal_deviation, sphere_mean(angle), tilt);
  EXPECT_NEAR(measures.volume_ratio.value(), 27 / (4 * std::numbers::pi / 3), 0.01);
}

TEST(MeasureCage, InvertedFacesLookAwayFromTheClosestOnes) {
  const Mesh input = testing::cube(1);
  EXPECT_EQ(measured(input, input).inverted_faces, 0u);
  EXPECT_EQ(measured(input, testing::cube(1.5)).inverted_faces, 0u);
  EXPECT_EQ(measured(input, testing::inside_out(testing::cube(1.5))).inverted_faces, 12u);
  Mesh turned = testing::cube(0.9);
  std::swap(turned.triangles[3][0], turned.triangles[3][1]);
  EXPECT_EQ(measured(input, turned).inverted_faces, 1u);
  turned = testing::cube(0.9);
  turned.positions.push_back(position(0.5 * (vec(turned.positions[0]) + vec(turned.positions[1]))));
  turned.triangles.push_back({0, 1, static_cast<std::uint32_t>(turned.positions.size() - 1)});  // looks nowhere
  EXPECT_EQ(measured(input, turned).inverted_faces, 0u);
}

// The closest points are on an edge between faces that look away from each other: either of them will do.
TEST(MeasureCage, InvertedFacesMayBeCloseToSeveral) {
  const Mesh blade = testing::flat_plate(1, 1, 0, 0.001);
  for (const double size : {1.001, 1.1, 2.0}) {
    const Mesh around =
        testing::moved(testing::scaled(blade, size), {0.5 - size / 2, 0.5 - size / 2, 0.0005 * (1 - size)});
    EXPECT_EQ(measured(blade, around).inverted_faces, 0u) << size;
  }
}

// Faces that look the other way are seen by their normals alone.
TEST(MeasureCage, NormalsAreThoseOfTheSidesThatLookOut) {
  const Mesh input = testing::cube(1);
  const CageMeasures measures = measured(input, testing::inside_out(testing::cube(1.5)));
  EXPECT_DOUBLE_EQ(measures.input_to_cage.normal_deviation, 180);
  EXPECT_DOUBLE_EQ(measures.input_to_cage.hausdorff, 0.25 / std::sqrt(3.0));
  EXPECT_FALSE(paper_conditions(measures.certificate).strictly_encloses);
  EXPECT_DOUBLE_EQ(measures.volume_ratio.value(), -1.5 * 1.5 * 1.5);
}

// A bar 100 times as long as it is wide: eight of its faces are slivers.
TEST(MeasureCage, SmallestAnglesAreThoseOfTheCage) {
  Mesh cage = testing::cube(2);
  for (Position& p : cage.positions) p[0] *= 100;
  const CageMeasures measures = measured(testing::cube(1), cage);
  const double sliver = degree * std::atan(1.0 / 100);
  EXPECT_NEAR(measures.smallest_angle.min, sliver, 1e-10);
  EXPECT_NEAR(measures.smallest_angle.fifth_percentile, sliver, 1e-10);
  EXPECT_NEAR(measures.smallest_angle.mean, (8 * sliver + 4 * 45) / 12, 1e-10);
}

// ------------------------------------------------------------------------------------------- all faces

// Very different sizes and places: the search for the closest face works in single precision.
TEST(MeasureCage, LargestDistancesAreThoseOfALoopOverAllFaces) {
  const Mesh knot = testing::shape("knot", 400);
  const std::vector<Mesh> cages{testing::scaled(knot, 1.01), testing::scaled(knot, 1000), testing::scaled(knot, 1e-4),
                                testing::moved(knot, {5e4, 0, 1}), testing::shape("spikes", 300)};
  for (const Mesh& cage : cages)
    for (const auto& [from, to] : {std::pair(&knot, &cage), std::pair(&cage, &knot)}) {
      const CageMeasures measures = measured(*to, *from, sampled(1));
      double expected = 0;
      const testing::BruteDistance distance(*to);
      const auto look = [&](const Vec3& x) { expected = std::max(expected, distance(x)); };
      for (const Triangle& t : from->triangles) testing::for_each_sample(testing::corners(*from, t), 2, look);
      const double found = measures.cage_to_input.hausdorff * measures.diagonal;
      EXPECT_GE(found, expected * (1 - 1e-9));
      EXPECT_LE(found, expected * 1.05) << "the one sample may be farther";
    }
}

void expect_same(const SurfaceDeviation& a, const SurfaceDeviation& b) {
  EXPECT_EQ(a.hausdorff, b.hausdorff);
  EXPECT_EQ(a.mean_distance, b.mean_distance);
  EXPECT_EQ(a.normal_deviation, b.normal_deviation);
}

TEST(MeasureCage, IsTheSameForAnyNumberOfThreadsAndForTheSameSeedOnly) {
  const Mesh input = testing::shape("bumpy", 3000);
  const Mesh cage = testing::scaled(testing::shape("bumpy", 300), 1.3);
  const auto with = [&](std::uint64_t seed, int threads) {
    MeasureOptions options = sampled(20000, seed, threads);
    options.tau = 0.05;
    options.views = 3;
    return measured(input, cage, options);
  };
  const CageMeasures one = with(3, 1);
  for (const int threads : {2, 4}) {
    const CageMeasures other = with(3, threads);
    expect_same(one.cage_to_input, other.cage_to_input);
    expect_same(one.input_to_cage, other.input_to_cage);
    EXPECT_EQ(one.violation->max, other.violation->max);
    EXPECT_EQ(one.violation->mean, other.violation->mean);
    EXPECT_EQ(one.violation->fraction, other.violation->fraction);
    EXPECT_EQ(one.silhouette->mean, other.silhouette->mean);
  }
  const CageMeasures reseeded = with(4, 1);
  EXPECT_NE(one.cage_to_input.mean_distance, reseeded.cage_to_input.mean_distance);
  EXPECT_NE(one.input_to_cage.mean_distance, reseeded.input_to_cage.mean_distance);
  EXPECT_NEAR(one.cage_to_input.mean_distance, reseeded.cage_to_input.mean_distance,
              0.01 * one.cage_to_input.mean_distance);
}

// Only the vertices in use count, for l as for distances.
TEST(MeasureCage, UnreferencedVerticesDoNotCount) {
  Mesh input = testing::cube(1), cage = testing::cube(1.5);
  const CageMeasures expected = measured(input, cage);
  input.positions.insert(input.positions.begin(), {9, 9, 9});
  cage.positions.insert(cage.positions.begin(), {-9, 9, 9});
  for (Mesh* mesh : {&input, &cage})
    for (Triangle& t : mesh->triangles)
      for (std::uint32_t& v : t) ++v;
  const CageMeasures found = measured(input, cage);
  expect_same(found.cage_to_input, expected.cage_to_input);
  expect_same(found.input_to_cage, expected.input_to_cage);
  EXPECT_EQ(found.diagonal, expected.diagonal);
}

// ------------------------------------------------------------------------------------- what is not legal

TEST(MeasureCage, AnOpenInputHasDistancesButNothingInside) {
  Mesh open = testing::cube(1);
  open.triangles.pop_back();
  const CageMeasures measures = measured(open, testing::cube(1.5));
  EXPECT_FALSE(measures.input_closed);
  EXPECT_FALSE(paper_conditions(measures.certificate).strictly_encloses);
  EXPECT_TRUE(measures.certificate.no_contact);
  EXPECT_TRUE(measures.certificate.closed);
  EXPECT_FALSE(measures.volume_ratio.has_value());
  EXPECT_DOUBLE_EQ(measures.input_to_cage.hausdorff, 0.25 / std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(measures.area_ratio, 1.5 * 1.5 * 6 / 5.5);
}

TEST(MeasureCage, FacesWithoutAreaHaveNoNormal) {
  Mesh input = testing::cube(1);
  input.positions.push_back({-0.5, -0.5, 0});
  input.triangles.push_back({0, 8, 4});  // in an edge
  const CageMeasures measures = measured(input, testing::cube(1.5));
  EXPECT_DOUBLE_EQ(measures.input_to_cage.normal_deviation, 0);
  EXPECT_DOUBLE_EQ(measures.input_to_cage.hausdorff, 0.25 / std::sqrt(3.0));
}

void expect_refused(const Mesh& input, const Mesh& cage, const MeasureOptions& options, Status status,
                    const std::string& mentions) {
  const CageMeasures measures = measure_cage(input, cage, options);
  EXPECT_EQ(measures.status, status);
  EXPECT_NE(measures.message.find(mentions), std::string::npos) << measures.message;
  EXPECT_FALSE(measures.certificate.valid());
}

TEST(MeasureCage, RefusesMeshesThatCannotBeMeasured) {
  const Mesh good = testing::cube(1);
  std::vector<Mesh> bad(6, good);
  bad[0] = Mesh{};
  bad[1].triangles[3][1] = 99;
  bad[2].triangles[3][1] = bad[2].triangles[3][0];
  bad[3].positions[0][0] = std::numeric_limits<double>::quiet_NaN();
  bad[4].positions[0][0] = 1e300;
  bad[5] = Mesh{{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}}};
  for (const Mesh& mesh : bad) {
    expect_refused(mesh, good, {}, Status::invalid_input, "the input");
    expect_refused(good, mesh, {}, Status::invalid_input, "the cage");
  }
}

TEST(MeasureCage, RefusesOptionsOutOfRange) {
  const Mesh mesh = testing::cube(1);
  expect_refused(mesh, mesh, sampled(0), Status::invalid_options, "samples");
  for (const double tau : {-0.1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    MeasureOptions options;
    options.tau = tau;
    expect_refused(mesh, mesh, options, Status::invalid_options, "tau");
    options.tau = 0;
    options.tau_absolute = tau;
    expect_refused(mesh, mesh, options, Status::invalid_options, "tau");
  }
}

}  // namespace
}  // namespace prcage
