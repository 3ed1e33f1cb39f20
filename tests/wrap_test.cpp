// Cages round triangles of any kind, by way of a wrap. Enclosure is judged by solid angles at samples of every face,
// code of its own that knows nothing of wraps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/mesh_file.h"
#include "test_meshes.h"
#include "tools/exit_codes.h"
#include "tools/wrap/alpha_wrap.h"

namespace prcage {
namespace {

using ::testing::AllOf;
using testing::cube;
using ::testing::HasSubstr;
using testing::inside_out;
using testing::merge;
using testing::sphere;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Mesh random_triangles(std::size_t count, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  Mesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 centre(place(random), place(random), place(random));
    for (int corner = 0; corner < 3; ++corner)
      mesh.positions.push_back(position(centre + size * Vec3(place(random), place(random), place(random))));
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

// Faces whose centre the predicate holds for.
Mesh part(Mesh mesh, const std::function<bool(const Vec3&)>& keep) {
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return !keep((vec(mesh.positions[t[0]]) + vec(mesh.positions[t[1]]) + vec(mesh.positions[t[2]])) / 3);
  });
  return mesh;
}

Mesh open_scan() {
  return part(testing::shape("bumpy", 4000), [](const Vec3& x) { return x.y() > -0.9; });
}

bool usable(const Mesh& mesh, const Triangle& t) {
  return std::all_of(t.begin(), t.end(),
                     [&](std::uint32_t v) { return v < mesh.positions.size() && vec(mesh.positions[v]).allFinite(); });
}

// The cage winds once round every sample of every face.
void expect_inside(const Mesh& cage, const Mesh& input) {
  for (const Triangle& t : input.triangles) {
    if (!usable(input, t)) continue;
    testing::for_each_sample(testing::corners(input, t), 2,
                             [&](const Vec3& x) { ASSERT_EQ(testing::winding_number(cage, x), 1) << x.transpose(); });
  }
}

long long euler_characteristic(const Mesh& mesh) { return validate(mesh).euler_characteristic; }

Options quick() {
  Options options;
  options.cycles = 3;
  options.threads = 2;
  return options;
}

// ------------------------------------------------------------------------------- round any wrap, without CGAL

TEST(MakeCageAround, EnclosesTheTrianglesAndHasTheTopologyOfTheWrap) {
  const Mesh input = random_triangles(300, 0.3, 5);
  const Mesh wrap = sphere(4, 1.3);
  const Result r = make_cage_around(input, wrap, quick());
  ASSERT_EQ(r.status, Status::ok) << r.message;
  EXPECT_TRUE(r.certificate.valid());
  EXPECT_EQ(r.statistics.input_faces, 300u);
  EXPECT_EQ(r.validation.faces, wrap.triangles.size());
  EXPECT_EQ(euler_characteristic(r.cage), 2);
  EXPECT_LT(r.cage.triangles.size(), wrap.triangles.size() / 4);
  expect_inside(r.cage, input);
  EXPECT_TRUE(certify_around(input, wrap, r.cage).valid());
  EXPECT_FALSE(certify(input, r.cage).valid()) << "a soup is no solid with a topology of its own";
}

TEST(MakeCageAround, IsMakeCageOfTheWrap) {
  const Mesh wrap = testing::shape("bumpy", 2000);
  EXPECT_TRUE(
      testing::same(make_cage_around(random_triangles(9, 0.2, 1), wrap, quick()).cage, make_cage(wrap, quick()).cage));
}

TEST(MakeCageAround, CountsWhatItDrops) {
  Mesh input = cube();
  input.positions.insert(input.positions.end(), {{nan, 0, 0}, {0, 1e300, 0}, {0, 0, 0}, {9, 9, 9}});
  input.triangles.insert(input.triangles.end(), {{0, 1, 8}, {0, 1, 9}, {0, 1, 99}, {0, 7, 10}, {11, 11, 0}, {0, 0, 0}});
  const Result r = make_cage_around(input, cube(2), quick());
  ASSERT_EQ(r.status, Status::ok) << r.message;
  EXPECT_EQ(r.statistics.dropped.not_finite, 2u);
  EXPECT_EQ(r.statistics.dropped.index_out_of_range, 1u);
  EXPECT_EQ(r.statistics.dropped.no_area, 3u);
  EXPECT_EQ(r.statistics.dropped.total(), 6u);
}

TEST(MakeCageAround, RefusesAnInputWithoutUsableFaces) {
  Mesh input = cube();
  for (Position& p : input.positions) p[2] = nan;
  for (const Mesh& nothing : {input, Mesh{}, Mesh{{{0, 0, 0}}, {{0, 0, 0}}}, testing::scaled(cube(), 1e-70)}) {
    const Result r = make_cage_around(nothing, cube(2), quick());
    EXPECT_EQ(r.status, Status::invalid_input);
    EXPECT_THAT(r.message, HasSubstr("the input "));
    EXPECT_FALSE(r.has_cage());
  }
}

TEST(MakeCageAround, RefusesAWrapThatIsNoLegalMesh) {
  Mesh open = cube(2);
  open.triangles.pop_back();
  const Result r = make_cage_around(cube(), open, quick());
  EXPECT_EQ(r.status, Status::invalid_input);
  EXPECT_THAT(r.message, HasSubstr("the wrap "));
  EXPECT_FALSE(r.validation.valid());
}

// The promise is checked, not taken from the caller.
TEST(MakeCageAround, RefusesAWrapThatDoesNotEnclose) {
  for (const Mesh& input : {cube(20), cube(1, {9, 0, 0}), merge(cube(), cube(1, {0, 9, 0}))}) {
    const Result r = make_cage_around(input, sphere(3, 2), quick());
    EXPECT_EQ(r.status, Status::certificate_failed);
    EXPECT_FALSE(r.certificate.encloses);
    EXPECT_TRUE(r.cage.triangles.empty());
  }
}

TEST(CertifyAround, EveryComponentOfTrianglesMustBeInside) {
  const Mesh wrap = cube(4);
  const Mesh cage = cube(5);
  Mesh triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  EXPECT_TRUE(certify_around(triangle, wrap, cage).valid());
  const Mesh crossing = merge(triangle, {{{0, 0, 0}, {3, 0, 0}, {0, 1, 1}}, {{0, 1, 2}}});
  EXPECT_EQ(certify_around(crossing, wrap, cage).contacts, 2u) << "the two faces of the cage at one corner or edge";
  const Mesh outside = merge(triangle, testing::moved(triangle, {0, 0, 9}));
  EXPECT_TRUE(certify_around(outside, wrap, cage).no_contact);
  EXPECT_FALSE(certify_around(outside, wrap, cage).encloses);
}

TEST(CertifyAround, ATriangleInACavityOfTheCageIsNotInside) {
  const Mesh hollow = merge(cube(9), inside_out(cube(3)));
  const Mesh triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  EXPECT_FALSE(certify_around(triangle, hollow, hollow).encloses);
  EXPECT_TRUE(certify_around(testing::moved(triangle, {3, 0, 0}), hollow, hollow).valid());
  // A closed input has a solid: no part of the cage may lie within that.
  EXPECT_FALSE(certify_around(cube(6), hollow, hollow).encloses);
}

TEST(CertifyAround, TheTopologyIsThatOfTheWrap) {
  const Mesh input = random_triangles(20, 0.1, 3);
  const Mesh cage = cube(5);
  EXPECT_TRUE(certify_around(input, sphere(1, 2), cage).valid());
  EXPECT_FALSE(certify_around(input, testing::torus(), cage).euler_characteristic_equal);
  EXPECT_FALSE(certify_around(input, merge(cube(), cube(1, {9, 0, 0})), cage).component_count_equal);
  EXPECT_FALSE(certify_around(Mesh{}, cage, cage).valid());
  EXPECT_FALSE(certify_around(input, Mesh{}, cage).valid());
}

// ------------------------------------------------------------------------------------------------ alpha wraps

class AlphaWrap : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_alpha_wrap()) GTEST_SKIP() << missing_alpha_wrap;
  }
};

Result cage_of_wrap(const Mesh& input, const WrapSettings& settings = {}) {
  const Wrap wrap = alpha_wrap(input, settings);
  EXPECT_EQ(wrap.status, Status::ok) << wrap.message;
  return make_cage_around(input, wrap.mesh, quick());
}

void expect_cage_of_wrap(const Mesh& input, const WrapSettings& settings = {}) {
  const Result r = cage_of_wrap(input, settings);
  ASSERT_EQ(r.status, Status::ok) << r.message;
  EXPECT_TRUE(r.certificate.valid());
  expect_inside(r.cage, input);
}

TEST_F(AlphaWrap, OfAnOpenScanClosesIt) {
  const Mesh scan =
      part(testing::shape("bumpy", 4000), [](const Vec3& x) { return (x - Vec3(0, -1, 0)).norm() > 0.12; });
  ASSERT_LT(scan.triangles.size(), testing::shape("bumpy", 4000).triangles.size());
  const Result r = cage_of_wrap(scan);
  ASSERT_EQ(r.status, Status::ok) << r.message;
  expect_inside(r.cage, scan);
  EXPECT_EQ(testing::winding_number(r.cage, Vec3::Zero()), 1) << "the hole is closed, the hollow is inside";
  EXPECT_EQ(euler_characteristic(r.cage), 2);
}

TEST_F(AlphaWrap, OfAWideOpenScanIsAShell) { expect_cage_of_wrap(open_scan(), {0.02, 0.002}); }

TEST_F(AlphaWrap, OfOverlappingParts) {
  expect_cage_of_wrap(merge(sphere(3), sphere(3, 0.8, {0.7, 0.1, 0})));
  expect_cage_of_wrap(merge(cube(), cube(1, {1, 0.5, 0.25})));  // touching
}

TEST_F(AlphaWrap, OfDoubledAndTurnedFaces) {
  Mesh mesh = sphere(3);
  const auto faces = mesh.triangles;
  mesh.triangles.insert(mesh.triangles.end(), faces.begin(), faces.begin() + 100);
  for (std::size_t i = 0; i < faces.size(); i += 7) std::swap(mesh.triangles[i][0], mesh.triangles[i][1]);
  expect_cage_of_wrap(mesh);
}

TEST_F(AlphaWrap, OfFacesWithoutPlaceOrArea) {
  Mesh mesh = sphere(3);
  mesh.positions[7][1] = nan;
  mesh.positions[9][1] = std::numeric_limits<double>::infinity();
  mesh.triangles.push_back({3, 3, 4});
  mesh.triangles.push_back({3, 4, 4000000000});
  const Wrap wrap = alpha_wrap(mesh, {});
  ASSERT_EQ(wrap.status, Status::ok) << wrap.message;
  EXPECT_GT(wrap.dropped.not_finite, 6u);
  EXPECT_EQ(wrap.dropped.index_out_of_range, 1u);
  EXPECT_EQ(wrap.dropped.no_area, 1u);
  mesh.triangles.resize(mesh.triangles.size() - 2);
  expect_cage_of_wrap(mesh);
}

TEST_F(AlphaWrap, OfSoups) {
  for (unsigned seed = 1; seed <= 5; ++seed) expect_cage_of_wrap(random_triangles(40, 0.4, seed));
  expect_cage_of_wrap(random_triangles(1, 1, 1));  // one triangle
}

TEST_F(AlphaWrap, OfAFlatSheet) {
  expect_cage_of_wrap({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}});
}

TEST_F(AlphaWrap, OfAnyScaleAndPlace) {
  const Mesh scan = part(sphere(3), [](const Vec3& x) { return x.y() < 0.9; });
  for (const double factor : {1e-40, 1e-6, 1e12}) expect_cage_of_wrap(testing::scaled(scan, factor));
  expect_cage_of_wrap(testing::moved(scan, {5e5, -4e6, 100}));
}

TEST_F(AlphaWrap, RefusesWhatDrownsInTheLastBits) {
  const Wrap wrap = alpha_wrap(testing::moved(sphere(2), {1e12, 0, 0}), {});
  EXPECT_EQ(wrap.status, Status::invalid_input);
  EXPECT_THAT(wrap.message, HasSubstr("too far from the origin"));
  EXPECT_TRUE(wrap.mesh.triangles.empty());
}

TEST_F(AlphaWrap, ClosesTunnelsThatABallOfRadiusAlphaCannotPass) {
  const Mesh torus = testing::torus(96, 48, 1, 0.8);  // the hole has a radius of 0.2, l is 5.3
  ASSERT_EQ(euler_characteristic(torus), 0);
  const Result closed = cage_of_wrap(torus, {0.06, topology_offset});
  ASSERT_EQ(closed.status, Status::ok) << closed.message;
  EXPECT_EQ(euler_characteristic(closed.cage), 2);
  EXPECT_EQ(closed.certificate.euler_characteristic, 2);
  expect_inside(closed.cage, torus);
  const Result kept = cage_of_wrap(torus, {0.02, topology_offset});
  ASSERT_EQ(kept.status, Status::ok) << kept.message;
  EXPECT_EQ(euler_characteristic(kept.cage), 0);
  expect_inside(kept.cage, torus);
}

TEST_F(AlphaWrap, ChoosesAlphaByTheBoundary) {
  EXPECT_EQ(alpha_wrap(sphere(2), {}).settings.alpha, closed_alpha);
  EXPECT_EQ(alpha_wrap(part(sphere(2), [](const Vec3& x) { return x.y() < 0.8; }), {}).settings.alpha, open_alpha);
  EXPECT_EQ(alpha_wrap(sphere(2), {0.03, 0.01}).settings.alpha, 0.03);
  // Neither unshared vertices nor a crack that a face without area closes are a boundary.
  Mesh unwelded = cube();
  for (Triangle& t : unwelded.triangles)
    for (std::uint32_t& v : t) {
      unwelded.positions.push_back(Position(unwelded.positions[v]));
      v = static_cast<std::uint32_t>(unwelded.positions.size() - 1);
    }
  EXPECT_EQ(alpha_wrap(unwelded, {}).settings.alpha, closed_alpha);
  Mesh cracked = cube();
  const auto [a, b, c] = cracked.triangles[0];
  cracked.positions.push_back(position((vec(cracked.positions[a]) + vec(cracked.positions[b])) / 2));
  cracked.triangles[0] = {a, 8, c};
  cracked.triangles.insert(cracked.triangles.end(), {{8, b, c}, {a, b, 8}});
  EXPECT_EQ(alpha_wrap(cracked, {}).settings.alpha, closed_alpha);
}

TEST_F(AlphaWrap, IsTheSameEachTime) {
  const Mesh input = random_triangles(60, 0.3, 2);
  const Wrap first = alpha_wrap(input, {});
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(testing::same(alpha_wrap(input, {}).mesh, first.mesh));
}

TEST_F(AlphaWrap, CanBeCancelled) {
  Control control;
  control.cancel();
  const Wrap wrap = alpha_wrap(sphere(3), {}, &control);
  EXPECT_EQ(wrap.status, Status::cancelled);
  EXPECT_TRUE(wrap.mesh.triangles.empty());
  EXPECT_EQ(control.stage(), Control::Stage::start);
}

TEST_F(AlphaWrap, RefusesSettingsOutOfRange) {
  for (const WrapSettings& settings : {WrapSettings{-1, 0.1}, {1.1, 0.1}, {nan, 0.1}, {0.1, 0}, {0.1, 2}, {0.1, nan}})
    EXPECT_EQ(alpha_wrap(cube(), settings).status, Status::invalid_options);
}

class WrapRealMeshes : public AlphaWrap, public ::testing::WithParamInterface<const char*> {};

TEST_P(WrapRealMeshes, ThatAreNoLegalInputHaveCages) {
  const std::string path = std::string(PRCAGE_SHARED_DIR) + "/meshes/invalid/" + GetParam() + ".ply";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "there is no " << path;
  const MeshFile file = read_mesh(path);
  ASSERT_TRUE(file.ok) << file.error;
  const Wrap wrap = alpha_wrap(file.mesh, {});
  ASSERT_EQ(wrap.status, Status::ok) << wrap.message;
  const Result r = make_cage_around(file.mesh, wrap.mesh, quick());
  EXPECT_EQ(r.status, Status::ok) << r.message;
  EXPECT_TRUE(certify_around(file.mesh, wrap.mesh, r.cage).valid());
}

INSTANTIATE_TEST_SUITE_P(Invalid, WrapRealMeshes,
                         ::testing::Values("degenerate_faces_doors", "inconsistent_hourglass", "inside_out_ellipsoid",
                                           "many_holes_elephant", "nonmanifold_edge_motor_mount",
                                           "nonmanifold_edges_raspberry_cover", "nonmanifold_vertices_actuator",
                                           "open_bunny", "overlapping_components_rabbit", "overlapping_shells_idler",
                                           "quads_fandisk", "self_intersecting_camel", "unwelded_capsule"),
                         [](const auto& tested) { return std::string(tested.param); });

// ------------------------------------------------------------------------------------------------ the program

#ifdef PRCAGE_PROGRAM

// In a directory of its own, which is removed afterwards.
class WrapCli : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = ::testing::TempDir() + "/prcage_wrap_XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    directory_ = name;
    ASSERT_TRUE(write_mesh(path("scan.ply"), MeshFormat::ply_binary, open_scan()).ok);
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  std::string path(const std::string& name) const { return directory_ + "/" + name; }

  std::string contents(const std::string& name) const {
    std::ifstream file(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  // In that directory, so that file names need no path; the two streams go to files.
  ExitCode run(const std::string& program, const std::string& arguments) const {
    const std::string command = "cd '" + directory_ + "' && '" + program + "' " + arguments + " >out 2>err";
    return static_cast<ExitCode>(WEXITSTATUS(std::system(command.c_str())));
  }

 private:
  std::string directory_;
};

TEST_F(WrapCli, TheHelpDocumentsTheOptions) {
  ASSERT_EQ(run(PRCAGE_PROGRAM, "help cage"), ExitCode::ok);
  for (const char* option : {"--wrap ", "--wrap-alpha", "--wrap-offset", "--wrap-output", "--simplify-topology"})
    EXPECT_THAT(contents("out"), HasSubstr(option));
}

TEST_F(WrapCli, ARefusalNamesTheOption) {
  EXPECT_EQ(run(PRCAGE_PROGRAM, "cage scan.ply -o cage.ply"), ExitCode::invalid_mesh);
  EXPECT_THAT(contents("err"), AllOf(HasSubstr("boundary edges"), HasSubstr("--wrap cages an alpha wrap")));
}

TEST_F(WrapCli, TheWrapIsCagedAndReported) {
  if (!has_alpha_wrap()) GTEST_SKIP() << missing_alpha_wrap;
  ASSERT_EQ(run(PRCAGE_PROGRAM, "cage scan.ply -o cage.ply --wrap --wrap-output wrap.off --stats s.json"),
            ExitCode::ok);
  const MeshFile wrap = read_mesh(path("wrap.off"));
  EXPECT_TRUE(validate(wrap.mesh).valid());
  expect_inside(read_mesh(path("cage.ply")).mesh, open_scan());
  EXPECT_THAT(contents("err"), AllOf(HasSubstr("alpha 0.05 and offset 0.00167 of the diagonal"),
                                     HasSubstr("from the wrap"), HasSubstr("wrap's Euler characteristic  yes")));
  const auto stats = nlohmann::json::parse(contents("s.json"));
  EXPECT_EQ(stats["wrap"]["faces"], wrap.mesh.triangles.size());
  EXPECT_EQ(stats["options"]["wrap"]["alpha"], open_alpha);
  EXPECT_GT(stats["wrap"]["seconds"], 0);
  EXPECT_EQ(stats["certificate"]["valid"], true);
  EXPECT_EQ(run(PRCAGE_PROGRAM, "check scan.ply --cage cage.ply --wrap wrap.off"), ExitCode::ok);
  EXPECT_EQ(run(PRCAGE_PROGRAM, "check scan.ply --cage cage.ply"), ExitCode::no_cage);
  EXPECT_EQ(run(PRCAGE_PROGRAM, "check scan.ply --cage wrap.off --wrap cage.ply"), ExitCode::ok);
  EXPECT_EQ(run(PRCAGE_PROGRAM, "check cage.ply --cage wrap.off --wrap wrap.off"), ExitCode::no_cage);
}

TEST_F(WrapCli, WhatCannotBeWrappedIsSaid) {
  if (!has_alpha_wrap()) GTEST_SKIP() << missing_alpha_wrap;
  ASSERT_TRUE(write_mesh(path("point.off"), MeshFormat::off, {{{0, 0, 0}}, {{0, 0, 0}}}).ok);
  EXPECT_EQ(run(PRCAGE_PROGRAM, "cage point.off -o cage.ply --wrap"), ExitCode::invalid_mesh);
  EXPECT_THAT(contents("err"), HasSubstr("no face with an area"));
  EXPECT_FALSE(std::filesystem::exists(path("cage.ply")));
}

TEST_F(WrapCli, HandlesAreRemoved) {
  if (!has_alpha_wrap()) GTEST_SKIP() << missing_alpha_wrap;
  const Mesh bracket = testing::shape("bracket", 2000);
  ASSERT_LT(euler_characteristic(bracket), 2);
  ASSERT_TRUE(write_mesh(path("bracket.ply"), MeshFormat::ply_binary, bracket).ok);
  ASSERT_EQ(run(PRCAGE_PROGRAM, "cage bracket.ply -o cage.ply --simplify-topology 1/4"), ExitCode::ok);
  const Mesh cage = read_mesh(path("cage.ply")).mesh;
  EXPECT_EQ(euler_characteristic(cage), 2);
  expect_inside(cage, bracket);
}

TEST_F(WrapCli, OptionsThatContradictEachOtherAreUsageErrors) {
  for (const char* options :
       {"--wrap --simplify-topology 0.1", "--wrap-alpha 0.1", "--wrap-offset 0.1", "--wrap-output w.ply",
        "--wrap --wrap-alpha 0", "--wrap --wrap-alpha 2", "--simplify-topology 0", "--wrap=yes"}) {
    EXPECT_EQ(run(PRCAGE_PROGRAM, std::string("cage scan.ply -o cage.ply ") + options), ExitCode::usage) << options;
  }
  EXPECT_EQ(run(PRCAGE_PROGRAM, "check scan.ply --wrap scan.ply"), ExitCode::usage);
}

TEST_F(WrapCli, WithoutTheComponentTheOptionsSayHowToGetIt) {
  for (const char* option : {"--wrap", "--simplify-topology 0.1"}) {
    EXPECT_EQ(run(PRCAGE_PROGRAM_NO_WRAP, std::string("cage scan.ply -o cage.ply ") + option), ExitCode::usage);
    EXPECT_THAT(contents("err"), AllOf(HasSubstr("built without"), HasSubstr("libcgal-dev"),
                                       HasSubstr("PRCAGE_WITH_ALPHA_WRAP=ON"), HasSubstr("GPL")));
  }
  EXPECT_FALSE(std::filesystem::exists(path("cage.ply")));
}

TEST_F(WrapCli, TheVersionSaysWhichLicenceTheProgramIsUnder) {
  ASSERT_EQ(run(PRCAGE_PROGRAM_NO_WRAP, "--version"), ExitCode::ok);
  EXPECT_THAT(contents("out"), HasSubstr("Nothing that it links requires the GPL"));
  ASSERT_EQ(run(PRCAGE_PROGRAM, "--version"), ExitCode::ok);
  const char* licence = has_alpha_wrap() ? "GPL-3.0-or-later as a whole" : "Nothing that it links requires the GPL";
  EXPECT_THAT(contents("out"), HasSubstr(licence));
}

#endif

}  // namespace
}  // namespace prcage
