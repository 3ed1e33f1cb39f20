// The data of the report's page: which rows and models it gets, what its arrays hold, and the command itself. How the
// page shows them is tested in a browser, see report_page/.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/mesh_file.h"
#include "program.h"
#include "solids.h"
#include "tools/batch_table.h"
#include "tools/page_model.h"
#include "tools/page_table.h"
#include "tools/page_template.h"

namespace prcage {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;
using Json = PageTable::Json;

class Page : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = ::testing::TempDir() + "/prcage_page_XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    directory_ = fs::canonical(name);
  }
  void TearDown() override { fs::remove_all(directory_); }

  std::string path(const std::string& name) const { return directory_ / name; }

  std::string mesh(const std::string& name, const Mesh& mesh) const {
    EXPECT_TRUE(write_mesh(path(name), MeshFormat::ply_binary, mesh).ok);
    return path(name);
  }

  static BatchRow made(const std::string& mesh, double seconds, double hausdorff) {
    BatchRow row;
    row.set("mesh", mesh);
    row.set("settings", std::string("--tau 0.025"));
    row.set("status", std::string("ok"));
    row.set("seconds", seconds);
    row.set("hausdorff_rel", hausdorff);
    return row;
  }

  static BatchRow failed(const std::string& mesh) {
    BatchRow row;
    row.set("mesh", mesh);
    row.set("settings", std::string("--tau 0.025"));
    row.set("status", std::string("timeout"));
    row.set("cause", std::string("timeout"));
    return row;
  }

  void put(const std::vector<BatchRow>& rows) const {
    BatchTable table(path("batch.sqlite"), BatchTable::Open::or_create);
    table.atomically([&] {
      for (const BatchRow& row : rows) table.put(row);
    });
  }

  PageTable table() const { return PageTable(BatchTable(path("batch.sqlite"), BatchTable::Open::read_only)); }

  static std::vector<std::string> names(const Json& json) { return json["columns"]["mesh"]; }

  int report(const std::vector<std::string>& options = {}) const {
    std::vector<std::string> arguments{"report", path("batch.sqlite"), "-o", path("page.html")};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return Process(arguments, "/dev/null", path("stdout"), path("stderr")).wait();
  }
  std::string errors() const { return contents(path("stderr")); }

 private:
  fs::path directory_;
};

// --------------------------------------------------------------------------------------------------- rows

TEST_F(Page, WorstModelsComeByTurnsFromEachRankingThenInTheOrderOfTheTable) {
  put({made("a", 1, 0.01), made("b", 2, 0.09), made("c", 9, 0.02), failed("d"), made("e", 8, 0.03), made("f", 1, 0)});
  const PageTable rows = table();
  // The largest distance, the longest time, the failure; the second ones; then what no ranking holds before others.
  EXPECT_THAT(rows.worst(4), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(rows.worst(100), ElementsAre(1, 2, 3, 4, 0, 5));
  EXPECT_THAT(rows.worst(0), SizeIs(0));
}

TEST_F(Page, EachSettingsHaveTheirOwnWorst) {
  BatchRow tighter = made("a", 1, 0.001);
  tighter.set("settings", std::string("--tau 0.0125"));
  put({made("a", 1, 0.01), made("b", 2, 0.09), tighter});
  const PageTable rows = table();
  EXPECT_THAT(rows.worst(2), ElementsAre(0, 2));
  EXPECT_EQ(rows.row(0).settings, "--tau 0.0125");
}

TEST_F(Page, CountsAreOfAllRowsWhenThePageHoldsAChoice) {
  std::vector<BatchRow> all;
  for (int i = 0; i < 900; ++i) all.push_back(made(fmt::format("m{:03}", i), 1 + i, 0.01));
  for (int i = 0; i < 100; ++i) all.push_back(failed(fmt::format("x{:02}", i)));
  put(all);
  const PageTable rows = table();
  std::vector<std::size_t> wanted{500, 3};
  const Json json = rows.json(wanted, 100);
  const std::vector<std::string> kept = names(json);
  EXPECT_GE(kept.size(), 100u);
  EXPECT_LE(kept.size(), 160u) << "beside the choice only those that are wanted and the worst";
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  EXPECT_EQ(kept[wanted[0]], "m500");
  EXPECT_EQ(kept[wanted[1]], "m003");
  EXPECT_THAT(kept, Contains("m899")) << "the slowest";
  EXPECT_EQ(json["total_rows"], 1000);
  EXPECT_EQ(json["counts"].dump(),
            R"([{"settings":0,"status":"ok","cause":"","has_cage":true,"count":900},)"
            R"({"settings":0,"status":"timeout","cause":"timeout","has_cage":false,"count":100}])");
}

TEST_F(Page, AChoiceIsEven) {
  std::vector<BatchRow> all;
  for (int i = 0; i < 1000; ++i) all.push_back(made(fmt::format("m{:03}", i), 0, 0));  // no ranking
  put(all);
  std::vector<std::size_t> wanted;
  const std::vector<std::string> kept = names(table().json(wanted, 100));
  ASSERT_EQ(kept.size(), 100u);
  for (std::size_t i = 0; i < kept.size(); ++i) EXPECT_EQ(kept[i], fmt::format("m{:03}", 10 * i));
}

TEST_F(Page, EveryColumnHasAValueForEveryRow) {
  put({made("a", 1, 0.0123456789), failed("b")});
  std::vector<std::size_t> wanted;
  const Json columns = table().json(wanted)["columns"];
  for (const auto& [name, values] : columns.items()) EXPECT_EQ(values.size(), 2u) << name;
  EXPECT_EQ(columns["hausdorff_rel"].dump(), "[0.0123457,null]");
  EXPECT_EQ(columns["has_cage"].dump(), "[1,0]");
}

// ------------------------------------------------------------------------------------------------- models

// The arrays of a model, read as the page does.
class Arrays {
 public:
  explicit Arrays(std::string bytes) : bytes_(std::move(bytes)) {}
  std::size_t take_8() { return static_cast<unsigned char>(bytes_.at(place_++)); }
  std::size_t take_16() {
    const std::size_t low = take_8();
    return low + 256 * take_8();
  }
  std::vector<std::size_t> take_16(std::size_t count) {
    std::vector<std::size_t> all(count);
    for (std::size_t& value : all) value = take_16();
    return all;
  }
  bool at_end() const { return place_ == bytes_.size(); }

 private:
  std::string bytes_;
  std::size_t place_ = 0;
};

TEST_F(Page, ModelHoldsBothMeshesAndDistancesAllOverTheCage) {
  // From a cube of edge 1 to one of edge 2: half at the middle of a face, most at a corner.
  const PageModel model = page_model(mesh("in.ply", testing::cube(1)), mesh("cage.ply", testing::cube(2)));
  ASSERT_EQ(model.error, "");
  const double largest = std::sqrt(0.75);
  EXPECT_DOUBLE_EQ(model.contents["largest_distance"], largest);
  EXPECT_EQ(model.contents["cube"].dump(), R"({"lower":[-1.0,-1.0,-1.0],"size":2.0})");
  EXPECT_EQ(model.contents["input"].dump(), R"({"vertices":8,"faces":12,"faces_of_file":12})");

  Arrays arrays(model.bytes);
  EXPECT_THAT(arrays.take_16(24), Each(::testing::AnyOf(16384, 49151))) << "a quarter and three of the cube's size";
  EXPECT_THAT(arrays.take_16(36), Each(::testing::Lt(8u)));
  EXPECT_THAT(arrays.take_16(24), Each(::testing::AnyOf(0, 65535)));
  EXPECT_THAT(arrays.take_16(36), Each(::testing::Lt(8u)));
  const std::vector<std::size_t> distances = arrays.take_16(model.contents["cage"]["points"]);
  const auto [least, most] = std::minmax_element(distances.begin(), distances.end());
  EXPECT_EQ(*most, 65535u);
  EXPECT_NEAR(static_cast<double>(*least), 65535 * 0.5 / largest, 1);
  std::size_t points = 0;
  for (int f = 0; f < 12; ++f) {
    const std::size_t parts = arrays.take_8();
    EXPECT_GT(parts, 10u) << "large faces are cut";
    points += (parts + 1) * (parts + 2) / 2;
  }
  EXPECT_EQ(points, distances.size());
  EXPECT_TRUE(arrays.at_end());
}

TEST_F(Page, LargeInputIsSimplifiedAndDistancesAreThoseToAllOfIt) {
  const Mesh sphere = testing::sphere(6);  // 32768 faces
  const PageModel model = page_model(mesh("in.ply", sphere), mesh("cage.ply", testing::cube(4)));
  ASSERT_EQ(model.error, "");
  EXPECT_EQ(model.contents["input"]["faces_of_file"], sphere.triangles.size());
  EXPECT_LE(model.contents["input"]["faces"], page_faces);
  EXPECT_GE(model.contents["input"]["faces"], page_faces / 2);
  EXPECT_NEAR(model.contents["largest_distance"], std::sqrt(12.0) - 1, 1e-3);
}

TEST_F(Page, ModelWithoutACageHasTheInputAlone) {
  const PageModel model = page_model(mesh("in.ply", testing::cube()), "");
  EXPECT_EQ(model.error, "");
  EXPECT_FALSE(model.contents.contains("cage"));
  EXPECT_EQ(model.bytes.size(), 2u * (24 + 36));
}

TEST_F(Page, ModelThatCannotBeShownSaysWhy) {
  const std::string cube = mesh("cube.ply", testing::cube());
  EXPECT_THAT(page_model(path("nowhere.ply"), "").error, HasSubstr("nowhere.ply"));
  EXPECT_THAT(page_model(cube, path("nowhere.ply")).error, HasSubstr("nowhere.ply"));
  EXPECT_THAT(page_model(cube, mesh("large.ply", testing::sphere(6))).error, HasSubstr("32768 faces, more than 20000"));
  std::ofstream(path("bad.off")) << "OFF\n3 1 0\n0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n";
  EXPECT_THAT(page_model(path("bad.off"), "").error, HasSubstr("bad.off"));
}

TEST(Base64, IsThatOfTheStandard) {  // RFC 4648, section 10, where nothing is padded
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
  EXPECT_EQ(base64("fo"), "Zm8A") << "filled up by a zero";
}

// ------------------------------------------------------------------------------------------------ command

class ReportCommand : public Page {
 protected:
  void SetUp() override {
    Page::SetUp();
    put({made("a", 1, 0.01), made("</script><!--", 1, 0.01), made("\xff\xfe", 1, 0.01), failed("b")});
    if (page_template().empty()) GTEST_SKIP() << "built without the page of the report";
  }
};

TEST_F(ReportCommand, WritesOneFileAndLeavesTheTableAlone) {
  const std::string before = contents(path("batch.sqlite"));
  ASSERT_EQ(report({"--title", "A & B"}), code(ExitCode::ok)) << errors();
  EXPECT_EQ(contents(path("batch.sqlite")), before);
  std::set<std::string> files;
  for (const auto& entry : fs::directory_iterator(path(""))) files.insert(entry.path().filename());
  EXPECT_THAT(files, ElementsAre("batch.sqlite", "page.html", "stderr", "stdout"));
  EXPECT_EQ(errors(), "");
}

TEST_F(ReportCommand, NoNameCanEndTheData) {
  ASSERT_EQ(report(), code(ExitCode::ok)) << errors();
  const std::string page = contents(path("page.html"));
  EXPECT_THAT(page, AllOf(HasSubstr("\\u003c/script>\\u003c!--"), Not(HasSubstr("\"</script><!--"))));
}

TEST_F(ReportCommand, ThePageIsTheSameForTheSameTable) {
  ASSERT_EQ(report(), code(ExitCode::ok)) << errors();
  const std::string first = contents(path("page.html"));
  ASSERT_EQ(report(), code(ExitCode::ok)) << errors();
  EXPECT_TRUE(contents(path("page.html")) == first);
}

TEST_F(ReportCommand, WhatCannotBeReadOrWrittenIsRefused) {
  std::ofstream(path("batch.sqlite")) << "no table";
  EXPECT_EQ(report(), code(ExitCode::cannot_read));
  EXPECT_THAT(errors(), HasSubstr("batch.sqlite"));
  fs::remove(path("batch.sqlite"));
  EXPECT_EQ(report(), code(ExitCode::cannot_read));
  EXPECT_FALSE(fs::exists(path("batch.sqlite")));
  EXPECT_FALSE(fs::exists(path("page.html")));
  EXPECT_EQ(report({"-o", path("no/such/directory.html")}), code(ExitCode::usage)) << "given twice";
  EXPECT_EQ(report({"--models", "-1"}), code(ExitCode::usage));
}

TEST_F(Page, AProgramWithoutThePageSaysHowToGetIt) {
  if (!page_template().empty()) GTEST_SKIP() << "built with the page of the report";
  put({made("a", 1, 0.01)});
  EXPECT_EQ(report(), code(ExitCode::usage));
  EXPECT_THAT(errors(), HasSubstr("PRCAGE_BUILD_REPORT_PAGE"));
}

}  // namespace
}  // namespace prcage
