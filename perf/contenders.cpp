#include "perf/contenders.h"

#include <spawn.h>
#include <sys/wait.h>

#include <fstream>
#include <stdexcept>
#include <vector>

#include <fmt/core.h>

#include "io/mesh_file.h"
#include "perf/meshopt.h"
#include "tools/cli_files.h"
#include "tools/report_json.h"
#include "tools/shapes.h"

namespace prcage::perf {
namespace {

// The statistics under the names that the program gives them.
Json statistics_json(const Result& result, const Options& options) {
  CageCommand command;
  command.options = options;
  return Json::parse(run_json(command, nullptr, {result}, {}))["statistics"];
}

// The exit code of a program found by its path, its messages on this process's standard error.
int exit_code_of(const std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t process = 0;
  if (posix_spawn(&process, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0)
    throw std::runtime_error(words[0] + ": cannot be run");
  int status = 0;
  if (waitpid(process, &status, 0) != process || !WIFEXITED(status))
    throw std::runtime_error(words[0] + ": did not end by itself");
  return WEXITSTATUS(status);
}

}  // namespace

Json write_shape(const std::string& shape, std::size_t faces, std::uint64_t seed, const std::string& path) {
  std::string error;
  const Mesh mesh = make_shape(shape, faces, seed, error);
  if (!error.empty()) throw std::runtime_error(error);
  const WriteResult written = write_mesh(path, MeshFormat::ply_binary, mesh);
  if (!written.ok) throw std::runtime_error(written.error);
  return Json::object();
}

Json cage_mesh(const Mesh& mesh, const Options& options) {
  const Timer timer;
  const Result result = make_cage(mesh, options);
  const double seconds = timer.seconds();
  if (!result.has_cage()) throw std::runtime_error(fmt::format("{}: {}", to_string(result.status), result.message));
  Json statistics = statistics_json(result, options);
  std::size_t rounds = 0;
  for (const CycleStatistics& cycle : result.statistics.cycles) rounds += cycle.rounds;
  return {{"seconds", seconds},
          {"status", to_string(result.status)},
          {"faces", result.cage.triangles.size()},
          {"threads", result.statistics.threads},
          {"simd", result.statistics.simd},
          {"rounds", rounds},
          {"stages", statistics["seconds"]},
          {"counts", statistics["counts"]}};
}

Json simplify_meshopt(const Mesh& mesh, std::size_t target_faces) {
  const MeshoptResult result = simplify_by_meshopt(mesh, target_faces);
  return {{"seconds", result.seconds},
          {"faces", result.mesh.triangles.size()},
          {"target_faces", target_faces},
          {"relative_error", result.relative_error}};
}

Json run_program(const std::string& program, const std::string& input, const std::string& scratch,
                 const Options& options) {
  const std::string cage = scratch + "/cage.ply", stats = scratch + "/stats.json";
  std::vector<std::string> words{program,     "cage",
                                 input,       "--output",
                                 cage,        "--stats",
                                 stats,       "--quiet",
                                 "--threads", std::to_string(options.threads),
                                 "--tau",     fmt::format("{}", options.tau)};
  if (options.face_budget != 0) words.insert(words.end(), {"--faces", std::to_string(options.face_budget)});
  exit_code_of(words);
  std::ifstream file(stats);
  const Json run = Json::parse(file);
  if (!run["cage_written"].get<bool>()) throw std::runtime_error("the program wrote no cage: " + run["message"].dump());
  Json answer = run["seconds"];
  const double total = answer["total"], read = answer["read"], write = answer["write"];
  answer["io_share"] = (read + write) / total;
  return answer;
}

}  // namespace prcage::perf
