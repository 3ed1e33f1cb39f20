#include "perf/meshopt.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "core/surface.h"

namespace prcage::perf {
namespace {

struct FloatMesh {
  std::vector<float> positions;  // three a vertex
  std::vector<unsigned> indices;
};

constexpr std::size_t vertex_size = 3 * sizeof(float);

FloatMesh float_mesh(const Mesh& mesh) {
  FloatMesh result;
  for (const auto& p : mesh.positions)
    for (const double x : p) result.positions.push_back(static_cast<float>(x));
  for (const auto& t : mesh.triangles) result.indices.insert(result.indices.end(), t.begin(), t.end());
  std::vector<unsigned> remap(mesh.positions.size());
  const std::size_t vertices = meshopt_generateVertexRemap(remap.data(), result.indices.data(), result.indices.size(),
                                                           result.positions.data(), mesh.positions.size(), vertex_size);
  meshopt_remapIndexBuffer(result.indices.data(), result.indices.data(), result.indices.size(), remap.data());
  meshopt_remapVertexBuffer(result.positions.data(), result.positions.data(), mesh.positions.size(), vertex_size,
                            remap.data());
  result.positions.resize(3 * vertices);
  return result;
}

Mesh used_part(const std::vector<float>& positions, const std::vector<unsigned>& indices) {
  Mesh mesh;
  for (std::size_t i = 0; i < positions.size(); i += 3)
    mesh.positions.push_back({positions[i], positions[i + 1], positions[i + 2]});
  for (std::size_t i = 0; i < indices.size(); i += 3)
    mesh.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  return select_faces(mesh.positions, mesh.triangles).mesh;
}

}  // namespace

MeshoptResult simplify_by_meshopt(const Mesh& mesh, std::size_t target_faces) {
  const FloatMesh input = float_mesh(mesh);
  constexpr float any_error = 1e10f;
  const std::size_t target = std::min(3 * target_faces, input.indices.size());  // it asserts that
  std::vector<unsigned> simplified(input.indices.size());
  MeshoptResult result;
  const auto start = std::chrono::steady_clock::now();
  const std::size_t indices =
      meshopt_simplify(simplified.data(), input.indices.data(), input.indices.size(), input.positions.data(),
                       input.positions.size() / 3, vertex_size, target, any_error, 0, &result.relative_error);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  simplified.resize(indices);
  result.mesh = used_part(input.positions, simplified);
  return result;
}

}  // namespace prcage::perf
