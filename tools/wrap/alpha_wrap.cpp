#include "tools/wrap/alpha_wrap.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>
#include <vector>

#include "core/adjacency.h"
#include "core/mesh_view.h"
#include "core/surface.h"
#include "io/mesh_file.h"
#include "parallel/arena.h"
#include "parallel/soup.h"
#include "parallel/stopwatch.h"
#include "parallel/validate.h"

namespace prcage {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Surface = CGAL::Surface_mesh<Point>;

// Where coordinates are so large that the offset drowns in their last bits, the wrap would not find an end.
// Circumcentres and intersections of the refinement are computed in doubles; ten digits leave them some room.
constexpr double least_offset = 1e-10;  // of the largest coordinate

struct Stopped {};

// Called before each step of the refinement. Throwing is the only way out of it.
class Watch : public CGAL::Alpha_wraps_3::internal::Wrapping_default_visitor {
 public:
  explicit Watch(Control* control) : control_(control) {}

  template <class Wrapper, class Gate>
  void before_facet_treatment(const Wrapper& wrapper, const Gate&) const {
    if (control_ == nullptr) return;
    if (control_->stopped()) throw Stopped();
    // A closed surface has about twice as many faces as vertices.
    control_->report(Control::Stage::wrap, 0, 2 * wrapper.triangulation().number_of_vertices(), 0);
  }

 private:
  Control* control_;
};

double largest_magnitude(const Mesh& mesh) {
  double largest = 0;
  for (const Position& p : mesh.positions)
    for (const double x : p) largest = std::max(largest, std::abs(x));
  return largest;
}

Mesh to_mesh(const Surface& surface) {
  Mesh mesh;
  for (const auto v : surface.vertices()) {
    const Point& p = surface.point(v);
    mesh.positions.push_back({p.x(), p.y(), p.z()});
  }
  for (const auto f : surface.faces()) {
    Triangle t{};
    std::size_t i = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(f))) t[i++] = static_cast<std::uint32_t>(v.idx());
    mesh.triangles.push_back(t);
  }
  return mesh;
}

Mesh wrap_of(const Mesh& faces, double alpha, double offset, Control* control) {
  std::vector<Point> points;
  points.reserve(faces.positions.size());
  for (const Position& p : faces.positions) points.emplace_back(p[0], p[1], p[2]);
  Surface surface;
  CGAL::alpha_wrap_3(points, faces.triangles, alpha, offset, surface, CGAL::parameters::default_values(),
                     CGAL::parameters::visitor(Watch(control)));
  return to_mesh(surface);
}

// Of the faces that have a place. Corners at equal positions count as one, since many files share no vertices between
// faces, and faces without area count, since they close cracks.
bool has_boundary(Mesh mesh) {
  weld_equal_positions(mesh);
  const auto& positions = mesh.positions;
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const auto placed = [&](std::uint32_t v) { return v < positions.size() && within_limits(positions[v]); };
    return !std::all_of(t.begin(), t.end(), placed) || t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
  });
  EdgeDefects defects;
  pair_halfedges(mesh.triangles, positions.size(), defects);
  return !defects.boundary.empty();
}

void fail(Wrap& wrap, Status status, std::string message) {
  wrap.status = status;
  wrap.message = std::move(message);
}

bool in_range(const WrapSettings& s) { return s.alpha >= 0 && s.alpha <= 1 && s.offset > 0 && s.offset <= 1; }

void make_wrap(Wrap& wrap, const MeshView& input, Control* control) {
  const Mesh mesh = to_mesh(input);
  Mesh faces;
  if (const std::string error = usable_faces(mesh, faces, wrap.dropped); !error.empty())
    return fail(wrap, Status::invalid_input, error);
  wrap.diagonal = extent(faces.positions).diagonal();
  if (wrap.settings.alpha == 0) wrap.settings.alpha = has_boundary(mesh) ? open_alpha : closed_alpha;
  const double alpha = wrap.settings.alpha * wrap.diagonal;
  const double offset = wrap.settings.offset * wrap.diagonal;
  if (offset < least_offset * largest_magnitude(faces))
    return fail(
        wrap, Status::invalid_input,
        "the input is too far from the origin for an alpha wrap with this offset: move it, or raise the offset");
  wrap.mesh = wrap_of(faces, alpha, offset, control);
  if (wrap.mesh.triangles.empty()) return fail(wrap, Status::internal_error, "the alpha wrap came out empty");
  wrap.status = Status::ok;
}

}  // namespace

bool has_alpha_wrap() { return true; }

Wrap alpha_wrap(const MeshView& input, const WrapSettings& settings, Control* control) {
  Wrap wrap;
  wrap.settings = settings;
  if (!in_range(settings)) {
    fail(wrap, Status::invalid_options, "alpha must be in [0, 1], offset in (0, 1]");
    return wrap;
  }
  {
    const Stopwatch watch(wrap.seconds);
    try {
      Arena(1).run([&] { make_wrap(wrap, input, control); });
    } catch (const Stopped&) {
      if (control->cancelled())
        fail(wrap, Status::cancelled, "cancelled during the alpha wrap");
      else
        fail(wrap, Status::deadline_reached, "the deadline has passed during the alpha wrap");
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      fail(wrap, Status::internal_error, error.what());
    }
  }
  return wrap;
}

}  // namespace prcage
