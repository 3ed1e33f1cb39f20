// Batches: the parts by themselves, and the commands batch and merge as processes that are stopped, killed and starved.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/mesh_file.h"
#include "program.h"
#include "solids.h"
#include "tools/batch_inputs.h"
#include "tools/batch_job.h"
#include "tools/batch_progress.h"
#include "tools/batch_table.h"
#include "tools/cli_options.h"
#include "tools/exit_codes.h"
#include "tools/shapes.h"

namespace prcage {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;  // address space is then reserved by the terabyte
#else
constexpr bool sanitized = false;
#endif

using Rows = std::vector<BatchRow>;

Rows rows_of(const std::string& table) {
  Rows rows;
  BatchTable(table, BatchTable::Open::existing).for_each([&rows](const BatchRow& row) { rows.push_back(row); });
  return rows;
}

std::string text_of(const BatchValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return std::to_string(*whole);
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
  return "NULL";
}

// Everything that the rows say but for when and how they were worked on: time, memory, threads.
std::vector<std::string> results(const Rows& rows) {
  const std::set<std::string> work{"process_seconds", "peak_memory_bytes", "finished", "threads"};
  std::vector<std::string> all;
  for (const BatchRow& row : rows) {
    std::string& line = all.emplace_back();
    for (const BatchColumn& column : batch_columns()) {
      const std::string name = column.name;
      if (!name.starts_with("seconds") && !work.contains(name)) line += name + " " + text_of(row[name]) + "; ";
    }
  }
  return all;
}

std::map<std::string, std::string> statuses(const Rows& rows) {
  std::map<std::string, std::string> by_mesh;
  for (const BatchRow& row : rows) by_mesh[row.text("mesh")] = row.text("status");
  return by_mesh;
}

std::int64_t whole(const BatchRow& row, const char* column) { return std::get<std::int64_t>(row[column]); }

class Batch : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = ::testing::TempDir() + "/prcage_batch_XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    directory_ = fs::canonical(name);
    fs::create_directory(path("in"));
  }
  void TearDown() override { fs::remove_all(directory_); }

  std::string path(const std::string& name) const { return directory_ / name; }

  void mesh(const std::string& name, const Mesh& mesh) const {
    MeshFormat format{};
    fs::create_directories(fs::path(path(name)).parent_path());
    EXPECT_TRUE(mesh_format_of_path(name, format));
    EXPECT_TRUE(write_mesh(path(name), format, mesh).ok);
  }

  void shape(const std::string& name, const std::string& kind, std::size_t faces, std::uint64_t seed = 0) const {
    std::string error;
    mesh(name, make_shape(kind, faces, seed, error));
    EXPECT_EQ(error, "");
  }

  void text(const std::string& name, const std::string& content) const { std::ofstream(path(name)) << content; }

  // A cube, one that is open, one that is cut short.
  void good_and_bad() const {
    mesh("in/good.ply", testing::cube());
    Mesh open = testing::cube();
    open.triangles.pop_back();
    mesh("in/sub/open.obj", open);
    text("in/short.ply", contents(path("in/good.ply")).substr(0, 300));
  }

  Process start(const std::vector<std::string>& arguments) const {
    return {arguments, "/dev/null", path("stdout"), path("stderr")};
  }
  int run(const std::vector<std::string>& arguments) const { return start(arguments).wait(); }
  int batch(const std::string& output, std::vector<std::string> options = {}) const {
    options.insert(options.begin(), {"batch", path("in"), "-o", path(output)});
    return run(options);
  }
  std::string errors() const { return contents(path("stderr")); }
  Rows table(const std::string& output) const { return rows_of(path(output + "/batch.sqlite")); }

  std::vector<std::string> files(const std::string& name) const {
    std::vector<std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(path(name))) {
      if (!entry.is_directory()) all.push_back(entry.path().lexically_relative(path(name)));
    }
    std::sort(all.begin(), all.end());
    return all;
  }

 private:
  fs::path directory_;
};

// ------------------------------------------------------------------------------------------------- inputs

TEST_F(Batch, MeshesOfADirectoryAreFoundAtAnyDepthButNotTheCages) {
  for (const char* name : {"in/b.STL", "in/a.ply", "in/deep/er/c.obj", "in/out/a.ply.cage.ply", "in/notes.txt"}) {
    fs::create_directories(fs::path(path(name)).parent_path());
    text(name, "x");
  }
  const auto inputs = find_batch_inputs(path("in"), path("in/out"));
  ASSERT_EQ(inputs.size(), 3u);
  EXPECT_EQ(inputs[0].mesh, "a.ply");
  EXPECT_EQ(inputs[0].file, path("in/a.ply"));
  EXPECT_EQ(inputs[0].bytes, 1u);
  EXPECT_EQ(inputs[1].mesh, "b.STL");
  EXPECT_EQ(inputs[2].mesh, "deep/er/c.obj");
}

TEST_F(Batch, AListNamesMeshesRelativeToItself) {
  text("in/list.txt", "# meshes\n\nb.ply\r\n./a.ply\nsub/../a.ply\n../outside.ply\n/nowhere/z.ply\n");
  std::vector<std::string> meshes, names;
  for (const BatchInput& input : find_batch_inputs(path("in/list.txt"), path("out"))) meshes.push_back(input.mesh);
  EXPECT_THAT(meshes, ElementsAre("../outside.ply", "/nowhere/z.ply", "a.ply", "b.ply"));
}

TEST(BatchInputs, CagesOfDifferentMeshesHaveDifferentNamesWithinTheDirectory) {
  std::set<std::string> names;
  const std::vector<std::string> meshes{"a.ply", "a.obj", "x/a.ply", "../a.ply", "/a.ply", "%2E%2E/a.ply", "%2F/a.ply"};
  for (const std::string& mesh : meshes) {
    const fs::path name = cage_name(mesh);
    EXPECT_TRUE(name.is_relative()) << mesh;
    EXPECT_EQ(name, name.lexically_normal()) << mesh;
    EXPECT_NE(*name.begin(), "..") << mesh;
    names.insert(name);
  }
  EXPECT_EQ(names.size(), meshes.size());
}

TEST(BatchInputs, ShardsPartitionTheMeshesByNameAlone) {
  std::vector<BatchInput> inputs;
  for (int i = 0; i < 1000; ++i) inputs.push_back({"set/" + std::to_string(i) + ".ply", "", 0});
  std::set<std::string> seen;
  for (std::size_t i = 1; i <= 7; ++i) {
    const auto shard = shard_of(inputs, {i, 7});
    EXPECT_GT(shard.size(), 90u);
    EXPECT_LT(shard.size(), 200u);
    for (const BatchInput& input : shard) EXPECT_TRUE(seen.insert(input.mesh).second) << input.mesh;
    const auto alone = shard_of({shard.front()}, {i, 7});
    EXPECT_EQ(alone.size(), 1u) << "the same without the others";
  }
  EXPECT_EQ(seen.size(), inputs.size());
}

// XXH3-64 of the names modulo 4, computed apart. A change would give the shards of a batch under way other meshes.
TEST(BatchInputs, ShardsStayWhatTheyAre) {
  EXPECT_EQ(shard_of({{"bunny.ply", "", 0}}, {3, 4}).size(), 1u);
  EXPECT_EQ(shard_of({{"organic/kitten.ply", "", 0}}, {1, 4}).size(), 1u);
}

TEST(BatchInputs, LargeFilesComeFirst) {
  std::vector<BatchInput> inputs{{"c", "", 5}, {"b", "", 5}, {"a", "", 1}, {"d", "", 9}};
  order_by_size(inputs);
  std::vector<std::string> order;
  for (const BatchInput& input : inputs) order.push_back(input.mesh);
  EXPECT_THAT(order, ElementsAre("d", "b", "c", "a"));
}

TEST(ShareCores, GivesEachMeshACoreWhileThereAreEnoughMeshes) {
  const auto share = [](int cores, std::size_t meshes, int jobs, int threads) {
    const CoreShare s = share_cores(cores, meshes, jobs, threads);
    return std::pair(s.jobs, s.threads);
  };
  EXPECT_EQ(share(8, 10000, 0, 0), std::pair(std::size_t{8}, 1));
  EXPECT_EQ(share(8, 2, 0, 0), std::pair(std::size_t{2}, 4));
  EXPECT_EQ(share(8, 10000, 2, 0), std::pair(std::size_t{2}, 4));
  EXPECT_EQ(share(8, 10000, 0, 4), std::pair(std::size_t{2}, 4));
  EXPECT_EQ(share(8, 10000, 0, 16), std::pair(std::size_t{1}, 16));
  EXPECT_EQ(share(8, 10000, 16, 3), std::pair(std::size_t{16}, 3)) << "as asked for";
  EXPECT_EQ(share(1, 0, 0, 0), std::pair(std::size_t{1}, 1));
}

// ------------------------------------------------------------------------------------------------ settings

CageCommand parsed_cage(std::vector<std::string> options) {
  std::vector<std::string> words{"prcage", "cage", "in.ply", "-o", "out.ply"};
  words.insert(words.end(), options.begin(), options.end());
  std::vector<const char*> pointers;
  for (const std::string& word : words) pointers.push_back(word.c_str());
  const CommandLine line = parse_command_line(static_cast<int>(pointers.size()), pointers.data());
  EXPECT_TRUE(line.command.has_value());
  return std::get<CageCommand>(*line.command);
}

TEST(CageArguments, AreTheSameForTheSameCageAndReadBackAsThemselves) {
  EXPECT_EQ(cage_arguments(parsed_cage({})),
            cage_arguments(parsed_cage({"--tau", "0.025", "--cycles", "10", "--threads", "7", "--quiet"})));
  for (const std::vector<std::string>& options : std::vector<std::vector<std::string>>{
           {},
           {"--tau", "1/3"},
           {"--tau-abs", "0.1", "--tau-mode", "paper"},
           {"--schedule", "1/8,1/3,1", "--faces", "100"},
           {"--sigma", "1/70000", "--seed", "18446744073709551615", "--format", "stl"},
           {"--no-edge-flips", "--flip", "--weld", "--cycles", "3"}}) {
    const std::vector<std::string> arguments = cage_arguments(parsed_cage(options));
    EXPECT_EQ(cage_arguments(parsed_cage(arguments)), arguments) << ::testing::PrintToString(options);
    EXPECT_EQ(arguments == cage_arguments(parsed_cage({})), options.empty()) << ::testing::PrintToString(options);
  }
}

// --------------------------------------------------------------------------------------------------- table

TEST_F(Batch, ATableKeepsWhatIsPutIntoIt) {
  BatchRow row;
  row.set("mesh", "a\"b'\xff.ply");
  row.set("settings", "--tau 0.1");
  row.set("status", "ok");
  row.set("cage_faces", std::int64_t{1} << 40);
  row.set("tau", 0.1);
  {
    BatchTable table(path("t.sqlite"), BatchTable::Open::or_create);
    table.put(row);
    row.set("cage_faces", std::int64_t{12});
    table.put(row);
  }
  const BatchTable table(path("t.sqlite"), BatchTable::Open::existing);
  const auto found = table.find("a\"b'\xff.ply", "--tau 0.1");
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->values(), row.values()) << "replaced, not doubled";
  EXPECT_EQ(rows_of(path("t.sqlite")).size(), 1u);
  EXPECT_FALSE(table.find("a\"b'\xff.ply", "--tau 0.2").has_value());
  EXPECT_THAT(table.settings(), ElementsAre("--tau 0.1"));
}

TEST_F(Batch, AChangeOfATableIsDoneWhollyOrNotAtAll) {
  BatchTable table(path("t.sqlite"), BatchTable::Open::or_create);
  BatchRow row;
  row.set("mesh", "a");
  row.set("settings", "");
  row.set("status", "ok");
  EXPECT_THROW(table.atomically([&] {
    table.put(row);
    throw std::runtime_error("on second thoughts");
  }),
               std::runtime_error);
  EXPECT_THAT(rows_of(path("t.sqlite")), IsEmpty());
}

TEST_F(Batch, WhatIsNotATableIsRefused) {
  text("poem.sqlite", "Shall I compare thee to a summer's day? Thou art more lovely and more temperate.");
  text("empty.sqlite", "");
  for (const char* name : {"poem.sqlite", "empty.sqlite", "nowhere.sqlite", "in"}) {
    try {
      const BatchTable table(path(name), BatchTable::Open::existing);
      ADD_FAILURE() << name;
    } catch (const BatchTableError& error) {
      EXPECT_THAT(error.what(), StartsWith(path(name) + ": "));
    }
  }
  EXPECT_FALSE(fs::exists(path("nowhere.sqlite")));
  EXPECT_EQ(contents(path("empty.sqlite")), "");
}

// ------------------------------------------------------------------------------------------------ progress

TEST(BatchProgress, EstimatesTheEndByTheSizeOfTheFiles) {
  const std::vector<BatchInput> inputs{{"large", "", 990000}, {"small", "", 90000}, {"tiny", "", 0}};
  BatchProgress progress(inputs);
  EXPECT_THAT(progress.line(1), AllOf(HasSubstr("  0 %"), HasSubstr("0/3 meshes"), Not(HasSubstr("left"))));
  BatchRow row;
  row.set("status", "timeout");
  progress.finish(inputs[0], row);
  EXPECT_THAT(progress.line(100),
              AllOf(HasSubstr("1/3 meshes, 1 without a cage"), HasSubstr("0.6 per minute"), HasSubstr("11 s left")));
}

TEST(BatchProgress, TellsTimesInUnitsThatPeopleRead) {
  EXPECT_EQ(duration_text(0.2), "0 s");
  EXPECT_EQ(duration_text(99), "99 s");
  EXPECT_EQ(duration_text(600), "10 min");
  EXPECT_EQ(duration_text(3600 * 3 + 299), "3 h 05 min");
}

// --------------------------------------------------------------------------------------------- what goes wrong

TEST_F(Batch, AMeshThatIsBadCostsThatMeshOnly) {
  good_and_bad();
  EXPECT_EQ(batch("out"), code(ExitCode::some_failed));
  const Rows rows = table("out");
  ASSERT_EQ(rows.size(), 3u);

  const BatchRow& good = rows[0];
  EXPECT_EQ(good.text("mesh"), "good.ply");
  EXPECT_EQ(good.text("status"), "ok");
  EXPECT_EQ(good["cause"], BatchValue{});
  EXPECT_EQ(whole(good, "exit_code"), 0);
  EXPECT_EQ(whole(good, "certified"), 1);
  EXPECT_EQ(whole(good, "encloses"), 1);
  EXPECT_EQ(whole(good, "input_faces"), 12);
  EXPECT_EQ(whole(good, "cage_faces"),
            static_cast<std::int64_t>(read_mesh(path("out/good.ply.cage.ply")).mesh.triangles.size()));
  EXPECT_GT(std::get<double>(good["seconds_displace"]), 0);
  EXPECT_GT(whole(good, "peak_memory_bytes"), 1 << 20);
  EXPECT_EQ(whole(good, "paper_success"), 1);
  EXPECT_GT(std::get<double>(good["hausdorff_cage_to_input_rel"]), 0);
  EXPECT_LE(std::get<double>(good["hausdorff_cage_to_input_rel"]), 1.0 / 40);
  EXPECT_EQ(std::get<double>(good["violation_max_rel"]), 0);
  EXPECT_GT(std::get<double>(good["volume_ratio"]), 1);

  EXPECT_EQ(rows[1].text("mesh"), "short.ply");
  EXPECT_EQ(rows[1].text("status"), "cannot_read");
  EXPECT_EQ(rows[1].text("cause"), "exit code");
  EXPECT_EQ(whole(rows[1], "exit_code"), code(ExitCode::cannot_read));
  EXPECT_THAT(rows[1].text("message"), HasSubstr("short.ply"));

  EXPECT_EQ(rows[2].text("mesh"), "sub/open.obj");
  EXPECT_EQ(rows[2].text("status"), "invalid_input");
  EXPECT_EQ(rows[2].text("defects"), "boundary_edge 3");
  EXPECT_EQ(rows[2]["cage_faces"], BatchValue{});
  EXPECT_EQ(rows[2]["cage_file"], BatchValue{});

  EXPECT_THAT(errors(), AllOf(HasSubstr("1 of 3 meshes have a cage (33.3 %)"), HasSubstr("boundary_edge 3"),
                              Not(HasSubstr("\x1b"))));
  EXPECT_THAT(files("out"), ElementsAre("batch.sqlite", "good.ply.cage.ply"));
}

TEST_F(Batch, AFileOfTheListThatIsNotThereIsARow) {
  mesh("in/good.ply", testing::cube());
  text("list", "in/good.ply\nin/missing.ply\n");
  EXPECT_EQ(run({"batch", path("list"), "-o", path("out"), "--quiet"}), code(ExitCode::some_failed));
  EXPECT_EQ(statuses(table("out")),
            (std::map<std::string, std::string>{{"in/good.ply", "ok"}, {"in/missing.ply", "cannot_read"}}));
  EXPECT_EQ(errors(), "");
}

TEST_F(Batch, AMeshThatTakesTooLongIsGivenUp) {
  shape("in/knot.ply", "knot", 60000);
  EXPECT_EQ(batch("out", {"--timeout", "0.05"}), code(ExitCode::some_failed));
  const Rows rows = table("out");
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].text("status"), "timeout");
  EXPECT_EQ(rows[0].text("cause"), "timeout");
  EXPECT_EQ(rows[0]["cage_faces"], BatchValue{});
  EXPECT_EQ(std::get<double>(rows[0]["timeout_seconds"]), 0.05);
  EXPECT_THAT(files("out"), ElementsAre("batch.sqlite")) << "a cage that depends on the moment is not kept";
}

TEST_F(Batch, AMeshThatNeedsTooMuchMemoryIsNamedSo) {
  if (sanitized) GTEST_SKIP() << "sanitizers reserve more address space than any limit";
  shape("in/knot.ply", "knot", 60000);
  for (const char* megabytes : {"20", "200"}) {  // not even the libraries; not the tables of the engine
    const std::string output = std::string("out") + megabytes;
    EXPECT_EQ(batch(output, {"--memory-limit", megabytes}), code(ExitCode::some_failed));
    const Rows rows = table(output);
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].text("status"), "out_of_memory") << rows[0].text("message");
    EXPECT_EQ(rows[0].text("cause"), "memory");
    EXPECT_EQ(whole(rows[0], "memory_limit_mb"), std::stoi(megabytes));
  }
}

// The child of a process that runs this command, as soon as it is there.
pid_t child_of(pid_t parent, const std::string& command) {
  const std::string file = "/proc/" + std::to_string(parent) + "/task/" + std::to_string(parent) + "/children";
  for (int i = 0; i < 3000; ++i) {
    std::istringstream children(contents(file));
    for (pid_t child = 0; children >> child;) {
      const std::string words = contents("/proc/" + std::to_string(child) + "/cmdline");
      if (words.find('\0' + command + '\0') != std::string::npos) return child;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return 0;
}

TEST_F(Batch, AProcessThatCrashesCostsItsMeshOnly) {
  shape("in/a-knot.ply", "knot", 60000);
  mesh("in/cube.ply", testing::cube());
  Process process = start({"batch", path("in"), "-o", path("out"), "--jobs", "1"});
  const pid_t child = child_of(process.id(), "cage");
  ASSERT_GT(child, 0);
  kill(child, SIGKILL);
  EXPECT_EQ(process.wait(), code(ExitCode::some_failed));
  const Rows rows = table("out");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].text("status"), "crashed");
  EXPECT_EQ(rows[0].text("cause"), "signal");
  EXPECT_EQ(whole(rows[0], "signal"), SIGKILL);
  EXPECT_EQ(rows[0]["exit_code"], BatchValue{});
  EXPECT_EQ(rows[1].text("status"), "ok");
}

TEST_F(Batch, ACageThatCannotBeMeasuredIsStillACage) {
  shape("in/bumpy.ply", "bumpy", 3000);
  Process process = start({"batch", path("in"), "-o", path("out")});
  const pid_t child = child_of(process.id(), "eval");
  ASSERT_GT(child, 0);
  kill(child, SIGKILL);
  EXPECT_EQ(process.wait(), code(ExitCode::ok));
  const Rows rows = table("out");
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].text("status"), "ok");
  EXPECT_THAT(rows[0].text("evaluation_failure"), StartsWith("crashed: Killed"));
  EXPECT_EQ(rows[0]["hausdorff_rel"], BatchValue{});
  EXPECT_TRUE(fs::exists(path("out/bumpy.ply.cage.ply")));
  EXPECT_THAT(errors(), HasSubstr("not measured: crashed"));
}

TEST_F(Batch, CagesAreNotMeasuredIfNotAskedFor) {
  mesh("in/cube.ply", testing::cube());
  EXPECT_EQ(batch("out", {"--no-eval"}), code(ExitCode::ok));
  const BatchRow row = table("out")[0];
  EXPECT_EQ(row["hausdorff_rel"], BatchValue{});
  EXPECT_EQ(row["evaluation_failure"], BatchValue{});
  EXPECT_EQ(batch("out", {"--resume"}), code(ExitCode::cannot_write)) << "a table is measured as a whole";
}

TEST_F(Batch, AMissedFaceBudgetHasACageAndACodeOfItsOwn) {
  mesh("in/cube.ply", testing::cube());
  EXPECT_EQ(batch("out", {"--faces", "4", "--tau", "1/500"}), code(ExitCode::face_budget_not_reached));
  EXPECT_EQ(table("out")[0].text("status"), "face_budget_not_reached");
  EXPECT_THAT(files("out"), ElementsAre("batch.sqlite", "cube.ply.cage.ply"));
}

// ------------------------------------------------------------------------------------------- stop and resume

TEST_F(Batch, AnExistingTableIsNotTouchedUnasked) {
  mesh("in/cube.ply", testing::cube());
  ASSERT_EQ(batch("out"), code(ExitCode::ok));
  const std::string before = contents(path("out/batch.sqlite"));
  EXPECT_EQ(batch("out"), code(ExitCode::cannot_write));
  EXPECT_THAT(errors(), HasSubstr("--resume"));
  EXPECT_EQ(batch("out", {"--resume", "--tau", "1/80"}), code(ExitCode::cannot_write));
  EXPECT_THAT(errors(), AllOf(HasSubstr("other settings"), HasSubstr("--tau 0.025 "), HasSubstr("--tau 0.0125 ")));
  fs::rename(path("in"), path("other"));
  EXPECT_EQ(run({"batch", path("other"), "-o", path("out"), "--resume"}), code(ExitCode::cannot_write));
  EXPECT_THAT(errors(), HasSubstr(path("in/cube.ply")));
  EXPECT_EQ(contents(path("out/batch.sqlite")), before);
}

TEST_F(Batch, ResumingMakesWhatIsMissingAndFailuresIfAsked) {
  good_and_bad();
  ASSERT_EQ(batch("out"), code(ExitCode::some_failed));
  mesh("in/late.ply", testing::cube());
  mesh("in/short.ply", testing::cube());
  EXPECT_EQ(batch("out", {"--resume", "--progress"}), code(ExitCode::some_failed));
  EXPECT_THAT(errors(), AllOf(HasSubstr("1/1 meshes"), HasSubstr("late.ply: ok: 12 faces -> ")));
  EXPECT_EQ(statuses(table("out"))["short.ply"], "cannot_read");
  EXPECT_EQ(batch("out", {"--resume", "--retry-failed"}), code(ExitCode::some_failed));
  EXPECT_EQ(statuses(table("out")),
            (std::map<std::string, std::string>{
                {"good.ply", "ok"}, {"late.ply", "ok"}, {"short.ply", "ok"}, {"sub/open.obj", "invalid_input"}}));
}

TEST_F(Batch, AnInterruptEndsTheProcessesAndLeavesNoHalfRow) {
  shape("in/knot.ply", "knot", 60000);
  Process process = start({"batch", path("in"), "-o", path("out")});
  const pid_t child = child_of(process.id(), "cage");
  ASSERT_GT(child, 0);
  process.send(SIGINT);
  EXPECT_EQ(process.wait(), code(ExitCode::interrupted));
  EXPECT_EQ(kill(child, 0), -1) << "the process is gone";
  EXPECT_THAT(errors(), HasSubstr("--resume"));
  EXPECT_THAT(table("out"), IsEmpty());
  EXPECT_THAT(files("out"), ElementsAre("batch.sqlite"));
}

TEST_F(Batch, TwoBatchesDoNotShareATable) {
  shape("in/knot.ply", "knot", 60000);
  Process first = start({"batch", path("in"), "-o", path("out")});
  ASSERT_GT(child_of(first.id(), "cage"), 0);
  EXPECT_EQ(Process({"batch", path("in"), "-o", path("out"), "--resume"}, "/dev/null", path("o"), path("e")).wait(),
            code(ExitCode::cannot_write));
  EXPECT_THAT(contents(path("e")), HasSubstr("belongs to a batch that runs now"));
  first.send(SIGTERM);
  EXPECT_EQ(first.wait(), code(ExitCode::interrupted));
}

std::size_t rows_so_far(const std::string& table) {
  try {
    return rows_of(table).size();
  } catch (const BatchTableError&) {  // not there yet
    return 0;
  }
}

// Killed a random time after it has made its next row, again and again.
TEST_F(Batch, SlowKilledAndResumedItEndsAsIfNothingHadHappened) {
  for (std::uint64_t i = 0; i < 9; ++i) shape("in/" + std::to_string(i) + ".ply", "bumpy", 1500, i);
  mesh("in/inside_out.ply", testing::inside_out(testing::cube()));
  ASSERT_EQ(batch("whole", {"--jobs", "1"}), code(ExitCode::some_failed));

  std::mt19937 random(7);
  const std::vector<std::string> resume{"batch", path("in"), "-o", path("killed"), "--resume", "--jobs", "2"};
  for (std::size_t kills = 1; kills <= 4; ++kills) {
    Process process = start(resume);
    while (rows_so_far(path("killed/batch.sqlite")) < kills) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 100));
    process.send(SIGKILL);
    ASSERT_EQ(process.wait(), -SIGKILL) << "too fast for this test";
  }
  ASSERT_LT(rows_so_far(path("killed/batch.sqlite")), 10u) << "too fast for this test";
  EXPECT_EQ(run(resume), code(ExitCode::some_failed));
  EXPECT_EQ(results(table("killed")), results(table("whole")));
  EXPECT_EQ(files("killed"), files("whole"));
  for (const std::string& file : files("whole")) {
    if (!file.ends_with(".ply")) continue;
    EXPECT_EQ(contents(path("killed/" + file)), contents(path("whole/" + file))) << file;
  }
}

// ---------------------------------------------------------------------------------------- shards and merge

class Shards : public Batch {
 protected:
  void SetUp() override {
    Batch::SetUp();
    for (int i = 0; i < 5; ++i) mesh("in/" + std::to_string(i) + ".off", testing::cube(1 + i));
    for (const char* shard : {"1/2", "2/2"}) ASSERT_EQ(batch("out", {"--shard", shard}), code(ExitCode::ok));
  }
  std::string first() const { return path("out/batch-1-of-2.sqlite"); }
  std::string second() const { return path("out/batch-2-of-2.sqlite"); }
};

TEST_F(Shards, MergedAreTheWhole) {
  ASSERT_EQ(batch("whole", {"--jobs", "3"}), code(ExitCode::ok));
  ASSERT_EQ(run({"merge", second(), first(), "-o", path("out/batch.sqlite")}), code(ExitCode::ok));
  EXPECT_THAT(errors(), AllOf(HasSubstr("5 of 5 meshes"), HasSubstr("0 duplicates")));
  EXPECT_EQ(results(table("out")), results(table("whole")));
  EXPECT_LT(rows_of(first()).size(), 5u);
  EXPECT_LT(rows_of(second()).size(), 5u);
}

TEST_F(Shards, MergedElsewhereStillNameTheirCages) {
  fs::create_directories(path("else/where"));
  ASSERT_EQ(run({"merge", first(), second(), "-o", path("else/where/all.sqlite")}), code(ExitCode::ok));
  for (const BatchRow& row : rows_of(path("else/where/all.sqlite"))) {
    EXPECT_TRUE(fs::exists(fs::path(path("else/where")) / row.text("cage_file"))) << row.text("cage_file");
  }
}

TEST_F(Shards, DuplicatesAreReportedAndTheFirstIsKept) {
  EXPECT_EQ(run({"merge", first(), second(), first(), "-o", path("all.sqlite")}), code(ExitCode::ok));
  EXPECT_EQ(rows_of(path("all.sqlite")).size(), 5u);
  EXPECT_THAT(errors(), HasSubstr(std::to_string(rows_of(first()).size()) + " duplicates"));
  EXPECT_THAT(errors(), HasSubstr("is there twice; the first is kept"));
}

TEST_F(Shards, DifferentSettingsAreMixedOnlyIfAsked) {
  ASSERT_EQ(batch("tight", {"--tau", "1/80"}), code(ExitCode::ok));
  const std::string tight = path("tight/batch.sqlite");
  EXPECT_EQ(run({"merge", first(), tight, "-o", path("all.sqlite")}), code(ExitCode::cannot_read));
  EXPECT_THAT(errors(), AllOf(HasSubstr("--mix-settings"), HasSubstr("--tau 0.0125 "), HasSubstr(tight)));
  EXPECT_FALSE(fs::exists(path("all.sqlite")));
  EXPECT_EQ(run({"merge", first(), second(), tight, "-o", path("all.sqlite"), "--mix-settings"}), code(ExitCode::ok));
  EXPECT_EQ(rows_of(path("all.sqlite")).size(), 10u);
}

TEST_F(Shards, AFileThatIsThereOrNoTableIsRefused) {
  EXPECT_EQ(run({"merge", first(), "-o", second()}), code(ExitCode::cannot_write));
  EXPECT_EQ(run({"merge", first(), path("in/0.off"), "-o", path("all.sqlite")}), code(ExitCode::cannot_read));
  EXPECT_THAT(errors(), HasSubstr("0.off"));
  EXPECT_FALSE(fs::exists(path("all.sqlite")));
}

// --------------------------------------------------------------------------------------------------- usage

TEST_F(Batch, MalformedCommandsAreRefusedBeforeAnythingIsMade) {
  mesh("in/cube.ply", testing::cube());
  for (const std::vector<std::string>& options : std::vector<std::vector<std::string>>{{"--shard", "0/2"},
                                                                                       {"--shard", "3/2"},
                                                                                       {"--shard", "1"},
                                                                                       {"--shard", "1/2x"},
                                                                                       {"--timeout", "0"},
                                                                                       {"--memory-limit", "0"},
                                                                                       {"--jobs", "-1"},
                                                                                       {"--tau", "2"},
                                                                                       {"--retry-failed"},
                                                                                       {"--quiet", "--progress"}}) {
    EXPECT_EQ(batch("out", options), code(ExitCode::usage)) << ::testing::PrintToString(options);
    EXPECT_THAT(errors(), HasSubstr(options[0]));
  }
  EXPECT_EQ(batch("in"), code(ExitCode::usage)) << "the cages would be taken for meshes";
  EXPECT_EQ(run({"batch", path("nowhere"), "-o", path("out")}), code(ExitCode::cannot_read));
  EXPECT_FALSE(fs::exists(path("out")));
}

}  // namespace
}  // namespace prcage
