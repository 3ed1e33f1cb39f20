#include "tools/page_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <meshoptimizer.h>
#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>

#include "core/surface.h"
#include "core/vec3.h"
#include "io/mesh_file.h"
#include "parallel/arena.h"
#include "parallel/closest_face.h"
#include "parallel/intersections.h"
#include "parallel/parallel_for.h"
#include "tools/report_measures.h"

namespace prcage {
namespace {

constexpr double top = 65535;  // of 16 bits

// -------------------------------------------------------------------------------------------------- meshes

// What can be drawn of a mesh file, or the reason why nothing can.
struct Drawable {
  std::string error;
  Mesh mesh;
};

// Vertices that no face uses are left out.
Mesh compacted(const Mesh& mesh) {
  constexpr std::uint32_t unused = ~std::uint32_t{0};
  std::vector<std::uint32_t> place(mesh.positions.size(), unused);
  Mesh compact;
  compact.triangles = mesh.triangles;
  for (auto& triangle : compact.triangles) {
    for (std::uint32_t& v : triangle) {
      if (place[v] == unused) {
        place[v] = static_cast<std::uint32_t>(compact.positions.size());
        compact.positions.push_back(mesh.positions[v]);
      }
      v = place[v];
    }
  }
  return compact;
}

Drawable read_drawable(const std::string& path) {
  MeshFile file = read_mesh(path);
  if (!file.ok) return {file.error, {}};
  const std::size_t faces = file.mesh.triangles.size();
  const std::size_t usable = count_usable_faces(file.mesh);
  if (faces == 0 || usable < faces)
    return {fmt::format("{}: {} of its {} faces can be drawn", path, usable, faces), {}};
  return {{}, compacted(file.mesh)};
}

// For the eye only: at most page_faces faces on vertices of the mesh.
Mesh simplified(const Mesh& mesh) {
  const UnitFrame frame = unit_frame(mesh.positions);
  std::vector<float> positions;
  for (const Position& p : mesh.positions) {
    const Vec3 x = (vec(p) - frame.centre) * frame.scale;
    for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(x[k]));
  }
  std::vector<unsigned> indices;
  for (const Triangle& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());

  constexpr float any_error = 1e10F;
  constexpr std::size_t stride = 3 * sizeof(float);
  std::vector<unsigned> left(indices.size());
  std::size_t count = meshopt_simplify(left.data(), indices.data(), indices.size(), positions.data(),
                                       mesh.positions.size(), stride, 3 * page_faces, any_error);
  if (count > 3 * page_faces) {  // stopped by the topology, which does not matter here
    count = meshopt_simplifySloppy(left.data(), indices.data(), indices.size(), positions.data(), mesh.positions.size(),
                                   stride, 3 * page_faces, any_error);
  }
  Mesh result;
  result.positions = mesh.positions;
  for (std::size_t i = 0; i + 2 < count; i += 3) result.triangles.push_back({left[i], left[i + 1], left[i + 2]});
  return compacted(result);
}

// ------------------------------------------------------------------------------------------------ distances

// Points of a face that cut each of its edges into `parts`: row by row, from the edge of the first two corners to the
// third corner.
std::size_t lattice_size(std::size_t parts) { return (parts + 1) * (parts + 2) / 2; }

template <class Visit>
void for_each_lattice_point(const Mesh& mesh, const Triangle& face, std::size_t parts, const Visit& visit) {
  const Vec3 a = vec(mesh.positions[face[0]]);
  const Vec3 b = vec(mesh.positions[face[1]]);
  const Vec3 c = vec(mesh.positions[face[2]]);
  const auto n = static_cast<double>(parts);
  for (std::size_t row = 0; row <= parts; ++row) {
    for (std::size_t i = 0; i + row <= parts; ++i) {
      const double u = static_cast<double>(i) / n;
      const double v = static_cast<double>(row) / n;
      visit(Vec3(a + u * (b - a) + v * (c - a)));
    }
  }
}

// Large faces are cut finer: far between its corners a face is where the input is not.
class Subdivision {
 public:
  explicit Subdivision(const Mesh& mesh) {
    constexpr std::size_t most_points = 60000;
    const double diagonal = extent(mesh.positions).diagonal();
    double length = diagonal / 100;
    do {
      cut(mesh, length);
      length *= 1.5;
    } while (points() > most_points && length < diagonal);
  }

  std::size_t points() const { return first_.back(); }
  std::size_t first(std::size_t face) const { return first_[face]; }
  std::size_t parts(std::size_t face) const { return parts_[face]; }

 private:
  void cut(const Mesh& mesh, double length) {
    constexpr double most_parts = 40;
    parts_.clear();
    first_.assign(1, 0);
    for (const Triangle& t : mesh.triangles) {
      double longest = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        longest = std::max(longest, (vec(mesh.positions[t[k]]) - vec(mesh.positions[t[(k + 1) % 3]])).norm());
      }
      parts_.push_back(static_cast<std::uint8_t>(std::clamp(std::ceil(longest / length), 1.0, most_parts)));
      first_.push_back(first_.back() + lattice_size(parts_.back()));
    }
  }

  std::vector<std::uint8_t> parts_;
  std::vector<std::size_t> first_;
};

std::vector<double> distances(const Mesh& cage, const Subdivision& subdivision, const Mesh& input) {
  std::vector<double> all(subdivision.points());
  Arena(0).run([&] {
    const TreeDevice device;
    std::vector<Position> points = input.positions;
    points.insert(points.end(), cage.positions.begin(), cage.positions.end());
    SurfaceTree tree(device);
    tree.build(unit_frame(points), input.positions, input.triangles);
    const ClosestFace closest(tree);
    parallel_each(cage.triangles.size(), 16, [&](std::size_t f) {
      std::size_t i = subdivision.first(f);
      std::uint32_t hint = none;
      for_each_lattice_point(cage, cage.triangles[f], subdivision.parts(f), [&](const Vec3& x) {
        const ClosestFace::Near near = closest.nearest(x, hint);
        hint = near.face;
        all[i++] = near.distance;
      });
    });
  });
  return all;
}

// --------------------------------------------------------------------------------------------------- arrays

class Arrays {
 public:
  // The cube above the lower corner of both meshes' box is what positions are relative to.
  Arrays(const Mesh& input, const Mesh* cage) {
    std::vector<Position> corners = ends(input);
    if (cage != nullptr) {
      const std::vector<Position> more = ends(*cage);
      corners.insert(corners.end(), more.begin(), more.end());
    }
    const Extent box = extent(corners);
    lower_ = box.lower;
    size_ = (box.upper - box.lower).maxCoeff();
  }

  nlohmann::ordered_json cube() const { return {{"lower", {lower_[0], lower_[1], lower_[2]}}, {"size", size_}}; }

  void add(const Mesh& mesh) {
    for (const Position& p : mesh.positions) {
      for (int k = 0; k < 3; ++k) add_part(size_ > 0 ? (vec(p)[k] - lower_[k]) / size_ : 0);
    }
    for (const Triangle& t : mesh.triangles) {
      for (const std::uint32_t v : t) add_16(v);
    }
  }

  void add_part(double of_one) { add_16(static_cast<std::uint32_t>(std::lround(std::clamp(of_one, 0.0, 1.0) * top))); }
  void add_8(std::size_t value) { bytes_.push_back(static_cast<char>(value)); }

  std::string take() { return std::move(bytes_); }

 private:
  static std::vector<Position> ends(const Mesh& mesh) {
    const Extent box = extent(mesh.positions);
    return {position(box.lower), position(box.upper)};
  }

  void add_16(std::uint32_t value) {
    add_8(value & 0xff);
    add_8(value >> 8);
  }

  Vec3 lower_;
  double size_ = 0;
  std::string bytes_;
};

nlohmann::ordered_json sizes(const Mesh& mesh) {
  return {{"vertices", mesh.positions.size()}, {"faces", mesh.triangles.size()}};
}

}  // namespace

PageModel page_model(const std::string& input_file, const std::string& cage_file) {
  PageModel model;
  const Drawable input = read_drawable(input_file);
  const Drawable cage = cage_file.empty() || !input.error.empty() ? Drawable{} : read_drawable(cage_file);
  model.error = input.error.empty() ? cage.error : input.error;
  if (cage.mesh.triangles.size() > page_faces) {
    model.error = fmt::format("the cage has {} faces, more than {}", cage.mesh.triangles.size(), page_faces);
  }
  if (!model.error.empty()) return model;

  const bool small = input.mesh.triangles.size() <= page_faces;
  const Mesh shown = small ? Mesh{} : simplified(input.mesh);
  const Mesh& drawn = small ? input.mesh : shown;
  Arrays arrays(drawn, cage_file.empty() ? nullptr : &cage.mesh);
  arrays.add(drawn);
  model.contents = {{"cube", arrays.cube()}, {"input", sizes(drawn)}};
  model.contents["input"]["faces_of_file"] = input.mesh.triangles.size();
  if (!cage_file.empty()) {
    const Subdivision subdivision(cage.mesh);
    const std::vector<double> all = distances(cage.mesh, subdivision, input.mesh);
    const double largest = *std::max_element(all.begin(), all.end());
    arrays.add(cage.mesh);
    for (const double distance : all) arrays.add_part(largest > 0 ? distance / largest : 0);
    for (std::size_t f = 0; f < cage.mesh.triangles.size(); ++f) arrays.add_8(subdivision.parts(f));
    model.contents["cage"] = sizes(cage.mesh);
    model.contents["cage"]["points"] = all.size();
    model.contents["largest_distance"] = largest;
  }
  model.bytes = arrays.take();
  return model;
}

std::string base64(std::string bytes) {
  using boost::archive::iterators::base64_from_binary;
  using boost::archive::iterators::transform_width;
  using Text = base64_from_binary<transform_width<std::string::const_iterator, 6, 8>>;
  bytes.resize((bytes.size() + 2) / 3 * 3, '\0');
  return {Text(bytes.cbegin()), Text(bytes.cend())};
}

}  // namespace prcage
