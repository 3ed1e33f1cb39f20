// The ladder of sizes, end to end: prcage on two threads, the reference simplifier to the same number of faces, and
// prcage on one thread, in turn, on meshes of growing size. Every measurement is a process of its own; minimum and
// median of the repetitions, ratios, time by stage, peak memory, the share of input and output and the exponents of
// growth between sizes are written as JSON. Figures of one run were taken under the same conditions and may be compared
// with each other; figures of two runs may not (see compare-revisions).
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "io/mesh_file.h"
#include "perf/child.h"
#include "perf/contenders.h"
#include "tools/cli_files.h"

namespace prcage::perf {
namespace {

struct Command {
  std::vector<std::string> files;
  std::vector<std::string> shapes;
  std::vector<std::size_t> sizes{15625, 62500, 250000, 1000000, 4000000};
  std::size_t budget = 0;
  double tau = Options{}.tau;
  std::size_t repetitions = 3;
  double seconds = 300;
  std::string program = PRCAGE_PROGRAM;
  std::string output = "-";
};

// A directory that goes with its owner.
class ScratchDirectory {
 public:
  ScratchDirectory() {
    std::string name = (std::filesystem::temp_directory_path() / "prcage-ladder-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error(name + ": cannot be made");
    path_ = name;
  }
  ~ScratchDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchDirectory(const ScratchDirectory&) = delete;
  ScratchDirectory& operator=(const ScratchDirectory&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// One mesh of the ladder. Meshes of one family differ in size only.
struct Rung {
  std::string family;
  std::string file;       // of the mesh; empty: a shape, to be made
  std::size_t faces = 0;  // of the shape that is asked for
};

// "bunny-62694.ply" belongs to the family "bunny".
std::string family_of(const std::string& file) {
  std::string stem = std::filesystem::path(file).stem().string();
  const std::size_t dash = stem.find_last_not_of("0123456789");
  if (dash != std::string::npos && dash > 0 && stem[dash] == '-') stem.resize(dash);
  return stem;
}

std::vector<Rung> rungs_of(const Command& command) {
  std::vector<Rung> rungs;
  for (const std::string& shape : command.shapes)
    for (const std::size_t faces : command.sizes) rungs.push_back({shape, "", faces});
  for (const std::string& file : command.files) rungs.push_back({family_of(file), file, 0});
  return rungs;
}

// The repetitions of one contender.
class Series {
 public:
  void add(const Json& run) { runs_.push_back(run); }

  const Json& fastest() const {
    return *std::min_element(runs_.begin(), runs_.end(),
                             [](const Json& a, const Json& b) { return seconds(a) < seconds(b); });
  }
  double minimum() const { return seconds(fastest()); }

  // The fastest run with the times of all and the highest memory of any.
  Json json() const {
    std::vector<double> all;
    std::uint64_t memory = 0;
    for (const Json& run : runs_) {
      all.push_back(seconds(run));
      memory = std::max(memory, run["peak_memory_bytes"].get<std::uint64_t>());
    }
    Json json = fastest();
    json["peak_memory_bytes"] = memory;
    json["seconds"] = {{"minimum", minimum()}, {"median", median(all)}, {"all", all}};
    return json;
  }

 private:
  static double seconds(const Json& run) { return run["seconds"]; }

  static double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
  }

  std::vector<Json> runs_;
};

class Ladder {
 public:
  explicit Ladder(const Command& command) : command_(command) {}

  Json run() {
    Json rungs = Json::array();
    for (const Rung& rung : rungs_of(command_)) rungs.push_back(climb(rung));
    return {
        {"schema", 1},
        {"tool", {{"name", "prcage_ladder"}, {"version", version()}}},
        {"machine", machine()},
        {"options", {{"tau", command_.tau}, {"face_budget", command_.budget}, {"repetitions", command_.repetitions}}},
        {"rungs", rungs},
        {"growth", growth(rungs)}};
  }

 private:
  Json climb(const Rung& rung) {
    std::string file = rung.file;
    if (file.empty()) {
      file = scratch_.path() + "/mesh.ply";
      run_in_child([&] { return write_shape(rung.family, rung.faces, 0, file); });
    }
    const MeshFile input = read_mesh(file);
    if (!input.ok) throw std::runtime_error(input.error);
    fmt::print(stderr, "{} {}", rung.family, input.mesh.triangles.size());
    Json json{
        {"family", rung.family}, {"faces", input.mesh.triangles.size()}, {"vertices", input.mesh.positions.size()}};
    measure(input.mesh, json);
    if (!command_.program.empty())
      json["program"] = run_in_child([&] { return run_program(command_.program, file, scratch_.path(), options(2)); });
    fmt::print(stderr, "\n");
    return json;
  }

  Options options(int threads) const {
    Options options;
    options.tau = command_.tau;
    options.face_budget = command_.budget;
    options.threads = threads;
    return options;
  }

  // The contenders take turns, so that whatever else the machine does befalls them all.
  void measure(const Mesh& mesh, Json& json) const {
    Series two, one, meshopt;
    const Timer timer;
    for (std::size_t k = 0; k < command_.repetitions && (k == 0 || timer.seconds() < command_.seconds); ++k) {
      two.add(run_in_child([&] { return cage_mesh(mesh, options(2)); }));
      const std::size_t faces = two.fastest()["faces"];
      meshopt.add(run_in_child([&] { return simplify_meshopt(mesh, faces); }));
      one.add(run_in_child([&] { return cage_mesh(mesh, options(1)); }));
      fmt::print(stderr, "  {:.2f} {:.3f} {:.2f} s", two.minimum(), meshopt.minimum(), one.minimum());
    }
    json["prcage"] = {{"1", one.json()}, {"2", two.json()}};
    json["meshopt"] = meshopt.json();
    json["ratio"] = {{"1", one.minimum() / meshopt.minimum()}, {"2", two.minimum() / meshopt.minimum()}};
    json["speed_up"] = one.minimum() / two.minimum();
  }

  static double minimum(const Json& contender) { return contender["seconds"]["minimum"]; }

  // log(t2 / t1) / log(n2 / n1) between rungs that follow each other in one family: 1 is linear.
  static Json growth(const Json& rungs) {
    Json steps = Json::array();
    for (std::size_t i = 1; i < rungs.size(); ++i) {
      const Json &small = rungs[i - 1], &large = rungs[i];
      if (small["family"] != large["family"] || small["faces"] == large["faces"]) continue;
      const double sizes = std::log(large["faces"].get<double>() / small["faces"].get<double>());
      const auto exponent = [&](const Json& a, const Json& b) { return std::log(minimum(b) / minimum(a)) / sizes; };
      steps.push_back({{"family", small["family"]},
                       {"from", small["faces"]},
                       {"to", large["faces"]},
                       {"prcage",
                        {{"1", exponent(small["prcage"]["1"], large["prcage"]["1"])},
                         {"2", exponent(small["prcage"]["2"], large["prcage"]["2"])}}},
                       {"meshopt", exponent(small["meshopt"], large["meshopt"])}});
    }
    return steps;
  }

  static Json machine() {
    std::string model, line;
    std::ifstream processors("/proc/cpuinfo");
    while (model.empty() && std::getline(processors, line))
      if (line.starts_with("model name")) model = line.substr(line.find(':') + 2);
    double load[1] = {0};
    getloadavg(load, 1);
    utsname system{};
    uname(&system);
    return {{"processor", model},
            {"cores", std::thread::hardware_concurrency()},
            {"system", fmt::format("{} {}", system.sysname, system.release)},
            {"compiler", __VERSION__},
            {"load_at_end", load[0]}};
  }

  const Command& command_;
  ScratchDirectory scratch_;
};

int run(int argc, char** argv) {
  Command command;
  CLI::App app("Measures prcage against meshopt_simplify on meshes of growing size.");
  app.option_defaults()->always_capture_default();
  app.add_option("FILES", command.files, "Meshes, in ascending size; NAME-FACES.ply are rungs of one ladder");
  app.add_option("--shapes", command.shapes, "Built-in shapes to climb with [bumpy if there are no FILES]")
      ->delimiter(',');
  app.add_option("--sizes", command.sizes, "Faces of the built-in shapes")->delimiter(',');
  app.add_option("--budget", command.budget, "Faces of the cage; 0: as few as tau allows");
  app.add_option("--tau", command.tau, "Thickness of the band, relative to the diagonal");
  app.add_option("-k,--repetitions", command.repetitions, "Turns of all contenders at each size")
      ->check(CLI::PositiveNumber);
  app.add_option("--seconds", command.seconds, "Begin no further turn at a size that has taken so long");
  app.add_option("--program", command.program, "Program whose input and output are timed; empty: none");
  app.add_option("-o,--output", command.output, "JSON file to write; - is standard output");
  CLI11_PARSE(app, argc, argv);
  if (command.shapes.empty() && command.files.empty()) command.shapes = {"bumpy"};
  const Json result = Ladder(command).run();
  return static_cast<int>(write_text(command.output, result.dump(2) + "\n"));
}

}  // namespace
}  // namespace prcage::perf

int main(int argc, char** argv) {
  try {
    return prcage::perf::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "\nprcage_ladder: {}\n", error.what());
    return 1;
  }
}
