// Contender: CGAL's surface mesh simplification of an offset. The offset is a fine alpha wrap at that distance, the
// simplification is CGAL's with its defaults (Lindstrom and Turk) down to the wanted number of edges. Nothing in it
// knows of the input; the offset has to be thick enough to leave room for what it does.
//
// CGAL's Alpha_wrap_3 and Surface_mesh_simplification are under the GPL-3.0-or-later, and so is this program as a
// whole.
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include <chrono>
#include <stdexcept>

#include "perf/rival.h"
#include "perf/rival_surface.h"
#include "tools/wrap/alpha_wrap.h"

namespace prcage::perf {
namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;
using Surface = CGAL::Surface_mesh<Point>;

Surface to_surface(const Mesh& mesh) {
  Surface surface;
  for (const auto& p : mesh.positions) surface.add_vertex(Point(p[0], p[1], p[2]));
  using Vertex = Surface::Vertex_index;
  for (const auto& t : mesh.triangles) surface.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2]));
  return surface;
}

Attempt simplified_wrap(const Mesh& input, std::size_t faces, double offset) {
  const Wrap wrap = alpha_wrap(input, {closed_alpha, offset});
  if (wrap.status != Status::ok) throw std::runtime_error(wrap.message);
  const auto start = std::chrono::steady_clock::now();
  Surface surface = to_surface(wrap.mesh);
  simplify(surface, faces);
  Mesh cage = to_mesh(surface);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  return {std::move(cage), wrap.seconds + seconds.count(), {{"alpha", closed_alpha}, {"offset", offset}}};
}

}  // namespace
}  // namespace prcage::perf

int main(int argc, char** argv) {
  using namespace prcage;
  return perf::rival_main(argc, argv, [](const Mesh& input, std::size_t faces) {
    return perf::tightest_attempt(input, faces,
                                  [&](double offset) { return perf::simplified_wrap(input, faces, offset); });
  });
}
