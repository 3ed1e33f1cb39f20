// Mean value coordinates: against the formula of the paper written down plainly in long doubles, their invariants on
// many cages, and where the formula divides by zero; and for every instruction set of this machine against the scalar
// twin, bit for bit.
#include "core/mean_value.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numeric>
#include <vector>

#include "core/prcage.h"
#include "parallel/cage_weights.h"
#include "random.h"
#include "solids.h"

namespace prcage {
namespace {

using testing::corners;
using testing::diagonal_of;
using testing::Random;
using testing::shape;

// ------------------------------------------------------------------------------------------------ the paper

using Real = long double;
using Vec3L = Eigen::Matrix<Real, 3, 1>;

// The weights of one face (Ju et al. 2005, figure 4), away from its plane.
std::array<Real, 3> face_weights(const std::array<Vec3L, 3>& p) {
  std::array<Real, 3> d, theta;
  std::array<Vec3L, 3> u;
  for (std::size_t i = 0; i < 3; ++i) {
    d[i] = p[i].norm();
    u[i] = p[i] / d[i];
  }
  for (std::size_t i = 0; i < 3; ++i) theta[i] = 2 * std::asin((u[(i + 1) % 3] - u[(i + 2) % 3]).norm() / 2);
  const Real h = (theta[0] + theta[1] + theta[2]) / 2;
  const Real sign = u[0].dot(u[1].cross(u[2])) < 0 ? -1 : 1;
  std::array<Real, 3> c, s, w;
  for (std::size_t i = 0; i < 3; ++i) {
    c[i] = 2 * std::sin(h) * std::sin(h - theta[i]) / (std::sin(theta[(i + 1) % 3]) * std::sin(theta[(i + 2) % 3])) - 1;
    s[i] = sign * std::sqrt(1 - c[i] * c[i]);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    w[i] = (theta[i] - c[j] * theta[k] - c[k] * theta[j]) / (d[i] * std::sin(theta[j]) * s[k]);
  }
  return w;
}

std::vector<double> weights_of_paper(const Mesh& cage, const Vec3& x) {
  std::vector<Real> w(cage.positions.size());
  for (const Triangle& t : cage.triangles) {
    std::array<Vec3L, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = vec(cage.positions[t[i]]).cast<Real>() - x.cast<Real>();
    const std::array<Real, 3> part = face_weights(p);
    for (std::size_t i = 0; i < 3; ++i) w[t[i]] += part[i];
  }
  const Real sum = std::accumulate(w.begin(), w.end(), Real{0});
  std::vector<double> normalised;
  for (const Real v : w) normalised.push_back(static_cast<double>(v / sum));
  return normalised;
}

// ----------------------------------------------------------------------------------------------- helpers

std::vector<double> weights_by(SimdLevel level, const Mesh& cage, const std::vector<Position>& points) {
  std::vector<std::uint32_t> edge, opposite(3 * cage.triangles.size()), column(cage.positions.size());
  const EdgeGroups edges = group_edges(cage.triangles, cage.positions.size());
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const std::uint32_t h = edges[e][0];
    edge.push_back(cage.triangles[h / 3][h % 3]);
    edge.push_back(cage.triangles[h / 3][(h + 1) % 3]);
    for (const std::uint32_t g : edges[e]) opposite[g / 3 * 3 + (g + 2) % 3] = e;
  }
  std::iota(column.begin(), column.end(), 0u);
  const MeanValueCage arrays{
      cage.positions.size(),         edges.size(),   cage.triangles.size(), cage.positions.front().data(), edge.data(),
      cage.triangles.front().data(), opposite.data()};
  std::vector<double> rows(points.size() * column.size());
  std::vector<ScratchRow> scratch(mean_value_scratch_rows(arrays));
  find_mean_values({&arrays, points.size(), points.front().data(), rows.data(), column.size(), column.data(),
                    scratch.front().number},
                   level);
  return rows;
}

std::vector<double> weights_at(const Mesh& cage, const Vec3& x) {
  return weights_by(simd_level(), cage, {position(x)});
}

Vec3 mean(const Mesh& cage, const std::vector<double>& w) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t v = 0; v < w.size(); ++v) sum += w[v] * vec(cage.positions[v]);
  return sum;
}

// Partition of unity and linear precision.
void expect_coordinates(const Mesh& cage, const Vec3& x, const std::vector<double>& w) {
  EXPECT_NEAR(std::accumulate(w.begin(), w.end(), 0.0), 1, 1e-12);
  EXPECT_LT((mean(cage, w) - x).norm(), 1e-12 * diagonal_of(cage)) << x.transpose();
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!(std::abs(a[i] - b[i]) <= largest)) largest = std::abs(a[i] - b[i]);
  }
  return largest;
}

Mesh cube() { return testing::cube(1, {0.5, 0.5, 0.5}); }

// Of many kinds: convex and not, with tunnels, cavities, several components, faces of all sizes.
std::vector<Mesh> cages() {
  std::vector<Mesh> all{cube(), testing::flat_plate(3, 1, 0, 0.2), testing::z_fold(0.1, 0.05),
                        testing::merge(cube(), testing::moved(cube(), {2, 0.5, 0}))};
  for (std::uint64_t seed = 1; seed <= 3; ++seed)
    for (const char* name : {"sphere", "bumpy", "spikes", "knot", "bracket", "nested", "slabs"})
      all.push_back(shape(name, 300, seed));
  return all;
}

Vec3 point_of_face(const std::array<Vec3, 3>& t, Random& random) {
  double a = random.uniform(0, 1), b = random.uniform(0, 1);
  if (a + b > 1) {
    a = 1 - a;
    b = 1 - b;
  }
  return t[0] + a * (t[1] - t[0]) + b * (t[2] - t[0]);
}

std::array<Vec3, 3> random_face(const Mesh& cage, Random& random) {
  return corners(cage, cage.triangles[random.below(cage.triangles.size())]);
}

// Anywhere in the box of the cage: inside of it or not.
Vec3 point_near(const Mesh& cage, Random& random) {
  const Vec3 a = vec(cage.positions[random.below(cage.positions.size())]);
  const Vec3 b = point_of_face(random_face(cage, random), random);
  return a + random.uniform(0.1, 0.9) * (b - a);
}

// ------------------------------------------------------------------------------------------------- tests

TEST(MeanValue, IsThePapersFormula) {
  std::uint64_t seed = 0;
  for (const Mesh& cage : cages()) {
    Random random(++seed);
    for (int i = 0; i < 20; ++i) {
      const Vec3 x = point_near(cage, random) + 1e-3 * diagonal_of(cage) * random.unit();
      EXPECT_LT(largest_difference(weights_at(cage, x), weights_of_paper(cage, x)), 1e-9) << seed << ' ' << i;
    }
  }
}

TEST(MeanValue, ReproducesPointsInsideAndOutside) {
  std::uint64_t seed = 100;
  for (const Mesh& cage : cages()) {
    Random random(++seed);
    for (int i = 0; i < 100; ++i) {
      const Vec3 x = point_near(cage, random);
      const std::vector<double> w = weights_at(cage, x);
      expect_coordinates(cage, x, w);
    }
  }
}

TEST(MeanValue, ArePositiveInAConvexCage) {
  const Mesh cage = shape("sphere", 300);
  Random random(3);
  for (int i = 0; i < 200; ++i)
    for (const double w : weights_at(cage, random.uniform(0, 0.95) * random.unit())) EXPECT_GT(w, 0);
}

TEST(MeanValue, AtVerticesOnEdgesAndOnFacesAreBarycentric) {
  std::uint64_t seed = 200;
  for (const Mesh& cage : cages()) {
    Random random(++seed);
    for (int i = 0; i < 30; ++i) {
      const std::size_t f = random.below(cage.triangles.size());
      const Triangle& t = cage.triangles[f];
      const double b = random.uniform(0, 0.5), c = random.uniform(0, 0.5);
      for (const auto& share : {std::array{1.0, 0.0, 0.0}, std::array{1 - b, b, 0.0}, std::array{1 - b - c, b, c}}) {
        std::vector<double> expected(cage.positions.size());
        Vec3 x = Vec3::Zero();
        for (std::size_t k = 0; k < 3; ++k) {
          expected[t[k]] = share[k];
          x += share[k] * vec(cage.positions[t[k]]);
        }
        const std::vector<double> w = weights_at(cage, x);
        expect_coordinates(cage, x, w);
        const auto [p, q, r] = corners(cage, t);
        const double longest = std::max({(p - q).norm(), (q - r).norm(), (r - p).norm()});
        const double aspect = longest * longest / (q - p).cross(r - p).norm();
        EXPECT_LT(largest_difference(w, expected), 1e-9 * aspect * diagonal_of(cage) / longest) << seed;
      }
    }
  }
}

// As near to a face, an edge, a vertex, or the plane of a face as can be: nothing jumps, nothing is lost.
TEST(MeanValue, KeepTheirPrecisionHoweverNearTheCage) {
  std::uint64_t seed = 300;
  for (const Mesh& cage : cages()) {
    Random random(++seed);
    const double l = diagonal_of(cage);
    for (int power = 1; power <= 17; ++power) {
      const double distance = l * std::pow(10, -power);
      for (int i = 0; i < 4; ++i) {
        const auto [a, b, c] = random_face(cage, random);
        const Vec3 plane = a + random.uniform(-2, 2) * (b - a) + random.uniform(-2, 2) * (c - a);
        for (const Vec3& on :
             {Vec3(a), Vec3(0.3 * a + 0.7 * b), Vec3(0.2 * a + 0.3 * b + 0.5 * c), plane, Vec3(1.5 * a - 0.5 * b)}) {
          const Vec3 x = on + distance * random.unit();
          expect_coordinates(cage, x, weights_at(cage, x));
          expect_coordinates(cage, on, weights_at(cage, on));
        }
      }
    }
  }
}

// On vertices, edges and faces, and where these are seen from the side or from the end.
TEST(MeanValue, AreContinuousAtTheCageAndInLineWithIt) {
  std::uint64_t seed = 400;
  for (const Mesh& cage : cages()) {
    Random random(++seed);
    for (int i = 0; i < 20; ++i) {
      const auto [a, b, c] = random_face(cage, random);
      const double size = std::sqrt((b - a).cross(c - a).norm());
      const Vec3 direction = random.unit();
      for (const Vec3& on :
           {Vec3(a), Vec3((a + b) / 2), Vec3((a + b + c) / 3), Vec3(1.5 * a - 0.5 * b), Vec3(a - b + c)}) {
        const std::vector<double> w = weights_at(cage, on);
        for (const double step : {1e-5, 1e-7, 1e-9, 1e-11, 1e-13}) {
          const double difference = largest_difference(w, weights_at(cage, on + step * size * direction));
          EXPECT_LT(difference, std::max(1e3 * step, 1e-5)) << seed << ' ' << step;
        }
      }
    }
  }
}

TEST(MeanValue, SizeAndPlaceOfTheCageDoNotMatter) {
  Random random(5);
  const Mesh cage = shape("knot", 300);
  const Vec3 x = vec(cage.positions[0]) * 0.9;
  const std::vector<double> w = weights_at(cage, x);
  for (const double scale : {1e-3, 1e3}) {
    const Vec3 offset = scale * 100 * random.unit();
    const auto map = [&](const Vec3& p) -> Vec3 { return scale * p + offset; };
    EXPECT_LT(largest_difference(w, weights_at(testing::mapped(cage, map), map(x))), 1e-9);
  }
}

TEST(MeanValue, FacesWithoutAreaAreNothing) {
  // A cube with a vertex on one edge, where two faces have three collinear corners.
  Mesh cage = cube();
  const std::vector<double> before = weights_at(cage, {0.3, 0.6, 0.2});
  const Triangle t = cage.triangles[0];
  const auto extra = static_cast<std::uint32_t>(cage.positions.size());
  cage.positions.push_back(position((vec(cage.positions[t[0]]) + vec(cage.positions[t[1]])) / 2));
  cage.triangles.push_back({t[0], t[1], extra});
  cage.triangles.push_back({t[1], t[0], extra});
  const std::vector<double> after = weights_at(cage, {0.3, 0.6, 0.2});
  EXPECT_LT(std::abs(after[extra]), 1e-15);
  for (std::size_t v = 0; v < before.size(); ++v) EXPECT_NEAR(after[v], before[v], 1e-15);
}

// ---------------------------------------------------------------------------------------- instruction sets

TEST(MeanValue, SameBitsForEveryInstructionSet) {
  std::uint64_t seed = 500;
  for (const Mesh& cage : cages()) {
    Random random(++seed);
    std::vector<Position> points;
    for (int i = 0; i < 40; ++i) {
      const auto [a, b, c] = random_face(cage, random);
      const double distance = diagonal_of(cage) * std::pow(10, random.uniform(-17, 0));
      for (const Vec3& on : {Vec3(a), Vec3((a + b) / 2), Vec3((a + b + c) / 3), Vec3(2 * a - b)}) {
        points.push_back(position(on));
        points.push_back(position(on + distance * random.unit()));
      }
    }
    points.pop_back();  // no multiple of any width
    const std::vector<double> expected = weights_by(SimdLevel::scalar, cage, points);
    for (const SimdLevel level : available_simd_levels()) {
      const std::vector<double> got = weights_by(level, cage, points);
      EXPECT_EQ(std::memcmp(got.data(), expected.data(), got.size() * sizeof(double)), 0) << name_of(level);
    }
  }
}

}  // namespace
}  // namespace prcage
