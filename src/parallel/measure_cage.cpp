// The measures of the paper's section 4: what a cage is worth, from its certificate to the shape of its triangles.
//
// Each surface is asked from points of the other: samples spread over the area give the means, and with the vertices
// and the middles of the edges the largest distance. Sums are taken in a fixed order, so that nothing depends on the
// number of threads.
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/angles.h"
#include "core/area_samples.h"
#include "core/mesh_view.h"
#include "parallel/arena.h"
#include "parallel/certify.h"
#include "parallel/closest_face.h"
#include "parallel/inverted_faces.h"
#include "parallel/parallel_for.h"
#include "parallel/silhouette.h"

namespace prcage {
namespace {

// Streams of random numbers: the points on the two surfaces are independent of each other.
constexpr std::uint64_t cage_stream = 0;
constexpr std::uint64_t input_stream = 1;

std::string options_error(const MeasureOptions& options) {
  const auto thickness = [](double tau) { return tau >= 0 && std::isfinite(tau); };
  if (!thickness(options.tau) || !thickness(options.tau_absolute)) return "tau must be a finite number, not negative";
  if (options.samples == 0) return "samples must be at least one";
  return {};
}

// A mesh that can be measured, and what both directions ask of it. Stays where it is: the tree borrows the arrays.
class Surface {
 public:
  Surface(const TreeDevice& device, const UnitFrame& frame, const Mesh& mesh)
      : mesh_(mesh), edges_(group_edges(mesh.triangles, mesh.positions.size())), tree_(device) {
    tree_.build(frame, mesh.positions, mesh.triangles);
    find_normals();
    EdgeDefects defects;
    pair_halfedges(mesh.triangles, edges_, defects);
    closed_ = defects.empty();
  }
  Surface(const Surface&) = delete;
  Surface& operator=(const Surface&) = delete;

  const Mesh& mesh() const { return mesh_; }
  bool closed() const { return closed_; }
  std::size_t edge_count() const { return edges_.size(); }
  const Vec3& normal(std::uint32_t face) const { return normals_[face]; }  // unit length; zero if there is none
  const SurfaceTree& tree() const { return tree_; }
  ClosestFace closest_face() const { return ClosestFace(tree_); }

  Vec3 edge_middle(std::size_t e) const {
    const std::uint32_t h = edges_[e][0];
    return 0.5 * (corner(h) + corner(next_halfedge(h)));
  }

 private:
  Vec3 corner(std::uint32_t h) const { return vec(mesh_.positions[mesh_.triangles[h / 3][h % 3]]); }

  // From the two shorter edges, which are the most accurate of slivers.
  Vec3 unit_normal(std::uint32_t face) const {
    const std::uint32_t h = 3 * face;
    const std::array<Vec3, 3> edge{corner(h + 1) - corner(h), corner(h + 2) - corner(h + 1), corner(h) - corner(h + 2)};
    const auto longest = static_cast<std::size_t>(
        std::max_element(edge.begin(), edge.end(),
                         [](const Vec3& a, const Vec3& b) { return a.squaredNorm() < b.squaredNorm(); }) -
        edge.begin());
    return edge[(longest + 1) % 3].cross(edge[(longest + 2) % 3]).stableNormalized();
  }

  void find_normals() {
    normals_.resize(mesh_.triangles.size());
    parallel_each(normals_.size(), default_grain,
                  [&](std::size_t f) { normals_[f] = unit_normal(static_cast<std::uint32_t>(f)); });
    for (const std::uint32_t f : degenerate_faces(mesh_.positions, mesh_.triangles)) normals_[f].setZero();
  }

  const Mesh& mesh_;
  EdgeGroups edges_;
  SurfaceTree tree_;
  std::vector<Vec3> normals_;
  bool closed_ = false;
};

// Sums over samples.
struct Sums {
  double distance = 0;
  double angle = 0;
  double excess = 0;  // of distances beyond tau
  double largest = 0;
  std::size_t angles = 0;  // a face without area has no normal
  std::size_t beyond = 0;

  Sums& operator+=(const Sums& o) {
    distance += o.distance;
    angle += o.angle;
    excess += o.excess;
    largest = std::max(largest, o.largest);
    angles += o.angles;
    beyond += o.beyond;
    return *this;
  }
};

// Measures the points of `from` against `to`. `tau` is absolute.
class Direction {
 public:
  Direction(const Surface& from, const Surface& to, double tau)
      : from_(from), to_(to), closest_(to.closest_face()), tau_(tau) {}

  Sums over(const AreaSamples& samples) const {
    return reduce(samples.size(), [&](std::size_t i, std::uint32_t hint, Sums& sums) {
      const AreaSamples::Sample sample = samples[i];
      const ClosestFace::Near near = add(sample.point, hint, sums);
      const Vec3& a = from_.normal(sample.face);
      const Vec3& b = to_.normal(near.face);
      if (!a.isZero(0) && !b.isZero(0)) {
        sums.angle += angle_degrees(a, b);
        ++sums.angles;
      }
      return near.face;
    });
  }

  // The largest distance of vertices and middles of edges.
  double farthest() const {
    const auto& positions = from_.mesh().positions;
    const Sums vertices = reduce(positions.size(), [&](std::size_t v, std::uint32_t hint, Sums& sums) {
      return add(vec(positions[v]), hint, sums).face;
    });
    const Sums middles = reduce(from_.edge_count(), [&](std::size_t e, std::uint32_t hint, Sums& sums) {
      return add(from_.edge_middle(e), hint, sums).face;
    });
    return std::max(vertices.largest, middles.largest);
  }

 private:
  ClosestFace::Near add(const Vec3& x, std::uint32_t hint, Sums& sums) const {
    const ClosestFace::Near near = closest_.nearest(x, hint);
    sums.distance += near.distance;
    sums.largest = std::max(sums.largest, near.distance);
    if (near.distance > tau_) {
      sums.excess += near.distance - tau_;
      ++sums.beyond;
    }
    return near;
  }

  // add_one(i, hint, sums) for i in [0, n), returning the face found: a hint for the next point, which is near by.
  template <class AddOne>
  static Sums reduce(std::size_t n, const AddOne& add_one) {
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, n, default_grain), Sums{},
        [&](const tbb::blocked_range<std::size_t>& range, Sums sums) {
          std::uint32_t hint = none;
          for (std::size_t i = range.begin(); i < range.end(); ++i) hint = add_one(i, hint, sums);
          return sums;
        },
        [](Sums a, const Sums& b) { return a += b; });
  }

  const Surface& from_;
  const Surface& to_;
  ClosestFace closest_;
  double tau_;
};

SmallestAngles smallest_angles(const Mesh& mesh) {
  std::vector<double> angles(mesh.triangles.size());
  parallel_each(angles.size(), default_grain, [&](std::size_t f) {
    const Triangle& t = mesh.triangles[f];
    const auto corners = corner_angles(vec(mesh.positions[t[0]]), vec(mesh.positions[t[1]]), vec(mesh.positions[t[2]]));
    angles[f] = *std::min_element(corners.begin(), corners.end());
  });
  std::sort(angles.begin(), angles.end());
  const double sum = std::accumulate(angles.begin(), angles.end(), 0.0);
  return {angles.front(), angles[angles.size() / 20], sum / static_cast<double>(angles.size())};
}

// Holds both meshes, and every point that is asked about.
UnitFrame common_frame(const Mesh& a, const Mesh& b) {
  std::vector<Position> corners;
  for (const Mesh* mesh : {&a, &b}) {
    const Extent box = extent(mesh->positions);
    corners.push_back(position(box.lower));
    corners.push_back(position(box.upper));
  }
  return unit_frame(corners);
}

class Evaluation {
 public:
  Evaluation(const Mesh& input, const Mesh& cage, const MeasureOptions& options, CageMeasures& measures)
      : options_(options),
        frame_(common_frame(input, cage)),
        input_(device_, frame_, input),
        cage_(device_, frame_, cage),
        measures_(measures) {}

  void run() {
    measures_.input_closed = input_.closed();
    measures_.diagonal = extent(input_.mesh().positions).diagonal();
    measure_sizes();
    measure_distances();
    measures_.smallest_angle = smallest_angles(cage_.mesh());
    measures_.inverted_faces = count_inverted_faces(device_, input_.tree(), cage_.tree());
    if (options_.views > 0)
      measures_.silhouette = measure_silhouettes(device_, frame_, input_.mesh(), cage_.mesh(), options_.views);
  }

 private:
  void measure_sizes() {
    const Measures input = measure(input_.mesh().positions, input_.mesh().triangles);
    const Measures cage = measure(cage_.mesh().positions, cage_.mesh().triangles);
    measures_.area_ratio = cage.area / input.area;
    if (input_.closed() && cage_.closed() && input.volume != 0) measures_.volume_ratio = cage.volume / input.volume;
  }

  void measure_distances() {
    const double l = measures_.diagonal;
    const double tau = options_.tau_absolute > 0 ? options_.tau_absolute : options_.tau * l;
    const Direction from_cage(cage_, input_, tau);
    const Sums sums = from_cage.over(samples(cage_, cage_stream));
    measures_.cage_to_input = deviation(sums, from_cage.farthest());
    if (tau > 0) measures_.violation = violation(sums, tau);
    const Direction from_input(input_, cage_, tau);
    measures_.input_to_cage = deviation(from_input.over(samples(input_, input_stream)), from_input.farthest());
  }

  AreaSamples samples(const Surface& surface, std::uint64_t stream) const {
    return {surface.mesh().positions, surface.mesh().triangles, options_.samples, CounterRandom(options_.seed, stream)};
  }

  SurfaceDeviation deviation(const Sums& sums, double farthest) const {
    const double l = measures_.diagonal;
    return {std::max(sums.largest, farthest) / l, sums.distance / static_cast<double>(options_.samples) / l,
            sums.angles > 0 ? sums.angle / static_cast<double>(sums.angles) : 0};
  }

  ThicknessViolation violation(const Sums& sums, double tau) const {
    const double l = measures_.diagonal;
    const auto n = static_cast<double>(options_.samples);
    return {tau / l, std::max(measures_.cage_to_input.hausdorff - tau / l, 0.0), sums.excess / n / l,
            static_cast<double>(sums.beyond) / n};
  }

  const MeasureOptions& options_;
  TreeDevice device_;
  UnitFrame frame_;
  Surface input_;
  Surface cage_;
  CageMeasures& measures_;
};

bool measurable(const Mesh& mesh, SubMesh& used) {
  return well_formed(mesh, used) && measure(used.mesh.positions, used.mesh.triangles).area > 0;
}

void refuse(CageMeasures& measures, const std::string& which) {
  measures.status = Status::invalid_input;
  measures.message = "the " + which +
                     " cannot be measured: it has no area, a face that does not name three existing vertices, or "
                     "coordinates that are not finite or out of range";
}

void evaluate(const Mesh& input, const Mesh& cage, const MeasureOptions& options, CageMeasures& measures) {
  SubMesh used_input;
  SubMesh used_cage;
  if (!measurable(input, used_input)) return refuse(measures, "input");
  if (!measurable(cage, used_cage)) return refuse(measures, "cage");
  measures.certificate = certify_meshes(used_input.mesh, used_cage.mesh);
  Evaluation(used_input.mesh, used_cage.mesh, options, measures).run();
  measures.status = Status::ok;
}

}  // namespace

CageMeasures measure_cage(const MeshView& input, const MeshView& cage, const MeasureOptions& options) {
  CageMeasures measures;
  measures.input_faces = input.triangle_count;
  measures.cage_faces = cage.triangle_count;
  if (const std::string error = options_error(options); !error.empty()) {
    measures.status = Status::invalid_options;
    measures.message = error;
    return measures;
  }
  Arena(options.threads).run([&] { evaluate(to_mesh(input), to_mesh(cage), options, measures); });
  return measures;
}

}  // namespace prcage
