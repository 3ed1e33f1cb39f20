#include "perf/rival.h"

#include <charconv>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <utility>

#include "io/mesh_file.h"

namespace prcage::perf {
namespace {

int rank(const Mesh& input, std::size_t faces, const Mesh& cage) {
  if (cage.triangles.empty()) return 0;
  if (cage.triangles.size() > faces) return 1;
  const PaperConditions conditions = paper_conditions(certify(input, cage, 1));
  if (conditions.success()) return 4;
  return conditions.self_intersection_free && conditions.manifold && conditions.strictly_encloses ? 3 : 2;
}

bool parse_faces(const char* text, std::size_t& faces) {
  const char* const end = text + std::strlen(text);
  const auto [stop, error] = std::from_chars(text, end, faces);
  return error == std::errc{} && stop == end && faces >= 4;
}

int fail(const std::string& message) {
  std::fprintf(stderr, "%s\n", message.c_str());
  return 1;
}

int run(const char* input, std::size_t faces, const char* output,
        const std::function<Search(const Mesh&, std::size_t)>& search) {
  const MeshFile file = read_mesh(input);
  if (!file.ok) return fail(file.error);
  const Search found = search(file.mesh, faces);
  if (found.kept.cage.triangles.empty()) return fail("no attempt came to a mesh");
  const WriteResult written = write_mesh(output, MeshFormat::ply_binary, found.kept.cage);
  if (!written.ok) return fail(written.error);
  const nlohmann::ordered_json report{{"seconds", found.kept.seconds},
                                      {"search_seconds", found.seconds},
                                      {"faces", found.kept.cage.triangles.size()},
                                      {"settings", found.kept.settings}};
  std::printf("%s\n", report.dump().c_str());
  return 0;
}

}  // namespace

std::vector<double> offset_ladder() {
  constexpr double thinnest = 1.0 / 400, factor = 1.6;
  constexpr std::size_t rungs = 9;
  std::vector<double> offsets{thinnest};
  while (offsets.size() < rungs) offsets.push_back(factor * offsets.back());
  return offsets;
}

Search tightest_attempt(const Mesh& input, std::size_t faces, const std::function<Attempt(double offset)>& attempt) {
  Search search;
  int best = 0;
  for (const double offset : offset_ladder()) {
    Attempt next = attempt(offset);
    search.seconds += next.seconds;
    const int its_rank = rank(input, faces, next.cage);
    if (its_rank <= best) continue;
    best = its_rank;
    search.kept = std::move(next);
    if (best == 4) break;
  }
  return search;
}

int rival_main(int argc, char** argv, const std::function<Search(const Mesh&, std::size_t)>& search) {
  std::size_t faces = 0;
  if (argc != 4 || !parse_faces(argv[2], faces)) return fail("usage: " + std::string(argv[0]) + " INPUT FACES OUTPUT");
  try {
    return run(argv[1], faces, argv[3], search);
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}

}  // namespace prcage::perf
