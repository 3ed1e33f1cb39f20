// Distance queries: closest points on the input, the memo of the distance band when it is empty and when it is full,
// and the proof of strict tau. Queries are the centroids and the faces of a cage in the middle of a run.
#include "perf/bench_fixture.h"

namespace prcage::perf {
namespace {

struct Face {
  Vec3 a, b, c;
  Vec3 centroid() const { return (a + b + c) / 3; }
};

std::vector<Face> live_faces(const CornerTable& mesh) {
  std::vector<Face> faces;
  for (std::uint32_t f = 0; f < mesh.face_slots(); ++f) {
    if (!mesh.face_alive(f)) continue;
    const std::uint32_t* v = &mesh.corner_vertex[3 * std::size_t{f}];
    faces.push_back({mesh.vec_at(v[0]), mesh.vec_at(v[1]), mesh.vec_at(v[2])});
  }
  return faces;
}

struct Queries {
  Workload& workload = bumpy_workload(20);
  std::vector<Face> faces = live_faces(workload.state.mesh);

  // Empties the memo.
  void forget() {
    workload.band.set_voxel_size(1);
    workload.band.set_voxel_size(workload.placement.band.outer / 2);
  }
};

void nearest_face(benchmark::State& state) {
  const Queries queries;
  loop_in_arena(state, [&] {
    for (const Face& f : queries.faces) benchmark::DoNotOptimize(queries.workload.band.nearest(f.centroid()));
  });
  state.counters["queries"] = rate(queries.faces.size());
}
BENCHMARK(nearest_face)->ArgName("threads")->Arg(1);

void near_face_empty_memo(benchmark::State& state) {
  Queries queries;
  loop_in_arena(
      state, [&] { queries.forget(); },
      [&] {
        for (const Face& f : queries.faces) benchmark::DoNotOptimize(queries.workload.band.near(f.centroid()));
        queries.workload.band.absorb();
      });
  state.counters["queries"] = rate(queries.faces.size());
}
BENCHMARK(near_face_empty_memo)->ArgName("threads")->Arg(1);

void near_face_full_memo(benchmark::State& state) {
  const Queries queries;
  loop_in_arena(state, [&] {
    for (const Face& f : queries.faces) benchmark::DoNotOptimize(queries.workload.band.near(f.centroid()));
    queries.workload.band.absorb();
  });
  state.counters["queries"] = rate(queries.faces.size());
}
BENCHMARK(near_face_full_memo)->ArgName("threads")->Arg(1);

void within_tau(benchmark::State& state) {
  const Queries queries;
  const double tau = queries.workload.placement.band.outer;
  loop_in_arena(state, [&] {
    for (const Face& f : queries.faces) benchmark::DoNotOptimize(queries.workload.band.reach(f.a, f.b, f.c, tau));
    queries.workload.band.absorb();
  });
  state.counters["faces"] = rate(queries.faces.size());
}
BENCHMARK(within_tau)->ArgName("threads")->Arg(1);

}  // namespace
}  // namespace prcage::perf
