// Contender: meshopt_simplify(), which knows of no enclosure: how fast edges can be collapsed at all.
#include <utility>

#include "perf/meshopt.h"
#include "perf/rival.h"

int main(int argc, char** argv) {
  using namespace prcage;
  return perf::rival_main(argc, argv, [](const Mesh& input, std::size_t faces) {
    perf::MeshoptResult result = perf::simplify_by_meshopt(input, faces);
    perf::Search search;
    search.seconds = search.kept.seconds = result.seconds;
    search.kept.cage = std::move(result.mesh);
    return search;
  });
}
