// The quadratic programme against brute force: the optimum is the minimiser on the intersection of at most three of the
// planes, so trying all of them, in extended precision, finds it.
#include "core/qp3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "random.h"

namespace prcage {
namespace {

using testing::Random;

using Long3 = Eigen::Matrix<long double, 3, 1>;
using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using LongVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

constexpr double tolerance = 1e-10;

struct Problem {
  Symmetric3 form{1, 0, 0, 1, 0, 1};
  Vec3 linear = Vec3::Zero();
  std::vector<double> nx, ny, nz, offset;

  void add(const Vec3& n, double o) {
    nx.push_back(n.x());
    ny.push_back(n.y());
    nz.push_back(n.z());
    offset.push_back(o);
  }
  Vec3 normal(std::size_t i) const { return {nx[i], ny[i], nz[i]}; }
  std::size_t size() const { return nx.size(); }
  PlaneArrays planes() const { return {nx.data(), ny.data(), nz.data(), offset.data(), size()}; }

  long double value(const Long3& x) const {
    const Long3 Gx{form.xx * x[0] + form.xy * x[1] + form.xz * x[2], form.xy * x[0] + form.yy * x[1] + form.yz * x[2],
                   form.xz * x[0] + form.yz * x[1] + form.zz * x[2]};
    return 0.5L * x.dot(Gx) + linear.cast<long double>().dot(x);
  }
  // Smallest slack over the planes; infinity if there are none.
  long double slack(const Long3& x) const {
    long double worst = std::numeric_limits<long double>::infinity();
    for (std::size_t i = 0; i < size(); ++i) worst = std::min(worst, normal(i).cast<long double>().dot(x) - offset[i]);
    return worst;
  }
};

// The minimiser on the intersection of the chosen planes; false if they are dependent.
bool minimiser_on(const Problem& p, const std::vector<std::size_t>& chosen, Long3& x) {
  const auto m = static_cast<Eigen::Index>(chosen.size());
  LongMatrix A = LongMatrix::Zero(3 + m, 3 + m);
  LongVector b = LongVector::Zero(3 + m);
  A.topLeftCorner(3, 3) << p.form.xx, p.form.xy, p.form.xz, p.form.xy, p.form.yy, p.form.yz, p.form.xz, p.form.yz,
      p.form.zz;
  b.head(3) = -p.linear.cast<long double>();
  for (Eigen::Index i = 0; i < m; ++i) {
    const std::size_t k = chosen[static_cast<std::size_t>(i)];
    A.block(3 + i, 0, 1, 3) = p.normal(k).cast<long double>().transpose();
    A.block(0, 3 + i, 3, 1) = p.normal(k).cast<long double>();
    b[3 + i] = p.offset[k];
  }
  const Eigen::FullPivLU<LongMatrix> lu(A);
  if (!lu.isInvertible()) return false;
  x = lu.solve(b).head(3);
  return x.allFinite();
}

struct Optimum {
  bool feasible = false;
  long double value = std::numeric_limits<long double>::infinity();
  Long3 x = Long3::Zero();
};

Optimum brute_force(const Problem& p, long double allowed) {
  Optimum best;
  const auto consider = [&](const std::vector<std::size_t>& chosen) {
    Long3 x;
    if (!minimiser_on(p, chosen, x) || p.slack(x) < -allowed * (1 + x.norm())) return;
    if (const long double v = p.value(x); v < best.value) best = {true, v, x};
  };
  consider({});
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    consider({i});
    for (std::size_t j = 0; j < i; ++j) {
      consider({i, j});
      for (std::size_t k = 0; k < j; ++k) consider({i, j, k});
    }
  }
  return best;
}

// x minimises if the gradient is a non-negative combination of the normals of active planes: projected gradient steps
// along feasible directions cannot descend. Judged by the value of the optimum with slightly relaxed planes.
void expect_optimal(const Problem& p, const Vec3& x, const Optimum& best) {
  const Long3 lx = x.cast<long double>();
  const double size = 1 + x.norm();
  EXPECT_GE(static_cast<double>(p.slack(lx)), -tolerance - 1e-13 * size);
  if (!best.feasible) return;  // feasible within the tolerance only
  const auto scale = static_cast<double>(std::abs(best.value)) + p.form.trace() * size * size;
  EXPECT_LE(static_cast<double>(p.value(lx) - best.value), 1e-9 * scale);
}

// The same problem with every plane pulled in by `margin`.
Problem tightened(Problem p, double margin) {
  for (double& o : p.offset) o += margin;
  return p;
}

struct Tally {
  int solved = 0;
  int infeasible = 0;
  int not_converged = 0;
  int compared = 0;  // solved, and brute force found the optimum
};

void check(const Problem& p, Tally& tally) {
  Vec3 x = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  const QpStatus status = solve_qp3(p.form, p.linear, p.planes(), tolerance, x);
  switch (status) {
    case QpStatus::solved: {
      ++tally.solved;
      const Optimum best = brute_force(p, 1e-16L);
      expect_optimal(p, x, best);
      tally.compared += best.feasible ? 1 : 0;
      break;
    }
    case QpStatus::infeasible: {
      ++tally.infeasible;
      const Optimum inner = brute_force(tightened(p, 1e-6), 1e-17L);
      EXPECT_FALSE(inner.feasible && inner.x.norm() < 1e4)
          << "declared infeasible, but there is room at " << inner.x.cast<double>().transpose();
      break;
    }
    case QpStatus::not_converged:
      ++tally.not_converged;
  }
}

Symmetric3 random_form(double smallest, Random& random) {
  Symmetric3 form{smallest, 0, 0, smallest, 0, smallest};
  const std::size_t faces = 1 + random.below(6);
  for (std::size_t i = 0; i < faces; ++i) form.add_outer(random.unit(), random.uniform(0.01, 1));
  return form;
}

TEST(Qp3, WithoutPlanesItIsTheMinimumOfTheForm) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    Problem p;
    p.form = random_form(1e-3, random);
    p.linear = random.unit();
    Vec3 x;
    ASSERT_EQ(solve_qp3(p.form, p.linear, p.planes(), tolerance, x), QpStatus::solved);
    EXPECT_LT((p.form * x + p.linear).norm(), 1e-12);
  }
}

TEST(Qp3, RandomPlanesAgreeWithAllActiveSets) {
  Random random(2);
  Tally tally;
  for (int trial = 0; trial < 1500; ++trial) {
    Problem p;
    p.form = random_form(1e-3, random);
    p.linear = random.uniform(0, 2) * random.unit();
    const std::size_t n = random.below(13);
    for (std::size_t i = 0; i < n; ++i) p.add(random.unit(), random.uniform(-1, 0.3));
    check(p, tally);
  }
  EXPECT_EQ(tally.not_converged, 0);
  EXPECT_GT(tally.compared, 500);
  EXPECT_GT(tally.infeasible, 50);
}

// What the engine solves: slabs around faces of a nearly flat star, and a form of rank one with a small ridge.
TEST(Qp3Slow, SlabsOfFlatStarsAgreeWithAllActiveSets) {
  Random random(3);
  Tally tally;
  for (int trial = 0; trial < 1500; ++trial) {
    Problem p;
    const Vec3 up = random.unit();
    const double roughness = std::pow(10, random.uniform(-9, -0.5));
    p.form = {1e-3 / 3, 0, 0, 1e-3 / 3, 0, 1e-3 / 3};
    const std::size_t faces = 3 + random.below(4);
    for (std::size_t i = 0; i < faces; ++i) {
      const Vec3 n = (up + roughness * random.unit()).normalized();
      const double height = roughness * random.uniform(-0.1, 0.1);
      p.form.add_outer(n, 1.0 / static_cast<double>(faces));
      p.linear -= height / static_cast<double>(faces) * n;
      p.add(n, height + 1e-9);
      p.add(-n, -(height + random.uniform(0, 0.2)));
      if (i % 2 == 0) p.add(n.cross(random.unit()).normalized(), random.uniform(-1, 0));
    }
    check(p, tally);
  }
  EXPECT_LE(tally.not_converged, 2);
  EXPECT_GT(tally.compared, 600);
}

TEST(Qp3, InfeasibleProblemsAreCalledSo) {
  Random random(4);
  for (int trial = 0; trial < 500; ++trial) {
    Problem p;
    p.form = random_form(1e-3, random);
    p.linear = random.unit();
    // A simplex turned inside out: the normals positively span space, the offsets leave nothing.
    const Vec3 a = random.unit(), b = random.unit(), c = random.unit();
    for (const Vec3& n : {a, b, c}) p.add(n, 0.1);
    p.add(-(a + b + c).normalized(), 0.1);
    const std::size_t more = random.below(8);
    for (std::size_t i = 0; i < more; ++i) p.add(random.unit(), random.uniform(-1, 0));
    Vec3 x;
    EXPECT_EQ(solve_qp3(p.form, p.linear, p.planes(), tolerance, x), QpStatus::infeasible) << trial;
  }
}

TEST(Qp3, AnEmptySlabIsInfeasibleAndAThinOneIsNot) {
  for (const double width : {-1e-3, -1e-6, -1e-9, 1e-9, 1e-6, 1e-3}) {
    Problem p;
    p.add({0, 0, 1}, 0.5);
    p.add({0, 0, -1}, -0.5 - width);
    Vec3 x;
    EXPECT_EQ(solve_qp3(p.form, p.linear, p.planes(), tolerance, x),
              width > 0 ? QpStatus::solved : QpStatus::infeasible)
        << width;
    if (width > 0) {
      EXPECT_NEAR(x.z(), 0.5, 2 * tolerance);
    }
  }
}

// Repeated and weaker copies of planes change nothing.
TEST(Qp3, RedundantPlanesDoNotMoveTheOptimum) {
  Random random(5);
  for (int trial = 0; trial < 300; ++trial) {
    Problem p;
    p.form = random_form(1e-2, random);
    p.linear = random.unit();
    for (int i = 0; i < 5; ++i) p.add(random.unit(), random.uniform(-1, 0));  // the origin is feasible
    Problem more = p;
    for (int i = 0; i < 20; ++i) {
      const std::size_t k = random.below(5);
      more.add(p.normal(k), p.offset[k] - random.uniform(0, 1) * static_cast<double>(random.below(2)));
    }
    Vec3 x, y;
    ASSERT_EQ(solve_qp3(p.form, p.linear, p.planes(), tolerance, x), QpStatus::solved);
    ASSERT_EQ(solve_qp3(more.form, more.linear, more.planes(), tolerance, y), QpStatus::solved);
    EXPECT_LT((x - y).norm(), 1e-7);
  }
}

TEST(Qp3Slow, NearlyParallelPlanesAgreeWithAllActiveSets) {
  Random random(6);
  Tally tally;
  for (int trial = 0; trial < 1500; ++trial) {
    Problem p;
    p.form = random_form(1e-3, random);
    p.linear = random.unit();
    const double angle = std::pow(10, random.uniform(-12, -2));
    for (int i = 0; i < 3; ++i) {
      const Vec3 n = random.unit();
      const double o = random.uniform(-0.5, 0.2);
      for (int k = 0; k < 3; ++k) p.add((n + angle * random.unit()).normalized(), o + angle * random.uniform(-1, 1));
    }
    check(p, tally);
  }
  EXPECT_LE(tally.not_converged, 2);
  EXPECT_GT(tally.compared, 600);
}

// Forms whose eigenvalues lie up to ten orders of magnitude apart, and offsets far from one.
TEST(Qp3Slow, BadlyScaledProblemsStayFeasibleAndNearlyOptimal) {
  Random random(7);
  Tally tally;
  for (int trial = 0; trial < 1500; ++trial) {
    Problem p;
    const double smallest = std::pow(10, random.uniform(-10, -1));
    p.form = {smallest, 0, 0, smallest, 0, smallest};
    p.form.add_outer(random.unit(), 1);
    p.linear = smallest * random.unit();
    const double scale = std::pow(10, random.uniform(-6, 2));
    for (int i = 0; i < 8; ++i) p.add(random.unit(), scale * random.uniform(-1, 0.2));
    check(p, tally);
  }
  EXPECT_LE(tally.not_converged, 2);
  EXPECT_GT(tally.compared, 600);
}

// Karush, Kuhn, Tucker: the gradient at the solution is a combination of the normals of the active planes with
// multipliers that are not negative, so no feasible direction descends.
TEST(Qp3, NoFeasibleDirectionDescendsFromTheSolution) {
  Random random(8);
  for (int trial = 0; trial < 300; ++trial) {
    Problem p;
    p.form = random_form(1e-2, random);
    p.linear = 2 * random.unit();
    for (int i = 0; i < 30; ++i) p.add(random.unit(), random.uniform(-1, -0.1));
    Vec3 x;
    ASSERT_EQ(solve_qp3(p.form, p.linear, p.planes(), tolerance, x), QpStatus::solved);
    const Vec3 gradient = p.form * x + p.linear;
    for (int k = 0; k < 200; ++k) {
      const Vec3 direction = random.unit();
      bool feasible = true;
      for (std::size_t i = 0; i < p.size(); ++i)
        feasible = feasible && (p.normal(i).dot(x) - p.offset[i] > 1e-8 || p.normal(i).dot(direction) >= 0);
      if (feasible) {
        EXPECT_GE(gradient.dot(direction), -1e-7);
      }
    }
  }
}

TEST(Qp3, AFormThatIsNotPositiveIsRefused) {
  const Problem p;
  Vec3 x;
  EXPECT_EQ(solve_qp3({0, 0, 0, 0, 0, 0}, Vec3::UnitX(), p.planes(), tolerance, x), QpStatus::not_converged);
  EXPECT_EQ(solve_qp3({1, 2, 0, 1, 0, 1}, Vec3::UnitX(), p.planes(), tolerance, x), QpStatus::not_converged);
}

}  // namespace
}  // namespace prcage
