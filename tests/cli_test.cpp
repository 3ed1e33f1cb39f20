// The program as people and scripts use it: run as a process, judged by its exit code, its two output streams and
// the files that it leaves.
#include <png.h>

#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/prcage.h"
#include "core/schedule.h"
#include "io/mesh_file.h"
#include "program.h"
#include "tools/cli_files.h"
#include "tools/cli_option_kinds.h"
#include "tools/cli_options.h"
#include "tools/exit_codes.h"
#include "tools/report_measures.h"
#include "tools/scale_bar.h"
#include "tools/shapes.h"

namespace prcage {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

struct Outcome {
  int code = 0;
  std::string out;
  std::string err;
};

// Cube with the corners 0 and 1: 12 faces, counterclockwise seen from outside.
Mesh cube() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.push_back(
        {static_cast<double>(i & 1), static_cast<double>(i >> 1 & 1), static_cast<double>(i >> 2)});
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

// A built-in shape, larger by a factor.
Mesh shape_of(const std::string& name, std::size_t faces, double scale) {
  std::string error;
  Mesh mesh = make_shape(name, faces, 0, error);
  for (auto& p : mesh.positions) {
    for (double& x : p) x *= scale;
  }
  return mesh;
}

// Each test in a directory of its own, which is removed afterwards.
class Cli : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = testing::TempDir() + "/prcage_cli_XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    directory_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  std::string path(const std::string& name) const { return directory_ + "/" + name; }

  // Writes a mesh under a name whose extension says the format.
  std::string file(const std::string& name, const Mesh& mesh) const {
    MeshFormat format{};
    EXPECT_TRUE(mesh_format_of_path(name, format));
    EXPECT_TRUE(write_mesh(path(name), format, mesh).ok);
    return path(name);
  }

  std::string shape(const std::string& name, int faces) const {
    const std::string made = path(name + ".ply");
    EXPECT_EQ(run({"make", name, "--faces", std::to_string(faces), "-o", made}).code, code(ExitCode::ok));
    return made;
  }

  Process start(const std::vector<std::string>& arguments, const std::string& in = "/dev/null") const {
    return {arguments, in, path("stdout"), path("stderr")};
  }

  Outcome run(const std::vector<std::string>& arguments, const std::string& in = "/dev/null") const {
    const int exit_code = start(arguments, in).wait();
    return {exit_code, contents(path("stdout")), contents(path("stderr"))};
  }

  json stats(const std::string& name) const { return json::parse(contents(path(name))); }

  bool exists(const std::string& name) const { return std::filesystem::exists(path(name)); }

  // Names of what is in the directory, beside the streams.
  std::vector<std::string> left_behind() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(directory_)) {
      const std::string name = entry.path().filename();
      if (name != "stdout" && name != "stderr") names.push_back(name);
    }
    return names;
  }

  void expect_usage_error(const std::vector<std::string>& arguments, const std::string& mentions) const {
    const Outcome outcome = run(arguments);
    SCOPED_TRACE(testing::PrintToString(arguments));
    EXPECT_EQ(outcome.code, code(ExitCode::usage));
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_THAT(outcome.err, AllOf(StartsWith("prcage: error: "), HasSubstr(mentions)));
  }

 private:
  std::string directory_;
};

// ------------------------------------------------------------------------------------------------ numbers

TEST(ParseRatio, ReadsDecimalsAndFractionsToTheNearestDouble) {
  double value = 0;
  for (const auto& [text, expected] : std::vector<std::pair<std::string, double>>{
           {"1/40", 1.0 / 40}, {"0.025", 0.025}, {"2.5e-2", 0.025}, {"1/3", 1.0 / 3}, {"2", 2.0}, {"0.5/4", 0.125}}) {
    ASSERT_TRUE(parse_ratio(text, value)) << text;
    EXPECT_EQ(value, expected) << text;
  }
}

TEST(ParseRatio, RefusesEverythingElseAndLeavesTheValueAlone) {
  double value = 7;
  for (const char* text : {"",      "/",     "1/", "/40", "1/0", "0",     "0/3",   "-1/40", "1/-40", "-1",
                           "1/40x", "1 /40", "x",  "nan", "inf", "1/inf", "1e999", "1/2/3", "+1",    "0x1"}) {
    EXPECT_FALSE(parse_ratio(text, value)) << text;
  }
  EXPECT_EQ(value, 7);
}

// ------------------------------------------------------------------------------------------ help and usage

TEST_F(Cli, HelpAndVersionGoToStandardOutput) {
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"--help"}, {"help"}, {"cage", "--help"}, {"help", "cage"}, {"help", "make"}, {"--version"}}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, code(ExitCode::ok)) << testing::PrintToString(arguments);
    EXPECT_THAT(outcome.err, IsEmpty());
    EXPECT_THAT(outcome.out, HasSubstr("prcage"));
  }
  EXPECT_THAT(run({"--version"}).out, AllOf(HasSubstr(version()), HasSubstr("Apache-2.0")));
  EXPECT_EQ(run({"help", "cage"}).out, run({"cage", "--help"}).out);
}

TEST_F(Cli, HelpDocumentsEveryOption) {
  const std::string help = run({"help", "cage"}).out;
  for (const char* option : {"--output", "--tau", "--tau-abs", "--tau-mode", "--cycles", "--schedule", "--faces",
                             "--no-edge-flips", "--sigma", "--threads", "--seed", "--flip", "--weld", "--stats",
                             "--format", "--quiet", "--levels", "--deadline"}) {
    EXPECT_THAT(help, HasSubstr(option));
  }
}

TEST_F(Cli, UsageLinesShowWhatIsRequired) {
  EXPECT_THAT(run({"--help"}).out, AllOf(HasSubstr("Usage: prcage COMMAND "), HasSubstr("COMMAND is required")));
  EXPECT_THAT(run({"help", "cage"}).out, HasSubstr("Usage: prcage cage INPUT -o OUTPUT [OPTIONS]\n"));
  EXPECT_THAT(run({"help", "check"}).out, HasSubstr("       prcage check INPUT --cage FILE [OPTIONS]\n"));
  EXPECT_THAT(run({"help", "make"}).out, AllOf(HasSubstr("Usage: prcage make SHAPE --faces N -o OUTPUT [OPTIONS]\n"),
                                               HasSubstr("       prcage make --list\n")));
  EXPECT_THAT(run({"help", "eval"}).out, HasSubstr("Usage: prcage eval INPUT CAGE [OPTIONS]\n"));
  EXPECT_THAT(run({"help", "render"}).out, HasSubstr("Usage: prcage render INPUT [CAGE] -o OUTPUT [OPTIONS]\n"));
}

TEST_F(Cli, HelpIsFreeOfTheParsersOwnNotation) {
  for (const char* command : {"cage", "check", "eval", "info", "make", "render", "bind", "pose", "deform", "batch",
                              "merge", "report", "simplify", "lowpoly", "help"}) {
    EXPECT_THAT(run({"help", command}).out, AllOf(Not(HasSubstr("REQUIRED")), Not(HasSubstr("Excludes")),
                                                  Not(HasSubstr("INT")), Not(HasSubstr("TEXT"))))
        << command;
  }
}

TEST_F(Cli, TheExampleOfTheHelpWorks) {
  std::istringstream help(run({"--help"}).out);
  int examples = 0;
  for (std::string line; std::getline(help, line);) {
    if (!line.starts_with("  prcage ")) continue;
    std::istringstream words(line.substr(9));
    std::vector<std::string> arguments{std::istream_iterator<std::string>(words), {}};
    for (std::string& argument : arguments) {
      if (argument.ends_with(".ply")) argument = path(argument);
    }
    EXPECT_EQ(run(arguments).code, code(ExitCode::ok)) << line;
    ++examples;
  }
  EXPECT_EQ(examples, 3);
}

TEST_F(Cli, EachHelpListsTheExitCodesOfItsCommand) {
  const auto listed = [](const std::string& help, ExitCode exit_code) {
    return help.find(fmt::format("\n  {:<4} {}", code(exit_code), meaning(exit_code))) != std::string::npos;
  };
  const std::string all = run({"--help"}).out;
  const std::string cage = run({"help", "cage"}).out;
  const std::string make = run({"help", "make"}).out;
  for (const ExitCode exit_code : all_exit_codes) {
    EXPECT_TRUE(listed(all, exit_code)) << code(exit_code);
    EXPECT_EQ(listed(cage, exit_code), exit_code != ExitCode::some_failed) << code(exit_code);
  }
  EXPECT_TRUE(listed(make, ExitCode::cannot_write));
  EXPECT_FALSE(listed(make, ExitCode::cannot_read));
  EXPECT_FALSE(listed(make, ExitCode::interrupted));
  EXPECT_FALSE(listed(run({"help", "check"}).out, ExitCode::face_budget_not_reached));
}

TEST_F(Cli, SimplifyWritesACertifiedMeshWithinItsTolerances) {
  const std::string in = shape("bumpy", 600);
  const Outcome outcome = run({"simplify", in, "-o", path("out.obj"), "--tau-inner", "1/100", "--tau-outer", "1/50",
                               "--faces", "300", "--stats", path("stats.json")});
  EXPECT_EQ(outcome.code, code(ExitCode::ok)) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("588 faces -> 300\n"), HasSubstr("0.01 inside, 0.02 outside"),
                                 HasSubstr("certificate: valid\n"), Not(HasSubstr("encloses"))));
  const MeshFile file = read_mesh(path("out.obj"));
  ASSERT_TRUE(file.ok);
  EXPECT_EQ(file.mesh.triangles.size(), 300u);
  EXPECT_EQ(run({"check", path("out.obj")}).code, code(ExitCode::ok));
  const json report = stats("stats.json");
  EXPECT_EQ(report["status"], "ok");
  EXPECT_EQ(report["written"], true);
  EXPECT_EQ(report["options"]["tau_inner"], 0.01);
  EXPECT_EQ(report["certificate"]["valid"], true);
  EXPECT_LE(report["deviation"]["inside"].get<double>(), 0.01);
  EXPECT_LE(report["deviation"]["outside"].get<double>(), 0.02);
}

TEST_F(Cli, LowPolyWritesAMeshOfSoManyFaces) {
  const std::string in = shape("bumpy", 300);
  const Outcome outcome =
      run({"lowpoly", in, "-o", path("out.ply"), "--faces", "100", "--quality", "fast", "--stats", path("stats.json")});
  EXPECT_EQ(outcome.code, code(ExitCode::ok)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(has_alpha_wrap() ? "alpha 0.1 and offset 0.002" : "no alpha wrap in this build"));
  EXPECT_EQ(read_mesh(path("out.ply")).mesh.triangles.size(), 100u);
  const json report = stats("stats.json");
  EXPECT_EQ(report["certificate"]["valid"], true);
  EXPECT_GT(report["tau_outer"].get<double>(), 0);
  EXPECT_THAT(run({"eval", in, path("out.ply")}).out, HasSubstr("of 24 views"));
  expect_usage_error({"lowpoly", in, "-o", path("none.ply")}, "--faces");
  EXPECT_EQ(
      run({"lowpoly", in, "-o", path("out.ply"), "--faces", "200", "--no-wrap", "--quality", "fast", "--quiet"}).code,
      code(ExitCode::ok));
}

TEST_F(Cli, SimplifySaysWhatItCannotDo) {
  const std::string in = file("in.ply", cube());
  const Outcome few = run({"simplify", in, "-o", path("out.ply"), "--faces", "4", "--quiet"});
  EXPECT_EQ(few.code, code(ExitCode::face_budget_not_reached));
  EXPECT_THAT(few.err, HasSubstr("no fewer than 12 faces"));
  EXPECT_TRUE(exists("out.ply"));
  Mesh open = cube();
  open.triangles.pop_back();
  const Outcome refused = run({"simplify", file("open.ply", open), "-o", path("none.ply")});
  EXPECT_EQ(refused.code, code(ExitCode::invalid_mesh));
  EXPECT_THAT(refused.err, HasSubstr("boundary edge"));
  EXPECT_FALSE(exists("none.ply"));
  expect_usage_error({"simplify", in, "-o", path("none.ply"), "--tau", "2"}, "--tau");
  expect_usage_error({"simplify", in, "-o", path("none.ply"), "--tau", "0.1", "--tau-inner", "0.1"}, "--tau");
  EXPECT_EQ(run({"simplify", in, "-o", path("out.ply"), "--tau", "2", "--absolute", "--quiet"}).code,
            code(ExitCode::ok));
}

TEST_F(Cli, UnknownOrMissingArgumentsAreUsageErrors) {
  const std::string in = file("in.ply", cube());
  expect_usage_error({}, "a command is required\nCommands: cage, check, ");
  expect_usage_error({"explode"}, "no such command 'explode'\nCommands: cage, check, ");
  expect_usage_error({"help", "explode"}, "no such command 'explode'\nCommands: cage, check, ");
  expect_usage_error({"cage", in}, "--output");
  expect_usage_error({"cage", "-o", path("out.ply")}, "INPUT");
  expect_usage_error({"cage", in, "-o"}, "--output needs a value");
  expect_usage_error({"cage", in, "-o", path("out.ply"), "--explode"}, "unknown option --explode\n");
  expect_usage_error({"cage", in, "another.ply", "-o", path("out.ply")}, "unexpected argument 'another.ply'");
  expect_usage_error({"--explode"}, "unknown option --explode\n");
  expect_usage_error({"check", in, "--explode"}, "--explode");
  expect_usage_error({"info"}, "FILE");
  expect_usage_error({"make", "sphere", "-o", path("out.ply")}, "--faces");
  expect_usage_error({"make", "sphere", "--faces", "100"}, "--output");
  expect_usage_error({"make", "no_such_shape", "--faces", "100", "-o", path("out.ply")}, "no_such_shape");
  EXPECT_THAT(left_behind(), testing::ElementsAre("in.ply"));
}

TEST_F(Cli, AMisspeltNameIsNamedAloneWithTheNearestOne) {
  const std::string in = file("in.ply", cube());
  expect_usage_error({"cage", in, "-o", path("out.ply"), "--taux", "0"},
                     "unknown option --taux; did you mean --tau?\n");
  expect_usage_error({"cage", in, "-o", path("out.ply"), "--taux=0"}, "unknown option --taux; did you mean --tau?\n");
  expect_usage_error({"cage", in, "--ouput", path("out.ply")}, "unknown option --ouput; did you mean --output?\n");
  expect_usage_error({"cage", "--wedl", in, "-o", path("out.ply")}, "unknown option --wedl; did you mean --weld?\n");
  expect_usage_error({"cage", in, "-o", path("out.ply"), "-t", "1"}, "unknown option -t\n");
  expect_usage_error({"chekc", in}, "no such command 'chekc'; did you mean check?\n");
  expect_usage_error({"--versoin"}, "unknown option --versoin; did you mean --version?\n");
}

TEST_F(Cli, MalformedValuesAreUsageErrors) {
  const std::string in = file("in.ply", cube());
  const std::vector<std::pair<std::string, std::string>> cases{
      {"--tau", "1/0"},      {"--tau", "fat"},     {"--tau", "-0.1"},    {"--tau-abs", "0"},
      {"--tau-mode", "lax"}, {"--cycles", "0"},    {"--cycles", "many"}, {"--schedule", "0.5,0.25,1"},
      {"--schedule", "0.5"}, {"--schedule", ""},   {"--schedule", "1,"}, {"--faces", "-3"},
      {"--faces", "1.5"},    {"--sigma", "0"},     {"--threads", "-1"},  {"--seed", "x"},
      {"--seed", "-1"},      {"--threads", "0x2"}, {"--format", "docx"}};
  for (const auto& [option, value] : cases) {
    expect_usage_error({"cage", in, "-o", path("out.ply"), option, value}, option);
  }
  EXPECT_FALSE(exists("out.ply"));
}

TEST_F(Cli, OptionsThatContradictEachOtherAreUsageErrors) {
  const std::string in = file("in.ply", cube());
  expect_usage_error({"cage", in, "-o", path("out.ply"), "--tau", "1/40", "--tau-abs", "1"}, "--tau");
  expect_usage_error({"cage", in, "-o", path("out.ply"), "--cycles", "4", "--schedule", "1"}, "--cycles");
  expect_usage_error({"cage", in, "-o", "-", "--format", "ply", "--stats", "-"}, "--stats");
  expect_usage_error({"cage", in, "-o", path("out.ply"), "--tau", "1/40", "--tau", "1/20"}, "--tau is given more than");
  expect_usage_error({"cage", in, "-o", path("out.ply"), "--quiet=maybe"}, "--quiet takes no value");
  expect_usage_error({"check", "-", "--cage", "-"}, "--cage");
  expect_usage_error({"make", "--list", "--faces", "100"}, "--list");
  expect_usage_error({"make", "sphere", "--list"}, "--list");
  expect_usage_error({"make", "--list", "--seed", "1"}, "--list");
}

TEST_F(Cli, TheOutputFormatMustBeKnownBeforeTheRun) {
  const std::string in = file("in.ply", cube());
  expect_usage_error({"cage", in, "-o", path("out.xyz")}, "--format");
  expect_usage_error({"cage", in, "-o", "-"}, "--format");
}

TEST_F(Cli, APictureIsNotWrittenUnderTheNameOfAMesh) {
  const std::string in = file("in.ply", cube());
  expect_usage_error({"render", in, "-o", in}, "in.ply");
  expect_usage_error({"render", in, "-o", path("picture.obj")}, "picture.obj");
  EXPECT_TRUE(read_mesh(in).ok);
  EXPECT_THAT(left_behind(), testing::ElementsAre("in.ply"));
}

// The file is not there: what is refused is refused before it is looked for.
TEST_F(Cli, RangesAreCheckedBeforeTheInputIsRead) {
  const std::vector<std::array<std::string, 4>> cases{{"--tau", "1", "1.001", "at most 1\n"},
                                                      {"--sigma", "0.01", "0.0101", "at most 0.01\n"},
                                                      {"--cycles", "10000", "10001", "from 1 to 10000\n"},
                                                      {"--threads", "4096", "4097", "from 0 to 4096\n"},
                                                      {"--schedule", "1/2,1", "1/2,2", "ends at 1\n"}};
  for (const auto& [option, largest, beyond, range] : cases) {
    expect_usage_error({"cage", path("nowhere.ply"), "-o", path("out.ply"), option, beyond}, range);
    EXPECT_EQ(run({"cage", path("nowhere.ply"), "-o", path("out.ply"), option, largest}).code,
              code(ExitCode::cannot_read))
        << option;
  }
  expect_usage_error({"render", path("nowhere.ply"), "-o", path("out.png"), "--elevation", "91"}, "from -90 to 90\n");
  expect_usage_error({"render", path("nowhere.ply"), "-o", path("out.png"), "--azimuth", "nan"}, "from -360 to 360\n");
  expect_usage_error({"render", path("nowhere.ply"), "-o", path("out.png"), "--width", "15"}, "from 16 to 16384\n");
}

TEST(ParseCommandLine, AcceptsNoValueThatTheLibraryRefuses) {
  for (const auto& [option, largest] : std::vector<std::pair<const char*, const char*>>{{"--tau", "1"},
                                                                                        {"--sigma", "0.01"},
                                                                                        {"--cycles", "10000"},
                                                                                        {"--threads", "4096"},
                                                                                        {"--schedule", "1/3,1"}}) {
    const std::array arguments{"prcage", "cage", "in.ply", "-o", "out.ply", option, largest};
    const CommandLine line = parse_command_line(static_cast<int>(arguments.size()), arguments.data());
    ASSERT_TRUE(line.command.has_value()) << option;
    EXPECT_EQ(options_error(std::get<CageCommand>(*line.command).options), "") << option;
  }
}

// ------------------------------------------------------------------------------------------ reading, writing

TEST_F(Cli, WhatCannotBeReadIsNamed) {
  for (const char* command : {"info", "check"}) {
    const Outcome outcome = run({command, path("nowhere.ply")});
    EXPECT_EQ(outcome.code, code(ExitCode::cannot_read));
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_THAT(outcome.err, HasSubstr("nowhere.ply"));
  }
  std::ofstream(path("poem.obj")) << "Shall I compare thee to a summer's day?\n";
  EXPECT_EQ(run({"check", path("poem.obj")}).code, code(ExitCode::cannot_read));
  EXPECT_EQ(run({"check", file("in.ply", cube()), "--cage", path("nowhere.ply")}).code, code(ExitCode::cannot_read));
}

TEST_F(Cli, AFailedReadIsInTheStatistics) {
  const Outcome outcome = run({"cage", path("nowhere.ply"), "-o", path("out.ply"), "--stats", path("stats.json")});
  EXPECT_EQ(outcome.code, code(ExitCode::cannot_read));
  EXPECT_THAT(left_behind(), testing::ElementsAre("stats.json"));
  const json statistics = stats("stats.json");
  EXPECT_EQ(statistics["status"], "cannot_read");
  EXPECT_EQ(statistics["exit_code"], code(ExitCode::cannot_read));
  EXPECT_EQ(statistics["cage_written"], false);
  EXPECT_THAT(statistics["message"].get<std::string>(), HasSubstr("nowhere.ply"));
  EXPECT_FALSE(statistics.contains("certificate"));
}

TEST_F(Cli, WhatCannotBeWrittenIsSaidBeforeTheRun) {
  const std::string in = file("in.ply", cube());
  const Outcome outcome = run({"cage", in, "-o", path("nowhere/out.ply"), "--stats", path("stats.json")});
  EXPECT_EQ(outcome.code, code(ExitCode::cannot_write));
  EXPECT_THAT(outcome.err, HasSubstr("nowhere/out.ply"));
  EXPECT_EQ(stats("stats.json")["status"], "cannot_write");
  EXPECT_FALSE(stats("stats.json").contains("statistics"));
  EXPECT_EQ(run({"cage", in, "-o", path("in.ply/out.ply")}).code, code(ExitCode::cannot_write));
  EXPECT_EQ(run({"cage", in, "-o", path("out.ply"), "--stats", path("nowhere/s.json")}).code,
            code(ExitCode::cannot_write));
  EXPECT_FALSE(exists("out.ply"));
  EXPECT_EQ(run({"make", "sphere", "--faces", "100", "-o", path("nowhere/out.ply")}).code,
            code(ExitCode::cannot_write));
}

TEST_F(Cli, AFullStandardOutputIsAWriteError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  const std::string in = file("in.ply", cube());
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"info", in},
                                             {"check", in, "--json"},
                                             {"eval", in, in},
                                             {"make", "--list"},
                                             {"cage", in, "-o", "-", "--format", "obj"}}) {
    EXPECT_EQ(Process(arguments, "/dev/null", "/dev/full", path("stderr")).wait(), code(ExitCode::cannot_write));
    EXPECT_THAT(contents(path("stderr")), HasSubstr("standard output")) << testing::PrintToString(arguments);
  }
}

// ------------------------------------------------------------------------------------------------ info, make

TEST_F(Cli, InfoDescribesAFile) {
  const std::string in = file("in.off", cube());
  const Outcome text = run({"info", in});
  EXPECT_EQ(text.code, code(ExitCode::ok));
  EXPECT_THAT(text.err, IsEmpty());
  EXPECT_THAT(text.out, AllOf(HasSubstr("in.off"), HasSubstr("8 vertices, 12 faces"), HasSubstr("1 component")));

  const json info = json::parse(run({"info", "--json", "-"}, in).out);
  EXPECT_EQ(info["file"]["path"], "-");
  EXPECT_EQ(info["file"]["format"], "off");
  EXPECT_DOUBLE_EQ(info["measures"]["volume"], 1.0);
  EXPECT_EQ(info["measures"]["area"], 6.0);
  EXPECT_EQ(info["measures"]["edges"], 18);
  EXPECT_EQ(info["measures"]["euler_characteristic"], 2);
}

TEST(Measure, OfACube) {
  const MeshMeasures measures = measure(cube());
  EXPECT_EQ(measures.components, 1u);
  EXPECT_EQ(measures.boundary_edges, 0u);
  EXPECT_EQ(measures.diagonal, std::sqrt(3.0));
  EXPECT_EQ(measures.edge_length.min, 1);
  EXPECT_EQ(measures.edge_length.max, std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(measures.smallest_angle.min, 45);
  EXPECT_DOUBLE_EQ(measures.largest_angle, 90);
}

TEST(Measure, SurvivesFacesThatAreNotUsable) {
  Mesh mesh = cube();
  mesh.positions.push_back({NAN, 0, 0});
  mesh.positions.push_back({50, 50, 50});
  mesh.triangles.push_back({0, 1, 8});
  mesh.triangles.push_back({0, 1, 99});
  const MeshMeasures measures = measure(mesh);
  EXPECT_EQ(measures.faces, 14u);
  EXPECT_EQ(measures.usable_faces, 12u);
  EXPECT_EQ(measures.referenced_vertices, 8u);
  EXPECT_DOUBLE_EQ(measures.volume, 1);
  EXPECT_EQ(measures.upper[0], 1);
  EXPECT_EQ(measure(Mesh{}).components, 0u);
}

TEST_F(Cli, MakeListsItsShapesAndMakesThem) {
  EXPECT_THAT(run({"make", "--list"}).out, AllOf(HasSubstr("bumpy"), HasSubstr("gyroid"), HasSubstr("bracket")));
  EXPECT_EQ(run({"check", shape("knot", 500)}).code, code(ExitCode::ok));
  const Outcome piped = run({"make", "bumpy", "--faces", "200", "--seed", "3", "-o", "-", "--format", "off"});
  EXPECT_EQ(piped.code, code(ExitCode::ok));
  EXPECT_THAT(piped.out, StartsWith("OFF"));
  EXPECT_NE(piped.out, run({"make", "bumpy", "--faces", "200", "--seed", "4", "-o", "-", "--format", "off"}).out);
}

// ---------------------------------------------------------------------------------------------------- check

TEST_F(Cli, CheckOfAValidMesh) {
  const std::string in = file("in.ply", cube());
  const Outcome text = run({"check", in});
  EXPECT_EQ(text.code, code(ExitCode::ok));
  EXPECT_THAT(text.out, HasSubstr("in.ply: valid input"));
  EXPECT_THAT(text.err, IsEmpty());
  const json report = json::parse(run({"check", in, "--json"}).out);
  EXPECT_EQ(report["schema"], 1);
  EXPECT_EQ(report["tool"]["version"], version());
  EXPECT_EQ(report["validation"]["valid"], true);
  EXPECT_DOUBLE_EQ(report["validation"]["volume"], 1.0);
}

TEST_F(Cli, CheckNamesTheDefectTheElementsAndTheRemedy) {
  Mesh open = cube();
  open.triangles.pop_back();
  const std::string in = file("open.ply", open);
  const Outcome text = run({"check", in});
  EXPECT_EQ(text.code, code(ExitCode::invalid_mesh));
  EXPECT_THAT(text.err, IsEmpty());
  EXPECT_THAT(text.out, AllOf(HasSubstr("open.ply"), HasSubstr("3 boundary edges"), HasSubstr("face 10, "),
                              HasSubstr("close the holes"), Not(HasSubstr("--weld"))));
  const Outcome machine = run({"check", in, "--json"});
  EXPECT_EQ(machine.code, code(ExitCode::invalid_mesh));
  const json defects = json::parse(machine.out)["validation"]["defects"];
  ASSERT_EQ(defects.size(), 1u);
  EXPECT_EQ(defects[0]["kind"], "boundary_edge");
  EXPECT_EQ(defects[0]["count"], 3);
  EXPECT_EQ(defects[0]["examples"].size(), 3u);
}

// The cube with a vertex on an edge that one of the two faces there knows and the other does not: the face between
// them has no area.
Mesh cube_with_a_face_of_no_area() {
  Mesh mesh = cube();
  mesh.positions.push_back({0.5, 0.5, 0});  // on the diagonal from 0 to 3 of the bottom
  mesh.triangles[0] = {0, 2, 8};
  mesh.triangles.push_back({8, 2, 3});
  mesh.triangles.push_back({0, 8, 3});
  return mesh;
}

TEST_F(Cli, CheckSaysWhatBecameOfZeroAreaFaces) {
  Mesh mesh = cube_with_a_face_of_no_area();
  EXPECT_THAT(run({"check", file("legal.ply", mesh)}).out,
              AllOf(HasSubstr("valid input"), ContainsRegex("would drop +1 zero-area face\n")));

  Mesh inside_out = mesh;
  for (auto& triangle : inside_out.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_THAT(run({"check", file("inside_out.ply", inside_out)}).out,
              HasSubstr("note: 1 zero-area face, removed by exact repair\n"));

  mesh.triangles.erase(mesh.triangles.begin() + 5);
  EXPECT_THAT(run({"check", file("open.ply", mesh)}).out,
              HasSubstr("note: 1 zero-area face, left out of the test for self-intersections\n"));
  EXPECT_THAT(run({"check", file("cube.ply", cube())}).out, Not(HasSubstr("zero-area")));
}

TEST_F(Cli, CheckOfAPair) {
  const std::string in = shape("bumpy", 500);
  ASSERT_EQ(run({"cage", in, "-o", path("cage.obj"), "--quiet"}).code, code(ExitCode::ok));
  const Outcome good = run({"check", in, "--cage", path("cage.obj")});
  EXPECT_EQ(good.code, code(ExitCode::ok));
  EXPECT_THAT(good.out, AllOf(HasSubstr("certificate: valid"), Not(HasSubstr("NO"))));

  const Outcome touching = run({"check", in, "--cage", in, "--json"});
  EXPECT_EQ(touching.code, code(ExitCode::no_cage));
  const json certificate = json::parse(touching.out)["certificate"];
  EXPECT_EQ(certificate["valid"], false);
  EXPECT_EQ(certificate["no_contact"], false);
  EXPECT_GT(certificate["contacts"], 0);
  EXPECT_EQ(certificate["closed"], true);
}

TEST_F(Cli, CheckOfAPairSaysWhatIsWrongWithTheCage) {
  Mesh open = cube();
  for (auto& p : open.positions) {
    for (double& x : p) x = 3 * x - 1;
  }
  open.triangles.pop_back();
  const Outcome outcome = run({"check", file("in.ply", cube()), "--cage", file("open.ply", open)});
  EXPECT_EQ(outcome.code, code(ExitCode::no_cage));
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("NOT VALID"), HasSubstr("open.ply: not a valid input"), HasSubstr("3 boundary edges")));
}

// ----------------------------------------------------------------------------------------------------- eval

Mesh cube_from(double low, double high) {
  Mesh mesh = cube();
  for (auto& p : mesh.positions) {
    for (double& x : p) x = low + (high - low) * x;
  }
  return mesh;
}

TEST_F(Cli, EvalPrintsATableForPeople) {
  const std::string in = file("in.ply", cube());
  const Outcome outcome = run({"eval", in, file("cage.obj", cube_from(-0.25, 1.25)), "--tau", "1/10"});
  EXPECT_EQ(outcome.code, code(ExitCode::ok));
  EXPECT_THAT(outcome.err, IsEmpty());
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("cage.obj: cage of 12 faces around "), HasSubstr("in.ply, 12 faces\n"),
                                 HasSubstr("conditions: all four hold\n"), HasSubstr("certificate: valid\n")));
  EXPECT_THAT(outcome.out, AllOf(ContainsRegex("Hausdorff +0.250000 +0.144338 +0.250000\n"),
                                 ContainsRegex("beyond tau +of 0.1: at most 0.15, mean "),
                                 ContainsRegex("volume ratio +3.375000\n"), ContainsRegex("area ratio +2.250000\n"),
                                 ContainsRegex("least angle +45 deg, 5th percentile 45 deg, mean 45 deg\n")));
  EXPECT_THAT(run({"eval", in, path("cage.obj")}).out, Not(HasSubstr("beyond tau")));
}

TEST_F(Cli, EvalWritesJsonBesideTheTableOrInsteadOfIt) {
  const std::string in = file("in.ply", cube());
  const std::string cage = file("cage.ply", cube_from(-0.25, 1.25));
  const std::vector<std::string> arguments{"eval", in, cage, "--samples", "5000", "--seed", "3", "--threads", "2"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = arguments;
    all.insert(all.end(), more.begin(), more.end());
    return run(all);
  };
  EXPECT_THAT(with({"--json", path("report.json")}).out, HasSubstr("conditions: all four hold"));
  const json report = stats("report.json");
  EXPECT_EQ(report["schema"], 1);
  EXPECT_EQ(report["options"]["samples"], 5000);
  EXPECT_EQ(report["options"]["seed"], 3);
  EXPECT_EQ(report["cage"]["path"], cage);
  EXPECT_EQ(report["conditions"]["success"], true);
  EXPECT_EQ(report["certificate"]["valid"], true);
  EXPECT_DOUBLE_EQ(report["measures"]["hausdorff"], 0.25);
  EXPECT_DOUBLE_EQ(report["measures"]["diagonal"], std::sqrt(3.0));
  EXPECT_EQ(report["measures"]["violation"], nullptr);

  const json printed = json::parse(with({"--json", "-", "--tau-abs", "0.3"}).out);
  EXPECT_EQ(printed["measures"]["cage_to_input"], report["measures"]["cage_to_input"]);
  EXPECT_EQ(printed["measures"]["input_to_cage"], report["measures"]["input_to_cage"]);
  EXPECT_DOUBLE_EQ(printed["measures"]["violation"]["tau"], 0.3 / std::sqrt(3.0));
}

TEST_F(Cli, EvalOfWhatIsNoCageMeasuresItAllTheSame) {
  const std::string in = file("in.ply", cube());
  const Outcome inside = run({"eval", in, file("inside.ply", cube_from(0.25, 0.75))});
  EXPECT_EQ(inside.code, code(ExitCode::no_cage));
  EXPECT_THAT(inside.out,
              AllOf(HasSubstr("conditions: NOT ALL HOLD"), ContainsRegex("strictly encloses the input +NO\n"),
                    HasSubstr("certificate: NOT VALID"), ContainsRegex("volume ratio +0.125000\n")));
  EXPECT_THAT(inside.out, HasSubstr("prcage check " + in + " --cage " + path("inside.ply")));

  Mesh open = cube();
  open.triangles.pop_back();
  const Outcome around_open = run({"eval", file("open.ply", open), file("cage.ply", cube_from(-0.25, 1.25))});
  EXPECT_EQ(around_open.code, code(ExitCode::no_cage));
  EXPECT_THAT(around_open.out, AllOf(HasSubstr("the input is not a closed surface: nothing can be said"),
                                     ContainsRegex("Hausdorff +0.250000 "), ContainsRegex("volume ratio +not known")));
  const json report = json::parse(run({"eval", path("open.ply"), path("cage.ply"), "--json", "-"}).out);
  EXPECT_EQ(report["measures"]["input_closed"], false);
  EXPECT_EQ(report["measures"]["volume_ratio"], nullptr);
}

TEST_F(Cli, EvalRefusesWhatCannotBeMeasured) {
  const std::string in = file("in.ply", cube());
  Mesh broken = cube();
  broken.positions[0][0] = NAN;
  const Outcome outcome = run({"eval", in, file("broken.off", broken), "--json", path("report.json")});
  EXPECT_EQ(outcome.code, code(ExitCode::invalid_mesh));
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr("broken.off"), HasSubstr("the cage cannot be measured"), HasSubstr("prcage check")));
  EXPECT_FALSE(exists("report.json"));
  EXPECT_EQ(run({"eval", in, path("nowhere.ply")}).code, code(ExitCode::cannot_read));
  EXPECT_EQ(run({"eval", path("nowhere.ply"), in}).code, code(ExitCode::cannot_read));
  EXPECT_EQ(run({"eval", in, in, "--json", path("nowhere/report.json")}).code, code(ExitCode::cannot_write));
}

TEST_F(Cli, EvalChecksItsOptionsBeforeItReads) {
  const std::string in = path("nowhere.ply");
  expect_usage_error({"eval", in}, "CAGE");
  expect_usage_error({"eval", "-", "-"}, "CAGE");
  expect_usage_error({"eval", in, in, "--samples", "0"}, "from 1 to 1000000000\n");
  expect_usage_error({"eval", in, in, "--tau", "2"}, "at most 1\n");
  expect_usage_error({"eval", in, in, "--tau", "1/40", "--tau-abs", "1"}, "--tau");
  expect_usage_error({"eval", in, in, "--seed", "-1"}, "--seed");
}

// ------------------------------------------------------------------------------------ bind, pose, deform

TEST_F(Cli, DeformsFromWeightsAndInOneStep) {
  const std::string in = shape("knot", 500);
  const std::string cage = file("cage.ply", shape_of("sphere", 100, 5));
  const std::string bent = path("bent.ply"), weights = path("weights"), out = path("out.ply"), once = path("once.ply");
  EXPECT_EQ(run({"pose", cage, "--bend", "40", "--twist", "-60", "--axis", "y", "-o", bent}).code, code(ExitCode::ok));
  const Outcome bound = run({"bind", in, cage, "-o", weights});
  EXPECT_EQ(bound.code, code(ExitCode::ok)) << bound.err;
  EXPECT_THAT(bound.out, IsEmpty());
  EXPECT_THAT(bound.err, AllOf(HasSubstr("of 56 weights each"), HasSubstr("error at rest")));
  EXPECT_EQ(run({"deform", weights, bent, "-o", out}).code, code(ExitCode::ok));
  EXPECT_EQ(run({"deform", in, cage, bent, "-o", once}).code, code(ExitCode::ok));
  EXPECT_EQ(contents(out), contents(once));
  EXPECT_NE(contents(out), contents(in));
  EXPECT_EQ(run({"deform", "-", cage, "-o", out}, weights).code, code(ExitCode::ok));
  const Mesh still = read_mesh(out).mesh, input = read_mesh(in).mesh;
  ASSERT_EQ(still.positions.size(), input.positions.size());
  for (std::size_t v = 0; v < input.positions.size(); ++v)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(still.positions[v][k], input.positions[v][k], 1e-6);
}

TEST_F(Cli, BindTruncatesAndSaysWhatItCosts) {
  const std::string in = shape("knot", 500);
  const std::string cage = file("cage.ply", shape_of("sphere", 100, 5));
  const Outcome few = run({"bind", in, cage, "--keep", "8", "--float", "-o", path("few")});
  EXPECT_THAT(few.err, AllOf(HasSubstr("8 of 56 weights each"), ContainsRegex("left out +at most 0\\.[0-9]+ of")));
  EXPECT_EQ(run({"bind", in, cage, "--quiet", "-o", path("all")}).err, "");
  EXPECT_LT(contents(path("few")).size(), contents(path("all")).size() / 2);
}

TEST_F(Cli, DeformRefusesWhatDoesNotFit) {
  const std::string in = file("in.ply", cube_from(0.25, 0.75)), cage = file("cage.ply", cube());
  const std::string weights = path("weights"), out = path("out.ply");
  ASSERT_EQ(run({"bind", in, cage, "-o", weights}).code, code(ExitCode::ok));
  Mesh open = cube();
  open.triangles.pop_back();
  const Outcome other = run({"deform", weights, file("open.ply", open), "-o", out});
  EXPECT_EQ(other.code, code(ExitCode::invalid_mesh));
  EXPECT_THAT(other.err, AllOf(HasSubstr("open.ply"), HasSubstr("11 faces"), HasSubstr("12")));
  EXPECT_EQ(run({"bind", in, path("open.ply"), "-o", path("none")}).code, code(ExitCode::invalid_mesh));
  const Outcome mesh = run({"deform", in, cage, "-o", out});
  EXPECT_EQ(mesh.code, code(ExitCode::cannot_read));
  EXPECT_THAT(mesh.err, AllOf(HasSubstr("in.ply"), HasSubstr("prcage bind")));
  std::filesystem::resize_file(weights, 100);
  const Outcome cut = run({"deform", weights, cage, "-o", out});
  EXPECT_EQ(cut.code, code(ExitCode::cannot_read));
  EXPECT_THAT(cut.err, AllOf(HasSubstr("weights: byte 100: "), HasSubstr("truncated")));
  EXPECT_EQ(run({"bind", in, cage, "-o", path("nowhere/weights")}).code, code(ExitCode::cannot_write));
  EXPECT_FALSE(exists("out.ply"));
  EXPECT_FALSE(exists("none"));
  expect_usage_error({"deform", weights, "-o", out}, "DEFORMED_CAGE");
  expect_usage_error({"deform", in, cage, cage, cage, "-o", out}, "unexpected argument");
  expect_usage_error({"deform", "-", "-", "-o", out}, "standard input");
  expect_usage_error({"bind", in, cage, "--keep", "0", "-o", weights}, "of at least 1");
  expect_usage_error({"pose", cage, "-o", out}, "--bend or --twist");
  expect_usage_error({"pose", cage, "--bend", "9", "--axis", "w", "-o", out}, "none of x, y and z");
}

// ----------------------------------------------------------------------------------------------------- cage

TEST_F(Cli, CageWritesTheCageAndTellsPeopleOnStandardError) {
  const std::string in = shape("bumpy", 2000);
  const Outcome outcome = run({"cage", in, "-o", path("cage.ply")});
  EXPECT_EQ(outcome.code, code(ExitCode::ok));
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("certificate: valid"), Not(HasSubstr("\r")), Not(HasSubstr("\x1b"))));
  const MeshFile cage = read_mesh(path("cage.ply"));
  ASSERT_TRUE(cage.ok);
  EXPECT_LT(cage.mesh.triangles.size(), 1000u);
  EXPECT_EQ(run({"check", in, "--cage", path("cage.ply")}).code, code(ExitCode::ok));
}

TEST_F(Cli, QuietIsQuiet) {
  const Outcome outcome = run({"cage", shape("bumpy", 500), "-o", path("cage.ply"), "--quiet"});
  EXPECT_EQ(outcome.code, code(ExitCode::ok));
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(outcome.err, IsEmpty());
}

TEST_F(Cli, StandardInputToStandardOutput) {
  const std::string in = shape("bumpy", 500);
  const Outcome piped = run({"cage", "-", "-o", "-", "--format", "ply"}, in);
  EXPECT_EQ(piped.code, code(ExitCode::ok));
  ASSERT_EQ(run({"cage", in, "-o", path("cage.ply")}).code, code(ExitCode::ok));
  EXPECT_EQ(piped.out, contents(path("cage.ply")));
}

TEST_F(Cli, AFractionIsTheSameAsItsDecimal) {
  const std::string in = shape("bumpy", 500);
  const Outcome fraction = run({"cage", in, "-o", "-", "--format", "off", "--tau", "1/16", "--stats", path("s.json")});
  const Outcome decimal = run({"cage", in, "-o", "-", "--format", "off", "--tau", "0.0625"});
  EXPECT_EQ(fraction.code, code(ExitCode::ok));
  EXPECT_EQ(fraction.out, decimal.out);
  const json statistics = stats("s.json");
  EXPECT_EQ(statistics["options"]["tau"], 1.0 / 16);
  EXPECT_EQ(statistics["statistics"]["tau"], statistics["statistics"]["diagonal"].get<double>() / 16);
}

TEST_F(Cli, StatisticsHoldTheRun) {
  const std::string in = shape("bumpy", 2000);
  ASSERT_EQ(run({"cage", in, "-o", path("cage.stl"), "--stats", path("s.json"), "--tau-abs", "0.25", "--schedule",
                 "1/4,1/2,1", "--no-edge-flips", "--threads", "2", "--seed", "9", "--tau-mode", "paper"})
                .code,
            code(ExitCode::ok));
  const json record = stats("s.json");
  EXPECT_EQ(record["status"], "ok");
  EXPECT_EQ(record["exit_code"], 0);
  EXPECT_EQ(record["cage_written"], true);
  EXPECT_EQ(record["options"]["tau_absolute"], 0.25);
  EXPECT_EQ(record["options"]["tau"], 0.25 / record["statistics"]["diagonal"].get<double>());
  EXPECT_EQ(record["options"]["schedule"], json({0.25, 0.5, 1.0}));
  EXPECT_EQ(record["options"]["cycles"], 3);
  EXPECT_EQ(record["options"]["flips"], false);
  EXPECT_EQ(record["options"]["seed"], 9);
  EXPECT_EQ(record["options"]["tau_mode"], "paper");
  EXPECT_EQ(record["options"]["precision"], "float32") << "binary STL holds floats";
  EXPECT_EQ(record["statistics"]["threads"], 2);
  EXPECT_EQ(record["statistics"]["cycles"].size(), 3u);
  EXPECT_EQ(record["statistics"]["input_faces"], record["input"]["faces"]);
  EXPECT_EQ(record["statistics"]["cage_faces"], read_mesh(path("cage.stl")).mesh.triangles.size());
  EXPECT_GT(record["statistics"]["counts"]["collapses"], 0);
  EXPECT_EQ(record["statistics"]["counts"]["flips_tried"], 0);
  EXPECT_GT(record["statistics"]["peak_memory_bytes"], 0);
  EXPECT_GT(record["seconds"]["read"], 0);
  EXPECT_GT(record["seconds"]["write"], 0);
  EXPECT_GE(record["seconds"]["total"], record["statistics"]["seconds"]["total"]);
  EXPECT_EQ(record["certificate"]["valid"], true);
  EXPECT_EQ(record["validation"]["valid"], true);
}

TEST_F(Cli, TheDefaultScheduleIsWrittenOut) {
  ASSERT_EQ(
      run({"cage", file("in.ply", cube()), "-o", path("cage.ply"), "--stats", path("s.json"), "--cycles", "4"}).code,
      code(ExitCode::ok));
  EXPECT_EQ(stats("s.json")["options"]["schedule"], json({0.25, 0.5, 0.75, 1.0}));
}

TEST_F(Cli, TheContentHashDependsOnTheMeshAndNotOnTheFormat) {
  const auto hash = [this](const std::string& mesh) {
    return json::parse(run({"info", "--json", mesh}).out)["file"]["content_hash"].get<std::string>();
  };
  Mesh moved = cube();
  moved.positions[3][1] = 1.5;
  const std::string original = hash(file("a.ply", cube()));
  EXPECT_THAT(original, StartsWith("xxh3_64:"));
  EXPECT_EQ(original, hash(file("b.obj", cube())));
  EXPECT_NE(original, hash(file("c.ply", moved)));
}

TEST_F(Cli, InvalidInputLeavesOnlyStatistics) {
  Mesh open = cube();
  open.triangles.pop_back();
  const Outcome outcome =
      run({"cage", file("open.ply", open), "-o", path("cage.ply"), "--stats", path("s.json"), "--quiet"});
  EXPECT_EQ(outcome.code, code(ExitCode::invalid_mesh));
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("open.ply"), HasSubstr("boundary edges"), HasSubstr("close the holes")));
  EXPECT_THAT(left_behind(), testing::UnorderedElementsAre("open.ply", "s.json"));
  EXPECT_EQ(stats("s.json")["status"], "invalid_input");
  EXPECT_EQ(stats("s.json")["validation"]["defects"][0]["kind"], "boundary_edge");
}

TEST_F(Cli, AFailureDoesNotTouchAnOlderFile) {
  Mesh open = cube();
  open.triangles.pop_back();
  const std::string older = file("cage.ply", cube());
  const std::string before = contents(older);
  EXPECT_EQ(run({"cage", file("open.ply", open), "-o", older}).code, code(ExitCode::invalid_mesh));
  EXPECT_EQ(contents(older), before);
}

TEST_F(Cli, AnInsideOutInputIsRefusedUnlessFlipped) {
  Mesh inside_out = cube();
  for (auto& triangle : inside_out.triangles) std::swap(triangle[0], triangle[1]);
  const std::string in = file("in.ply", inside_out);
  const Outcome refused = run({"cage", in, "-o", path("cage.ply")});
  EXPECT_EQ(refused.code, code(ExitCode::invalid_mesh));
  EXPECT_THAT(refused.err, AllOf(HasSubstr("  inside-out mesh: its faces look inward"), HasSubstr("--flip")));
  EXPECT_EQ(run({"cage", in, "-o", path("cage.ply"), "--flip"}).code, code(ExitCode::ok));
  EXPECT_GT(measure(read_mesh(path("cage.ply")).mesh).volume, 1);
}

TEST_F(Cli, AnUnweldedInputIsRefusedUnlessWelded) {
  const Mesh welded = cube();
  Mesh soup;
  for (const auto& triangle : welded.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    for (const std::uint32_t v : triangle) soup.positions.push_back(welded.positions[v]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  const std::string in = file("soup.ply", soup);
  const Outcome refused = run({"cage", in, "-o", path("cage.ply")});
  EXPECT_EQ(refused.code, code(ExitCode::invalid_mesh));
  const std::string hint = "try --weld first: merging vertices at equal positions closes 36 of 36 boundary edges";
  EXPECT_THAT(refused.err, HasSubstr(hint));
  EXPECT_LT(refused.err.find(hint), refused.err.find("36 boundary edges: ")) << "before the defects";
  const Outcome accepted = run({"cage", in, "-o", path("cage.ply"), "--weld", "--stats", path("s.json")});
  EXPECT_EQ(accepted.code, code(ExitCode::ok));
  EXPECT_THAT(accepted.err, HasSubstr("28 vertices welded"));
  EXPECT_EQ(stats("s.json")["input"]["welded_vertices"], 28);
  EXPECT_EQ(run({"check", in, "--weld", "--cage", path("cage.ply")}).code, code(ExitCode::ok));
}

// The cube with one corner split in two at the same position, and a face of no area in the crack.
TEST_F(Cli, FacesThatWeldingCollapsesAreRemovedAndCounted) {
  Mesh split = cube();
  split.positions.push_back(split.positions[0]);
  split.triangles[0] = {8, 2, 3};
  split.triangles.push_back({0, 8, 3});
  const std::string in = file("split.ply", split);
  const Outcome outcome = run({"cage", in, "-o", path("cage.ply"), "--weld", "--stats", path("s.json")});
  EXPECT_EQ(outcome.code, code(ExitCode::ok));
  EXPECT_THAT(outcome.err, HasSubstr("1 face removed that welding collapsed"));
  EXPECT_EQ(stats("s.json")["input"]["faces"], 13);
  EXPECT_EQ(stats("s.json")["input"]["collapsed_faces"], 1);
  EXPECT_EQ(stats("s.json")["statistics"]["input_faces"], 12);
  EXPECT_EQ(run({"check", file("split.stl", split)}).code, code(ExitCode::ok));
}

TEST_F(Cli, WhatIsDroppedIsSaid) {
  Mesh mesh = cube();
  mesh.positions.push_back({5, 5, 5});
  const Outcome outcome = run({"cage", file("in.ply", mesh), "-o", path("cage.ply")});
  EXPECT_EQ(outcome.code, code(ExitCode::ok));
  EXPECT_THAT(outcome.err, HasSubstr("1 unreferenced vertex"));
}

TEST_F(Cli, AFaceBudgetIsMetOrSaidNotToBe) {
  const std::string in = shape("bumpy", 2000);
  ASSERT_EQ(run({"cage", in, "-o", path("cage.ply"), "--faces", "1000"}).code, code(ExitCode::ok));
  EXPECT_EQ(read_mesh(path("cage.ply")).mesh.triangles.size(), 1000u);

  const Outcome missed = run({"cage", in, "-o", path("tight.ply"), "--faces", "4", "--tau", "1/200", "--quiet"});
  EXPECT_EQ(missed.code, code(ExitCode::face_budget_not_reached));
  EXPECT_THAT(missed.err, HasSubstr("face budget not reached"));
  EXPECT_EQ(run({"check", in, "--cage", path("tight.ply")}).code, code(ExitCode::ok));
}

TEST_F(Cli, ABudgetThatTauDoesNotAllowComesWithTheTauThatDoes) {
  const std::string in = shape("bumpy", 2000);
  const Outcome missed =
      run({"cage", in, "-o", path("c.ply"), "--faces", "60", "--tau", "1/200", "--quiet", "--stats", path("s.json")});
  ASSERT_EQ(missed.code, code(ExitCode::face_budget_not_reached));
  const json statistics = stats("s.json")["statistics"];
  const double needed = statistics["needed_tau"].get<double>() / statistics["diagonal"].get<double>();
  EXPECT_THAT(missed.err, HasSubstr(fmt::format("about {:.6g} would allow 60 (an upper estimate)", needed)));
  EXPECT_EQ(run({"cage", in, "-o", path("c.ply"), "--faces", "60", "--tau", fmt::format("{:.6g}", needed)}).code,
            code(ExitCode::ok));
}

// ---------------------------------------------------------------------------------------------------- levels

TEST_F(Cli, LevelsAreFilesOfTheirOwn) {
  const std::string in = shape("bumpy", 2000);
  const Outcome outcome =
      run({"cage", in, "-o", path("cage.off"), "--levels", "800,300,100", "--stats", path("s.json")});
  EXPECT_EQ(outcome.code, code(ExitCode::ok));
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("cage.800.off"), HasSubstr("valid around the input and the level before")));
  EXPECT_THAT(left_behind(),
              testing::UnorderedElementsAre("bumpy.ply", "cage.800.off", "cage.300.off", "cage.100.off", "s.json"));
  std::string inner = in;
  for (const char* level : {"cage.800.off", "cage.300.off", "cage.100.off"}) {
    EXPECT_EQ(run({"check", inner, "--cage", path(level)}).code, code(ExitCode::ok)) << level;
    EXPECT_EQ(run({"check", in, "--cage", path(level)}).code, code(ExitCode::ok)) << level;
    inner = path(level);
  }
  const json record = stats("s.json");
  EXPECT_EQ(record["status"], "ok");
  EXPECT_EQ(record["cage_written"], true);
  EXPECT_EQ(record["options"]["levels"], json({800, 300, 100}));
  EXPECT_EQ(record["options"]["tau"], 0);
  EXPECT_EQ(record["validation"]["valid"], true);
  EXPECT_FALSE(record.contains("certificate"));
  ASSERT_EQ(record["levels"].size(), 3u);
  EXPECT_TRUE(record["levels"][0]["around_previous"].is_null());
  EXPECT_EQ(record["levels"][1]["around_previous"]["valid"], true);
  EXPECT_EQ(record["levels"][2]["certificate"]["valid"], true);
  EXPECT_EQ(record["levels"][2]["face_budget"], 100);
  EXPECT_EQ(record["levels"][2]["statistics"]["cage_faces"], 100);
  EXPECT_EQ(record["levels"][2]["output"], path("cage.100.off"));
  EXPECT_EQ(record["levels"][2]["cage_written"], true);
}

TEST_F(Cli, LevelsThatCannotBeAreUsageErrors) {
  const std::string in = path("nowhere.ply");
  for (const char* levels : {"", "0", "10,", ",10", "10,10", "10,20", "30,20,25", "10,x", "10 5", "-5", "1e3", "10,0"})
    expect_usage_error({"cage", in, "-o", path("c.ply"), "--levels", levels}, "--levels");
  expect_usage_error({"cage", in, "-o", path("c.ply"), "--levels", "20,10", "--faces", "5"}, "--faces");
  expect_usage_error({"cage", in, "-o", "-", "--format", "ply", "--levels", "20,10"}, "several cages");
}

TEST_F(Cli, ALevelThatTauDoesNotAllowIsWrittenAllTheSame) {
  const std::string in = shape("bumpy", 1000);
  const Outcome outcome = run({"cage", in, "-o", path("c.ply"), "--levels", "500,4", "--tau", "1/50", "--quiet"});
  EXPECT_EQ(outcome.code, code(ExitCode::face_budget_not_reached));
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("face budget not reached"), HasSubstr("c.4.ply")));
  EXPECT_EQ(run({"check", path("c.500.ply"), "--cage", path("c.4.ply")}).code, code(ExitCode::ok));
}

TEST(LevelPath, HasTheNumberBeforeTheExtension) {
  EXPECT_EQ(level_path("cage.ply", 500), "cage.500.ply");
  EXPECT_EQ(level_path("a.b/cage", 7), "a.b/cage.7");
  EXPECT_EQ(level_path("../x.v2.stl", 12), "../x.v2.12.stl");
}

// -------------------------------------------------------------------------------------------------- deadline

TEST_F(Cli, ADeadlineLeavesTheCageReachedSoFarOrNone) {
  const std::string in = shape("bumpy", 20000);
  const Outcome none = run({"cage", in, "-o", path("c.ply"), "--deadline", "1e-6", "--stats", path("s.json")});
  EXPECT_EQ(none.code, code(ExitCode::no_cage));
  EXPECT_THAT(none.err, HasSubstr("the deadline has passed before there was a cage; nothing written"));
  EXPECT_FALSE(exists("c.ply"));
  EXPECT_EQ(stats("s.json")["status"], "deadline_reached");
  EXPECT_EQ(stats("s.json")["cage_written"], false);

  EXPECT_EQ(run({"cage", in, "-o", path("c.ply"), "--deadline", "100000"}).code, code(ExitCode::ok));
  expect_usage_error({"cage", in, "-o", path("c.ply"), "--deadline", "0"}, "--deadline");
  expect_usage_error({"cage", in, "-o", path("c.ply"), "--deadline", "-1"}, "--deadline");
}

TEST_F(Cli, ADeadlineDuringTheRunLeavesTheCageReachedSoFar) {
  const std::string in = shape("bumpy", 40000);
  // However fast or busy the machine is, one of these falls between the first cage and the last.
  Outcome late;
  for (double seconds = 0.1; seconds < 200 && late.code != code(ExitCode::deadline_reached); seconds *= 1.5)
    late = run({"cage", in, "-o", path("c.ply"), "--faces", "40", "--quality", "best", "--deadline",
                fmt::format("{}", seconds), "--stats", path("s.json")});
  ASSERT_EQ(late.code, code(ExitCode::deadline_reached));
  EXPECT_THAT(late.err, HasSubstr("deadline reached: the cage reached so far"));
  EXPECT_EQ(stats("s.json")["status"], "deadline_reached");
  EXPECT_EQ(stats("s.json")["cage_written"], true);
  EXPECT_EQ(run({"check", in, "--cage", path("c.ply")}).code, code(ExitCode::ok));
}

// ------------------------------------------------------------------------------------------------- interrupt

// The program says the size of its input when it starts to listen to signals.
bool wait_for_start(const std::string& stderr_path) {
  using namespace std::chrono_literals;
  for (int i = 0; i < 3000; ++i) {
    if (contents(stderr_path).find(" faces\n") != std::string::npos) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

class Interrupted : public Cli, public testing::WithParamInterface<int> {};

TEST_P(Interrupted, WritesTheValidCageReachedSoFar) {
  const std::string in = shape("bumpy", 60000);
  Process process = start({"cage", in, "-o", path("cage.ply"), "--stats", path("s.json")});
  ASSERT_TRUE(wait_for_start(path("stderr")));
  process.send(GetParam());
  EXPECT_EQ(process.wait(), code(ExitCode::interrupted));
  EXPECT_THAT(contents(path("stderr")), HasSubstr("interrupted: the cage reached so far"));
  EXPECT_EQ(stats("s.json")["status"], "cancelled");
  EXPECT_EQ(stats("s.json")["cage_written"], true);
  EXPECT_EQ(run({"check", in, "--cage", path("cage.ply")}).code, code(ExitCode::ok));
}

INSTANTIATE_TEST_SUITE_P(Cli, Interrupted, testing::Values(SIGINT, SIGTERM));

TEST_F(Cli, ASecondInterruptEndsTheProcessAtOnce) {
  Process process = start({"cage", shape("bumpy", 60000), "-o", path("cage.ply")});
  ASSERT_TRUE(wait_for_start(path("stderr")));
  EXPECT_EQ(process.wait_sending(SIGINT), -SIGINT);
  EXPECT_FALSE(exists("cage.ply"));
}

// --------------------------------------------------------------------------------------------------- render

TEST_F(Cli, RenderWritesAPicture) {
  const std::string in = file("in.ply", cube());
  EXPECT_EQ(run({"render", in, in, "-o", path("p.png"), "--width", "96", "--height", "64", "--samples", "1"}).code,
            code(ExitCode::ok));
  EXPECT_THAT(contents(path("p.png")), StartsWith("\x89PNG"));
  std::ofstream(path("broken.off")) << "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 77\n";
  const Outcome refused = run({"render", path("broken.off"), "-o", path("q.png")});
  EXPECT_EQ(refused.code, code(ExitCode::invalid_mesh));
  EXPECT_THAT(refused.err, HasSubstr("broken.off"));
  EXPECT_FALSE(exists("q.png"));
}

// A colour near the middle of what is left of the scale, but beside the diagonal of a face that fills it.
std::array<int, 3> color_beside_middle(const std::string& path) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_file(&image, path.c_str()), 0) << image.message;
  image.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
  EXPECT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0) << image.message;
  const std::size_t width = image.width, height = image.height;
  const std::size_t bar = static_cast<std::size_t>(scale_bar_width(static_cast<int>(width), static_cast<int>(height)));
  const std::uint8_t* pixel = &pixels[3 * (height / 2 * width + (width - bar) / 2 + height / 8)];
  return {pixel[0], pixel[1], pixel[2]};
}

// Seen from the front, the middle of the cage is at half a unit from the input, whose diagonal is sqrt(3).
TEST_F(Cli, RenderColoursByDistance) {
  Mesh large = cube();
  for (auto& p : large.positions)
    for (double& x : p) x = 2 * x - 0.5;
  const std::string in = file("in.ply", cube()), cage = file("cage.ply", large);
  const auto color_at = [&](const char* distance_max) {
    EXPECT_EQ(run({"render", in, cage, "-o", path("p.png"), "--single", "--distance", "--distance-max", distance_max,
                   "--width", "240", "--height", "120", "--samples", "1", "--azimuth", "0", "--elevation", "0"})
                  .code,
              code(ExitCode::ok));
    return color_beside_middle(path("p.png"));
  };
  // From the front nothing is shaded: yellow beyond the end of the scale, green in its middle, blue far below.
  const auto expect_near = [](const std::array<int, 3>& color, const std::array<int, 3>& expected) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(color[k], expected[k], 8) << k;
  };
  expect_near(color_at("0.2"), {253, 231, 37});
  expect_near(color_at("0.57735"), {33, 144, 141});
  expect_near(color_at("1"), {54, 91, 140});
  expect_usage_error({"render", in, "-o", path("q.png"), "--distance"}, "that of a cage");
  expect_usage_error({"render", in, cage, "-o", path("q.png"), "--distance-max", "0.1"}, "--distance");
  expect_usage_error({"render", in, cage, "-o", path("q.png"), "--distance", "--width", "100"}, "at least 200");
}

}  // namespace
}  // namespace prcage
