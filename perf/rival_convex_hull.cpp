// Contender of perf/contact: the convex hull, CGAL's. If it has more faces than wanted it is simplified as in
// rival_wrap_simplify.cpp, and then no longer encloses; it often has fewer.
//
// CGAL's 3D convex hulls and Surface_mesh_simplification are under the GPL-3.0-or-later, and so is this program as a
// whole.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <chrono>
#include <vector>

#include "perf/rival.h"
#include "perf/rival_surface.h"

namespace prcage::perf {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Hull = CGAL::Surface_mesh<Kernel::Point_3>;

Attempt hull_attempt(const Mesh& input, std::size_t faces) {
  const auto start = std::chrono::steady_clock::now();
  std::vector<Kernel::Point_3> points;
  points.reserve(input.positions.size());
  for (const auto& p : input.positions) points.emplace_back(p[0], p[1], p[2]);
  Hull hull;
  CGAL::convex_hull_3(points.begin(), points.end(), hull);
  const bool simplified = hull.number_of_faces() > faces;
  const std::size_t hull_faces = hull.number_of_faces();
  if (simplified) simplify(hull, faces);
  Mesh cage = to_mesh(hull);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  return {std::move(cage), seconds.count(), {{"hull_faces", hull_faces}, {"simplified", simplified}}};
}

}  // namespace
}  // namespace prcage::perf

int main(int argc, char** argv) {
  using namespace prcage;
  return perf::rival_main(argc, argv, [](const Mesh& input, std::size_t faces) {
    perf::Attempt attempt = perf::hull_attempt(input, faces);
    const double seconds = attempt.seconds;
    return perf::Search{std::move(attempt), seconds};
  });
}
