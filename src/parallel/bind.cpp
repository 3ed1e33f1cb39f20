// Binding a mesh to a cage, and the mesh when the cage is deformed.
//
// A dense row of weights is as long as the cage has vertices: for a million vertices in a cage of 500 faces they take
// two gigabytes. Truncation therefore works on the blocks of rows as they come, and deform() without weights uses each
// block at once and forgets it. What is summed over the vertices is summed in the order of the blocks, which are the
// same for any number of threads.
#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <numeric>

#include "core/mesh_view.h"
#include "core/surface.h"
#include "parallel/arena.h"
#include "parallel/cage_weights.h"
#include "parallel/validate.h"

namespace prcage {
namespace {

// ------------------------------------------------------------------------------------------- what is refused

// Why these vertices cannot be used, a clause for people, or nothing.
std::string bad_vertex(const char* which, const Mesh& mesh) {
  const auto bad = std::find_if_not(mesh.positions.begin(), mesh.positions.end(), within_limits);
  if (bad == mesh.positions.end()) return {};
  return "vertex " + std::to_string(bad - mesh.positions.begin()) + " of the " + which +
         " has coordinates that are not finite or out of range";
}

std::string bad_input(const Mesh& mesh) {
  if (mesh.positions.empty()) return "the input has no vertices";
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (const std::uint32_t v : mesh.triangles[f])
      if (v >= mesh.positions.size()) return "face " + std::to_string(f) + " of the input names no existing vertex";
  }
  return bad_vertex("input", mesh);
}

std::string difference(const char* what, std::size_t bound, std::size_t deformed) {
  if (bound == deformed) return {};
  return "the deformed cage has " + std::to_string(deformed) + " " + what + ", the one that the mesh is bound to has " +
         std::to_string(bound);
}

// What differs between the bound cage and the deformed one.
std::string bad_pose(std::size_t vertices, std::size_t faces, const Mesh& pose) {
  std::string reason = difference("vertices", vertices, pose.positions.size());
  const std::string other = difference("faces", faces, pose.triangles.size());
  if (!reason.empty() && !other.empty()) reason += "; ";
  reason += other;
  return reason.empty() ? bad_vertex("deformed cage", pose) : reason;
}

// Sizes from files and callers may multiply to more than there are bytes.
std::size_t product(std::size_t a, std::size_t b) {
  std::size_t result = 0;
  if (__builtin_mul_overflow(a, b, &result) || result > std::numeric_limits<std::ptrdiff_t>::max() / sizeof(double))
    throw std::bad_alloc();
  return result;
}

// --------------------------------------------------------------------------------------------------- binding

// Sums over vertices.
struct Errors {
  double loss = 0, largest_loss = 0;
  double rest = 0, largest_rest = 0;

  void add(double lost, double distance) {
    loss += lost;
    largest_loss = std::max(largest_loss, lost);
    rest += distance;
    largest_rest = std::max(largest_rest, distance);
  }
  Errors& operator+=(const Errors& o) {
    loss += o.loss;
    rest += o.rest;
    largest_loss = std::max(largest_loss, o.largest_loss);
    largest_rest = std::max(largest_rest, o.largest_rest);
    return *this;
  }
};

// The largest weights of a row.
class Truncation {
 public:
  explicit Truncation(std::size_t keep) : keep_(keep) {}

  // Returns the share of the magnitudes that is lost. Of equal magnitudes the first ones are kept.
  double operator()(std::span<const double> row) {
    columns_.resize(row.size());
    std::iota(columns_.begin(), columns_.end(), 0u);
    const auto end = columns_.begin() + static_cast<std::ptrdiff_t>(keep_);
    std::nth_element(columns_.begin(), end, columns_.end(), [row](std::uint32_t a, std::uint32_t b) {
      const double x = std::abs(row[a]), y = std::abs(row[b]);
      return x > y || (x == y && a < b);
    });
    columns_.resize(keep_);
    std::sort(columns_.begin(), columns_.end());
    weights_.clear();
    for (const std::uint32_t c : columns_) weights_.push_back(row[c]);
    const double kept = magnitude(weights_);
    // In proportion to the magnitudes: a division by the sum could blow up weights of both signs.
    const double missing = 1 - std::accumulate(weights_.begin(), weights_.end(), 0.0);
    for (double& w : weights_) w += std::abs(w) * (missing / kept);
    return 1 - kept / magnitude(row);
  }

  std::span<const std::uint32_t> columns() const { return columns_; }
  std::span<const double> weights() const { return weights_; }

 private:
  static double magnitude(std::span<const double> weights) {
    return std::accumulate(weights.begin(), weights.end(), 0.0, [](double sum, double w) { return sum + std::abs(w); });
  }

  std::size_t keep_;
  std::vector<std::uint32_t> columns_;
  std::vector<double> weights_;
};

// Calls f with the numbers of the weights that are there.
template <class F>
decltype(auto) with_values(const CageWeights& weights, const F& f) {
  return weights.float_values.empty() ? f(std::span<const double>(weights.values))
                                      : f(std::span<const float>(weights.float_values));
}

Position position_of(const CageWeights& weights, const CagePose& pose, std::size_t v) {
  return with_values(weights, [&](auto values) {
    const auto row = values.subspan(v * weights.keep, weights.keep);
    if (weights.dense()) return pose.mean(row);
    return pose.mean(row, std::span(weights.columns).subspan(v * weights.keep, weights.keep));
  });
}

class Binding {
 public:
  Binding(const Mesh& input, const Mesh& cage, const BoundCage& bound, CageWeights& weights)
      : input_(input), bound_(bound), rest_(cage.positions), weights_(weights) {}

  void run(const BindOptions& options) {
    allocate(options);
    std::vector<Errors> errors(BoundCage::block_count(input_.positions.size()));
    bound_.for_each_block(input_.positions, [&](std::size_t first, std::size_t count, std::span<const double> rows) {
      errors[first / BoundCage::block_size] = store_block(first, count, rows);
    });
    report(std::accumulate(errors.begin(), errors.end(), Errors{}, [](Errors a, const Errors& b) { return a += b; }));
  }

 private:
  void allocate(const BindOptions& options) {
    weights_.vertices = input_.positions.size();
    weights_.keep = options.keep == 0 ? bound_.row_size() : std::min(options.keep, bound_.row_size());
    const std::size_t size = product(weights_.vertices, weights_.keep);
    if (weights_.keep < bound_.row_size()) weights_.columns.resize(size);
    if (options.precision == Precision::float32) {
      weights_.float_values.resize(size);
    } else {
      weights_.values.resize(size);
    }
  }

  template <class T>
  auto at(std::vector<T>& numbers, std::size_t v) const {
    return numbers.begin() + static_cast<std::ptrdiff_t>(v * weights_.keep);
  }

  Errors store_block(std::size_t first, std::size_t count, std::span<const double> rows) {
    Truncation truncation(weights_.keep);
    Errors errors;
    for (std::size_t i = 0; i < count; ++i) {
      const std::span<const double> row = rows.subspan(i * bound_.row_size(), bound_.row_size());
      double lost = 0;
      if (weights_.dense()) {
        store(first + i, row);
      } else {
        lost = truncation(row);
        std::copy(truncation.columns().begin(), truncation.columns().end(), at(weights_.columns, first + i));
        store(first + i, truncation.weights());
      }
      const Vec3 rest = vec(position_of(weights_, rest_, first + i));
      errors.add(lost, (rest - vec(input_.positions[first + i])).norm());
    }
    return errors;
  }

  void store(std::size_t v, std::span<const double> row) {
    if (weights_.float_values.empty()) {
      std::copy(row.begin(), row.end(), at(weights_.values, v));
    } else {
      std::transform(row.begin(), row.end(), at(weights_.float_values, v),
                     [](double w) { return static_cast<float>(w); });
    }
  }

  void report(const Errors& errors) {
    const auto n = static_cast<double>(weights_.vertices);
    const double diagonal = extent(input_.positions).diagonal();
    const double l = diagonal > 0 ? diagonal : 1;  // of a single point
    weights_.largest_loss = errors.largest_loss;
    weights_.mean_loss = errors.loss / n;
    weights_.largest_rest_error = errors.largest_rest / l;
    weights_.mean_rest_error = errors.rest / n / l;
  }

  const Mesh& input_;
  const BoundCage& bound_;
  CagePose rest_;
  CageWeights& weights_;
};

void bind_meshes(Mesh input, const Mesh& cage, const BindOptions& options, CageWeights& weights) {
  weights.status = Status::invalid_input;
  weights.message = bad_input(input);
  if (!weights.message.empty()) return;
  BoundCage bound;
  weights.message = bound.build(cage);
  if (!weights.message.empty()) return;
  weights.cage_vertices = cage.positions.size();
  weights.cage_faces = cage.triangles.size();
  Binding(input, cage, bound, weights).run(options);
  weights.triangles = std::move(input.triangles);
  weights.status = Status::ok;
}

// ------------------------------------------------------------------------------------------------ deformation

Deformation refused(std::string message) { return {Status::invalid_input, std::move(message), {}}; }

// Callers may have built or changed the weights themselves.
std::string bad_weights(const CageWeights& weights) {
  if (weights.status != Status::ok) return "there are no weights";
  const std::size_t size = product(weights.vertices, weights.keep);
  const std::size_t values = with_values(weights, [](auto v) { return v.size(); });
  const bool sized = weights.keep > 0 && values == size && (weights.dense() || weights.columns.size() == size);
  if (!sized || (weights.dense() && weights.keep != weights.cage_vertices)) return "the sizes of the weights disagree";
  const auto named = [&](std::uint32_t c) { return c < weights.cage_vertices; };
  if (!std::all_of(weights.columns.begin(), weights.columns.end(), named)) return "the weights name no existing vertex";
  return {};
}

Deformation deform_bound(const CageWeights& weights, const Mesh& pose) {
  if (std::string reason = bad_weights(weights); !reason.empty()) return refused(std::move(reason));
  if (std::string reason = bad_pose(weights.cage_vertices, weights.cage_faces, pose); !reason.empty())
    return refused(std::move(reason));
  Deformation result{Status::ok, {}, {}};
  result.mesh.triangles = weights.triangles;
  result.mesh.positions.resize(weights.vertices);
  const CagePose cage(pose.positions);
  parallel_each(weights.vertices, default_grain,
                [&](std::size_t v) { result.mesh.positions[v] = position_of(weights, cage, v); });
  return result;
}

Deformation deform_unbound(Mesh input, const Mesh& cage, const Mesh& pose) {
  if (std::string reason = bad_input(input); !reason.empty()) return refused(std::move(reason));
  BoundCage bound;
  if (std::string reason = bound.build(cage); !reason.empty()) return refused(std::move(reason));
  if (std::string reason = bad_pose(cage.positions.size(), cage.triangles.size(), pose); !reason.empty())
    return refused(std::move(reason));
  const CagePose deformed(pose.positions);
  std::vector<Position> positions(input.positions.size());
  bound.for_each_block(input.positions, [&](std::size_t first, std::size_t count, std::span<const double> rows) {
    for (std::size_t i = 0; i < count; ++i)
      positions[first + i] = deformed.mean(rows.subspan(i * bound.row_size(), bound.row_size()));
  });
  return {Status::ok, {}, {std::move(positions), std::move(input.triangles)}};
}

}  // namespace

CageWeights bind(const MeshView& input, const MeshView& cage, const BindOptions& options) {
  CageWeights weights;
  Arena(options.threads).run([&] { bind_meshes(to_mesh(input), to_mesh(cage), options, weights); });
  return weights;
}

Deformation deform(const CageWeights& weights, const MeshView& deformed_cage, int threads) {
  Deformation result;
  Arena(threads).run([&] { result = deform_bound(weights, to_mesh(deformed_cage)); });
  return result;
}

Deformation deform(const MeshView& input, const MeshView& cage, const MeshView& deformed_cage, int threads) {
  Deformation result;
  Arena(threads).run([&] { result = deform_unbound(to_mesh(input), to_mesh(cage), to_mesh(deformed_cage)); });
  return result;
}

}  // namespace prcage
