// measure_cage() against cagecheck, an evaluator that shares no code with it, on cages of real meshes. Both draw
// samples, each its own, so that they agree up to the noise of the two.
#include <gtest/gtest.h>
#include <stdio.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/prcage.h"
#include "io/mesh_file.h"

namespace prcage {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t samples = 1000000;
constexpr double tau = 0.0125;  // half of the cage's own, so that there are violations

// What a shell command prints, nothing if it cannot be run.
std::string output_of(const std::string& command) {
  std::string output;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), &pclose);
  std::array<char, 4096> buffer;
  while (pipe && fgets(buffer.data(), buffer.size(), pipe.get()) != nullptr) output += buffer.data();
  return output;
}

class CagecheckRealMeshes : public ::testing::Test {
 protected:
  void SetUp() override {
    const fs::path build = fs::path(PRCAGE_SHARED_DIR) / "tools/build.sh";
    if (!fs::exists(build)) GTEST_SKIP() << "there is no " << build;
    std::string name = ::testing::TempDir() + "/prcage_cagecheck_XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    directory_ = name;
    const std::string log = output_of(fmt::format("sh '{}' '{}' 2>&1", build.string(), directory_.string()));
    if (!fs::exists(directory_ / "cagecheck")) GTEST_SKIP() << "cagecheck cannot be built: " << log;
  }
  void TearDown() override {
    if (!directory_.empty()) fs::remove_all(directory_);
  }

  static fs::path mesh(const std::string& name) { return fs::path(PRCAGE_SHARED_DIR) / "meshes" / (name + ".ply"); }

  static Mesh read(const std::string& name) {
    MeshFile file = read_mesh(mesh(name).string());
    EXPECT_TRUE(file.ok) << file.error;
    return std::move(file.mesh);
  }

  json cagecheck(const std::string& name, const Mesh& cage) const {
    const std::string path = directory_ / "cage.ply";
    EXPECT_TRUE(write_mesh(path, MeshFormat::ply_binary, cage).ok);
    return json::parse(
        output_of(fmt::format("'{}' '{}' '{}' --tau {} --samples {} --no-input-si", (directory_ / "cagecheck").string(),
                              mesh(name).string(), path, tau, samples)));
  }

 private:
  fs::path directory_;
};

void expect_same_conditions(const CageMeasures& measures, const json& expected) {
  const PaperConditions conditions = paper_conditions(measures.certificate);
  EXPECT_EQ(conditions.success(), expected["valid"].get<bool>());
  EXPECT_EQ(conditions.self_intersection_free, expected["self_intersection_free"].get<bool>());
  EXPECT_EQ(conditions.manifold, expected["manifold"].get<bool>());
  EXPECT_EQ(conditions.strictly_encloses, expected["strictly_enclosing"].get<bool>());
  EXPECT_EQ(conditions.topology_equal, expected["euler_equal"].get<bool>());
}

// Largest distances are lower bounds, found at samples `spacing` apart (relative to l): between them there may be more.
void expect_agreement(const CageMeasures& measures, const json& expected, double spacing) {
  ASSERT_EQ(measures.status, Status::ok) << measures.message;
  const auto value = [&](const char* key) { return expected[key].get<double>(); };
  const auto expect_distance = [&](double found, const char* key) {
    EXPECT_NEAR(found, value(key), 0.02 * value(key) + spacing) << key;
  };
  expect_distance(measures.hausdorff(), "hausdorff_rel");
  expect_distance(measures.cage_to_input.hausdorff, "hausdorff_cage_to_input_rel");
  expect_distance(measures.input_to_cage.hausdorff, "hausdorff_input_to_cage_rel");
  EXPECT_NEAR(measures.cage_to_input.normal_deviation, value("normal_deviation_mean_deg"), 0.1);
  EXPECT_NEAR(measures.input_to_cage.normal_deviation, value("normal_deviation_input_to_cage_mean_deg"), 0.1);
  EXPECT_NEAR(measures.violation->max, value("tau_violation_max_rel"), 0.02 * value("hausdorff_rel"));
  EXPECT_NEAR(measures.violation->fraction, value("tau_violation_area_fraction"), 0.002);
  EXPECT_NEAR(measures.volume_ratio.value(), value("volume_ratio"), 1e-8);
  EXPECT_NEAR(measures.area_ratio, value("area_ratio"), 1e-8);
  EXPECT_NEAR(measures.smallest_angle.min, value("min_angle_min_deg"), 1e-6);
  EXPECT_NEAR(measures.smallest_angle.fifth_percentile, value("min_angle_p5_deg"), 1e-6);
  EXPECT_NEAR(measures.smallest_angle.mean, value("min_angle_mean_deg"), 1e-6);
}

MeasureOptions options() {
  MeasureOptions options;
  options.samples = samples;
  options.tau = tau;
  return options;
}

// One test for all: building cagecheck takes longer than most of the comparisons.
TEST_F(CagecheckRealMeshes, SlowAgreesOnDistancesNormalsAndConditions) {
  for (const char* name : {"cad/tablet_stand", "cad/anchor", "multi/platonic_shelf", "thin/tube_knot",
                           "genus/three_holes", "organic/bunny"}) {
    SCOPED_TRACE(name);
    const Mesh input = read(name);
    const Result result = make_cage(input);
    ASSERT_TRUE(result.has_cage()) << result.message;
    const CageMeasures measures = measure_cage(input, result.cage, options());
    const json expected = cagecheck(name, result.cage);
    expect_same_conditions(measures, expected);
    const Validation& v = result.validation;
    expect_agreement(measures, expected, std::sqrt(v.area / samples) / v.diagonal);
  }
  // Runs through the input: no cage, and both know.
  const std::string name = "cad/joint";
  const Mesh input = read(name);
  Mesh narrower = input;
  for (auto& p : narrower.positions) p[0] *= 0.9;
  expect_same_conditions(measure_cage(input, narrower, options()), cagecheck(name, narrower));
}

}  // namespace
}  // namespace prcage
