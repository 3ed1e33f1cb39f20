// Never without a cage: vertices that no direction clears, sheets that nearly touch, faces without area, over many
// seeds. What comes out is certified from scratch.
#include <gtest/gtest.h>

#include <string>

#include "core/prcage.h"
#include "hard_meshes.h"

namespace prcage {
namespace {

using testing::degenerate_mesh;
using testing::narrow_mesh;
using testing::singular_mesh;

constexpr std::uint64_t seeds = 200;

void expect_certified(const Mesh& input, const Result& result) {
  ASSERT_EQ(result.status, Status::ok) << result.message;
  EXPECT_TRUE(certify(input, result.cage).valid());
  EXPECT_LE(result.cage.triangles.size(), input.triangles.size());
}

TEST(HardInputsSlow, SingularVertices) {
  std::size_t singular = 0, capped = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Mesh input = singular_mesh(seed);
    const Result result = make_cage(input);
    expect_certified(input, result);
    singular += result.statistics.singular_vertices;
    capped += result.statistics.capped_vertices;
  }
  EXPECT_GT(singular, seeds);
  EXPECT_GT(capped, seeds / 2);
}

// From wide gaps down to some thousand ulps of the coordinates.
TEST(HardInputsSlow, NarrowGaps) {
  std::size_t halved = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const double gap = std::pow(10.0, -2 - 10 * static_cast<double>(seed) / seeds);
    SCOPED_TRACE("seed " + std::to_string(seed) + " gap " + std::to_string(gap));
    const Mesh input = narrow_mesh(seed, gap);
    const Result result = make_cage(input);
    expect_certified(input, result);
    halved += result.statistics.halved_vertices > 0 ? 1 : 0;
  }
  EXPECT_GT(halved, seeds / 2);
}

// Where doubles leave no room, the message says where; nothing else may happen.
TEST(HardInputsSlow, GapsOfAFewUlps) {
  std::size_t without_cage = 0;
  constexpr std::uint64_t fewer = seeds / 4;  // those without room take long
  for (std::uint64_t seed = 1; seed <= fewer; ++seed) {
    const double gap = std::pow(10.0, -13 - 3 * static_cast<double>(seed) / fewer);
    SCOPED_TRACE("seed " + std::to_string(seed) + " gap " + std::to_string(gap));
    const Mesh input = narrow_mesh(seed, gap);
    const Result result = make_cage(input);
    if (result.status == Status::invalid_input) continue;  // rounding has closed the gap
    if (result.has_cage()) {
      expect_certified(input, result);
      continue;
    }
    ++without_cage;
    EXPECT_EQ(result.status, Status::displacement_failed);
    EXPECT_NE(result.message.find("near ("), std::string::npos) << result.message;
  }
  EXPECT_LT(without_cage, fewer);
}

TEST(HardInputsSlow, FacesWithHardlyAnyArea) {
  std::size_t removed = 0, legal = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Mesh input = degenerate_mesh(seed);
    if (!validate(input).valid()) continue;
    ++legal;
    const Result result = make_cage(input);
    removed += result.validation.degenerate_faces;
    expect_certified(input, result);
  }
  EXPECT_GT(legal, 9 * seeds / 10);
  EXPECT_GT(removed, seeds);
}

}  // namespace
}  // namespace prcage
