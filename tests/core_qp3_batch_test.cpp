// The batch solver against its scalar twin, bit for bit, for every instruction set of this machine, on problems of all
// kinds; and the choice of the instruction set.
#include "core/qp3_batch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "random.h"

namespace prcage {
namespace {

using testing::Random;

constexpr double tolerance = 1e-10;

constexpr double infinity = std::numeric_limits<double>::infinity();

// offset <= normal . x, and normal . x <= upper if it becomes a slab.
struct Plane {
  Vec3 normal;
  double offset;
  double upper = infinity;
};

struct Problem {
  Symmetric3 form{1, 0, 0, 1, 0, 1};
  Vec3 linear = Vec3::Zero();
  std::vector<Plane> planes;
};

// Problems in the form of the batch solver, the first half of the planes as slabs and the others as half-spaces; and as
// single planes, in the order in which those are visited.
class Flat {
 public:
  explicit Flat(const std::vector<Problem>& problems) {
    for (const Problem& p : problems) {
      form_.push_back(p.form);
      linear_.push_back(p.linear);
      const std::size_t slabs = (p.planes.size() + 1) / 2;
      add_rows(p.planes, slabs);
      for (std::size_t i = 0; i < slabs; ++i) add_plane(p.planes[i].normal, p.planes[i].offset);
      for (std::size_t i = 0; i < slabs; ++i)
        if (p.planes[i].upper < infinity) add_plane(-p.planes[i].normal, -p.planes[i].upper);
      for (std::size_t i = slabs; i < p.planes.size(); ++i) add_plane(p.planes[i].normal, p.planes[i].offset);
      first_plane_.push_back(nx_.size());
    }
  }
  Qp3Batch batch() const { return {form_, linear_, first_row_, row_length_, rows_}; }
  PlaneArrays planes(std::size_t i) const {
    const std::size_t first = first_plane_[i];
    return {nx_.data() + first, ny_.data() + first, nz_.data() + first, offset_.data() + first,
            first_plane_[i + 1] - first};
  }

 private:
  void add_rows(const std::vector<Plane>& planes, std::size_t slabs) {
    const std::size_t first = rows_.size(), length = slabs == 0 ? 0 : row_length(slabs);
    first_row_.push_back(static_cast<std::uint32_t>(first));
    row_length_.push_back(static_cast<std::uint32_t>(length));
    rows_.resize(first + slab_rows * length, 0.0);
    const auto row = [&](std::size_t r) { return rows_.begin() + static_cast<std::ptrdiff_t>(first + r * length); };
    std::fill_n(row(slab_lower), length, -1.0);
    std::fill_n(row(slab_upper), length, 1.0);
    std::fill_n(row(slab_inward_offset), length, -1.0);
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const bool slab = i < slabs;
      const auto k = static_cast<std::ptrdiff_t>(slab ? i : i - slabs);
      for (std::size_t c = 0; c < 3; ++c)
        row((slab ? slab_normal : slab_inward) + c)[k] = planes[i].normal[static_cast<Eigen::Index>(c)];
      row(slab ? slab_lower : slab_inward_offset)[k] = planes[i].offset;
      if (slab) row(slab_upper)[k] = planes[i].upper;
    }
  }
  void add_plane(const Vec3& normal, double offset) {
    nx_.push_back(normal.x());
    ny_.push_back(normal.y());
    nz_.push_back(normal.z());
    offset_.push_back(offset);
  }

  std::vector<Symmetric3> form_;
  std::vector<Vec3> linear_;
  std::vector<std::uint32_t> first_row_, row_length_;
  std::vector<double> rows_;
  std::vector<std::size_t> first_plane_{0};
  std::vector<double> nx_, ny_, nz_, offset_;
};

struct Solutions {
  std::vector<Vec3> x;
  std::vector<QpStatus> status;

  // Of what no solver returns, to see what is written.
  explicit Solutions(std::size_t n) : x(n, Vec3(-1e300, 7, 1e-300)), status(n, static_cast<QpStatus>(77)) {}

  bool same(std::size_t i, const Solutions& other, std::size_t k) const {
    return status[i] == other.status[k] && std::memcmp(x[i].data(), other.x[k].data(), 3 * sizeof(double)) == 0;
  }
  std::ptrdiff_t count(QpStatus s) const { return std::count(status.begin(), status.end(), s); }
};

Solutions solve_one_by_one(const std::vector<Problem>& problems) {
  const Flat flat(problems);
  Solutions s(problems.size());
  for (std::size_t i = 0; i < problems.size(); ++i)
    s.status[i] = solve_qp3(problems[i].form, problems[i].linear, flat.planes(i), tolerance, s.x[i]);
  return s;
}

Solutions solve_as_batch(const std::vector<Problem>& problems, SimdLevel level) {
  const Flat flat(problems);
  Solutions s(problems.size());
  solve_qp3_batch(flat.batch(), tolerance, s.x, s.status, level);
  return s;
}

// Returns what the scalar solver finds.
Solutions expect_same_bits(const std::vector<Problem>& problems) {
  Solutions expected = solve_one_by_one(problems);
  for (const SimdLevel level : available_simd_levels()) {
    const Solutions got = solve_as_batch(problems, level);
    std::size_t different = 0;
    for (std::size_t i = 0; i < problems.size(); ++i) different += got.same(i, expected, i) ? 0 : 1;
    EXPECT_EQ(different, 0u) << name_of(level) << ", of " << problems.size();
  }
  return expected;
}

void add_planes(Problem& p, std::size_t count, double lowest, double highest, Random& random) {
  for (std::size_t i = 0; i < count; ++i) p.planes.push_back({random.unit(), random.uniform(lowest, highest)});
}

Problem any_problem(Random& random) {
  Problem p;
  p.form = {1e-3, 0, 0, 1e-3, 0, 1e-3};
  for (std::size_t faces = 1 + random.below(6); faces > 0; --faces)
    p.form.add_outer(random.unit(), random.uniform(0.01, 1));
  p.linear = random.uniform(0, 2) * random.unit();
  add_planes(p, random.below(50), -1, 0.1, random);
  return p;
}

// Slabs around the faces of a nearly flat star and the bounds of its orientations, as the engine makes them.
Problem flat_star(Random& random) {
  Problem p;
  const Vec3 up = random.unit();
  const double roughness = std::pow(10, random.uniform(-9, -0.5));
  p.form = {1e-3 / 3, 0, 0, 1e-3 / 3, 0, 1e-3 / 3};
  const std::size_t faces = 4 + random.below(10);
  for (std::size_t i = 0; i < faces; ++i) {
    const Vec3 n = (up + roughness * random.unit()).normalized();
    const double height = roughness * random.uniform(-0.1, 0.1);
    p.form.add_outer(n, 1.0 / static_cast<double>(faces));
    p.linear -= height / static_cast<double>(faces) * n;
    p.planes.push_back({n, height + 1e-9});
    p.planes.push_back({-n, -(height + random.uniform(0, 0.2))});
    p.planes.push_back({n.cross(random.unit()).normalized(), random.uniform(-1, 0)});
  }
  return p;
}

Problem infeasible(Random& random) {
  Problem p = any_problem(random);
  const Vec3 a = random.unit(), b = random.unit(), c = random.unit();
  for (const Vec3& n : {a, b, c}) p.planes.push_back({n, 0.1});
  p.planes.push_back({-(a + b + c).normalized(), 0.1});
  std::shuffle(p.planes.begin(), p.planes.end(), random.engine());
  return p;
}

Problem badly_scaled(Random& random) {
  Problem p;
  const double smallest = std::pow(10, random.uniform(-10, -1));
  p.form = {smallest, 0, 0, smallest, 0, smallest};
  p.form.add_outer(random.unit(), 1);
  p.linear = smallest * random.unit();
  const double scale = std::pow(10, random.uniform(-6, 2));
  add_planes(p, random.below(24), -scale, 0.2 * scale, random);
  return p;
}

// The worst plane has equals: the first of them must enter.
Problem with_duplicates(Random& random) {
  Problem p = any_problem(random);
  const std::size_t n = p.planes.size();
  for (std::size_t i = 0; i < n; ++i) p.planes.push_back(p.planes[random.below(n)]);
  std::shuffle(p.planes.begin(), p.planes.end(), random.engine());
  return p;
}

// Different planes, the very same slack.
Problem symmetric(Random& random) {
  Problem p;
  const double offset = random.uniform(0.1, 1);
  for (const double sx : {-1, 1})
    for (const double sy : {-1, 1}) p.planes.push_back({Vec3(0.48 * sx, 0.64 * sy, 0.6), offset});
  add_planes(p, random.below(9), -2, -1, random);
  std::shuffle(p.planes.begin(), p.planes.end(), random.engine());
  return p;
}

Problem nearly_parallel(Random& random) {
  Problem p = any_problem(random);
  p.planes.clear();
  const double angle = std::pow(10, random.uniform(-16, -2));
  for (int i = 0; i < 3; ++i) {
    const Vec3 n = random.unit();
    const double o = random.uniform(-0.5, 0.3);
    for (int k = 0; k < 5; ++k)
      p.planes.push_back({(n + angle * random.unit()).normalized(), o + angle * random.uniform(-1, 1)});
  }
  return p;
}

// Both sides bounded, some slabs empty.
Problem slabs(Random& random) {
  Problem p = any_problem(random);
  for (Plane& plane : p.planes) plane.upper = plane.offset + random.uniform(-0.01, 4);
  return p;
}

Problem few_planes(Random& random) {
  Problem p = any_problem(random);
  p.planes.resize(std::min(p.planes.size(), random.below(10)));
  return p;
}

Problem many_planes(Random& random) {
  Problem p = any_problem(random);
  add_planes(p, random.below(600), -1, -0.3, random);
  return p;
}

// Forms that are not positive definite, and numbers that are not finite.
Problem broken(Random& random) {
  Problem p = any_problem(random);
  const double bad[] = {0, -1, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()};
  const double value = bad[random.below(4)];
  switch (random.below(4)) {
    case 0:
      p.form.xx = value;
      break;
    case 1:
      p.form.zz = value;
      break;
    case 2:
      p.linear.y() = value;
      break;
    default:
      if (!p.planes.empty()) p.planes[random.below(p.planes.size())].offset = value;
  }
  return p;
}

struct Kind {
  const char* name;
  Problem (*make)(Random&);
};

const Kind kinds[] = {{"Any", any_problem},
                      {"FlatStar", flat_star},
                      {"Infeasible", infeasible},
                      {"BadlyScaled", badly_scaled},
                      {"WithDuplicates", with_duplicates},
                      {"Symmetric", symmetric},
                      {"NearlyParallel", nearly_parallel},
                      {"Slabs", slabs},
                      {"FewPlanes", few_planes},
                      {"ManyPlanes", many_planes},
                      {"Broken", broken}};

std::vector<Problem> make_problems(std::size_t n, const std::function<Problem(Random&)>& make, std::uint64_t seed) {
  Random random(seed);
  std::vector<Problem> problems;
  for (std::size_t i = 0; i < n; ++i) problems.push_back(make(random));
  return problems;
}

Problem any_kind(Random& random) { return kinds[random.below(std::size(kinds))].make(random); }

class Qp3BatchKinds : public ::testing::TestWithParam<Kind> {};

TEST_P(Qp3BatchKinds, AllInstructionSetsGiveTheSameBits) {
  const std::string name = GetParam().name;
  const Solutions s = expect_same_bits(make_problems(2000, GetParam().make, 1));
  // The kinds are what they are called.
  if (name == "Infeasible") {
    EXPECT_EQ(s.count(QpStatus::infeasible), 2000);
  } else if (name == "Broken") {
    EXPECT_GT(s.count(QpStatus::not_converged), 500);
  } else {
    EXPECT_GT(s.count(QpStatus::solved), 500);
    EXPECT_LT(s.count(QpStatus::not_converged), 20);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, Qp3BatchKinds, ::testing::ValuesIn(kinds),
                         [](const auto& kind) { return std::string(kind.param.name); });

TEST(Qp3Batch, EverySizeOfABatch) {
  for (std::size_t n = 0; n <= 40; ++n) expect_same_bits(make_problems(n, any_kind, n));
  for (const std::size_t n : {127u, 128u, 129u, 1000u}) expect_same_bits(make_problems(n, any_kind, n));
}

TEST(Qp3Batch, EveryNumberOfPlanes) {
  std::size_t planes = 0;
  const auto next = [&planes](Random& random) {
    Problem p;
    p.linear = random.unit();
    add_planes(p, planes++, -1, -0.2, random);
    return p;
  };
  const Solutions s = expect_same_bits(make_problems(100, next, 3));
  EXPECT_EQ(s.count(QpStatus::solved), 100);
}

// Where the worst plane lies must not matter: neither the tail of the last vector nor its overlap.
TEST(Qp3Batch, TheViolatedPlaneIsFoundWhereverItIs) {
  for (std::size_t n = 1; n <= 40; ++n) {
    std::vector<Problem> problems(n);
    for (std::size_t i = 0; i < n; ++i) {
      problems[i].planes.assign(n, {Vec3::UnitY(), -1});
      problems[i].planes[i] = {Vec3::UnitX(), 0.5};
    }
    const Solutions s = expect_same_bits(problems);
    for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(s.x[i], Vec3(0.5, 0, 0));
  }
}

TEST(Qp3Batch, TheViolatedUpperBoundIsFoundWhereverItIs) {
  for (std::size_t n = 1; n <= 40; ++n) {
    std::vector<Problem> problems(n);
    for (std::size_t i = 0; i < n; ++i) {
      problems[i].planes.assign(2 * n, {Vec3::UnitY(), -1, 1});
      problems[i].planes[i] = {Vec3::UnitX(), -1, -0.5};
    }
    const Solutions s = expect_same_bits(problems);
    for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(s.x[i], Vec3(-0.5, 0, 0));
  }
}

TEST(Qp3Batch, NeighboursDoNotMatter) {
  const std::vector<Problem> problems = make_problems(500, any_kind, 5);
  std::vector<std::size_t> order(problems.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937_64(6));
  std::vector<Problem> shuffled;
  for (const std::size_t i : order) shuffled.push_back(problems[i]);
  for (const SimdLevel level : available_simd_levels()) {
    const Solutions straight = solve_as_batch(problems, level), mixed = solve_as_batch(shuffled, level);
    for (std::size_t k = 0; k < order.size(); ++k) {
      EXPECT_TRUE(mixed.same(k, straight, order[k])) << name_of(level) << ' ' << order[k];
      EXPECT_TRUE(solve_as_batch({problems[k]}, level).same(0, straight, k)) << name_of(level) << ' ' << k;
    }
  }
}

TEST(Qp3Batch, WritesNoPositionUnlessSolved) {
  const std::vector<Problem> problems = make_problems(300, any_kind, 7);
  const Vec3 untouched = Solutions(1).x[0];
  for (const SimdLevel level : available_simd_levels()) {
    const Solutions s = solve_as_batch(problems, level);
    for (std::size_t i = 0; i < problems.size(); ++i) {
      EXPECT_EQ(s.x[i] == untouched, s.status[i] != QpStatus::solved) << name_of(level);
      if (s.status[i] == QpStatus::solved) {
        EXPECT_TRUE(s.x[i].allFinite());
      }
    }
  }
}

TEST(Simd, LevelsAreNamedAndOrdered) {
  const auto levels = available_simd_levels();
  ASSERT_FALSE(levels.empty());
  EXPECT_EQ(levels.front(), SimdLevel::scalar);
  EXPECT_TRUE(std::is_sorted(levels.begin(), levels.end()));
  EXPECT_EQ(name_of(SimdLevel::scalar), "scalar");
  EXPECT_EQ(name_of(SimdLevel::sse2), "sse2");
  EXPECT_EQ(name_of(SimdLevel::avx2), "avx2");
  EXPECT_EQ(name_of(SimdLevel::avx512), "avx512");
}

TEST(Simd, ANameChoosesALevelThatTheCpuHas) {
  EXPECT_EQ(parse_simd_level("scalar", SimdLevel::avx512), SimdLevel::scalar);
  EXPECT_EQ(parse_simd_level("sse2", SimdLevel::avx512), SimdLevel::sse2);
  EXPECT_EQ(parse_simd_level("avx2", SimdLevel::avx512), SimdLevel::avx2);
  EXPECT_EQ(parse_simd_level("avx512", SimdLevel::avx512), SimdLevel::avx512);
  EXPECT_EQ(parse_simd_level("avx512", SimdLevel::avx2), SimdLevel::avx2);
  EXPECT_EQ(parse_simd_level("avx2", SimdLevel::scalar), SimdLevel::scalar);
  for (const char* unknown : {"", "AVX2", "avx", "avx2 ", "neon"})
    EXPECT_EQ(parse_simd_level(unknown, SimdLevel::avx2), SimdLevel::avx2) << unknown;
}

// The level is read once: each value needs a process of its own.
TEST(Simd, TheEnvironmentChooses) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const SimdLevel best = available_simd_levels().back();
  for (const char* name : {"scalar", "sse2", "avx2", "avx512", "nonsense"}) {
    const auto expected = static_cast<int>(parse_simd_level(name, best));
    EXPECT_EXIT(
        {
          setenv("PRCAGE_SIMD", name, 1);
          const SimdLevel first = simd_level();
          setenv("PRCAGE_SIMD", "scalar", 1);
          std::exit(simd_level() == first ? static_cast<int>(first) : 77);
        },
        ::testing::ExitedWithCode(expected), "")
        << name;
  }
  EXPECT_EXIT(
      {
        unsetenv("PRCAGE_SIMD");
        std::exit(static_cast<int>(simd_level()));
      },
      ::testing::ExitedWithCode(static_cast<int>(best)), "");
}

}  // namespace
}  // namespace prcage
