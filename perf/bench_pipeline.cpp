// What happens once a run: validation and displacement of the input, the certificate, reading and writing binary PLY.
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>

#include <fmt/core.h>

#include "io/mesh_file.h"
#include "parallel/certify.h"
#include "parallel/validate.h"
#include "perf/bench_fixture.h"

namespace prcage::perf {
namespace {

void threads(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("threads")->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
}

void validation(benchmark::State& state) {
  const Workload& workload = bumpy_workload(100);
  loop_in_arena(state,
                [&] { benchmark::DoNotOptimize(validate_mesh(workload.input, workload.device).validation.faces); });
  state.counters["faces"] = rate(workload.input.triangles.size());
}
BENCHMARK(validation)->Apply(threads);

void displacement(benchmark::State& state) {
  const Workload& workload = bumpy_workload(100);
  loop_in_arena(state, [&] { benchmark::DoNotOptimize(workload.displaced().valid); });
  state.counters["faces"] = rate(workload.input.triangles.size());
}
BENCHMARK(displacement)->Apply(threads);

// Of a cage as large as the input, the hardest case.
void certificate(benchmark::State& state) {
  const Workload& workload = bumpy_workload(100);
  const Mesh cage = workload.state.mesh.to_mesh();
  std::unique_ptr<CheckedMesh> input;
  in_arena(0, [&] { input = std::make_unique<CheckedMesh>(validate_mesh(workload.input, workload.device)); });
  loop_in_arena(state,
                [&] { benchmark::DoNotOptimize(certify_cage(workload.device, enclosed(*input), cage).contacts); });
  state.counters["faces"] = rate(cage.triangles.size());
}
BENCHMARK(certificate)->Apply(threads);

// A file of this process in the system's directory for such, removed at the end.
class TemporaryFile {
 public:
  TemporaryFile() : path_(std::filesystem::temp_directory_path() / fmt::format("prcage-bench-{}.ply", getpid())) {}
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

void write_ply(benchmark::State& state) {
  const Mesh& mesh = bumpy_workload(100).input;
  const TemporaryFile file;
  for (auto _ : state) {
    if (!write_mesh(file.path(), MeshFormat::ply_binary, mesh).ok) state.SkipWithError("cannot write");
  }
  state.counters["faces"] = rate(mesh.triangles.size());
}
BENCHMARK(write_ply)->Unit(benchmark::kMillisecond)->UseRealTime();

void read_ply(benchmark::State& state) {
  const Mesh& mesh = bumpy_workload(100).input;
  const TemporaryFile file;
  if (!write_mesh(file.path(), MeshFormat::ply_binary, mesh).ok) state.SkipWithError("cannot write");
  for (auto _ : state) benchmark::DoNotOptimize(read_mesh(file.path()).mesh.positions.data());
  state.counters["faces"] = rate(mesh.triangles.size());
}
BENCHMARK(read_ply)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace prcage::perf
