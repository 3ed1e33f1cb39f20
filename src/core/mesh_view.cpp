#include "core/mesh_view.h"

#include <algorithm>
#include <cstring>

namespace prcage {
namespace {

// Rows of three Source values, `stride` bytes apart (0: packed) and in no particular alignment.
template <class Source, class Target>
std::vector<std::array<Target, 3>> copy_rows(const void* data, std::size_t count, std::size_t stride) {
  std::vector<std::array<Target, 3>> rows(count);
  const auto* bytes = static_cast<const unsigned char*>(data);
  if (stride == 0) stride = 3 * sizeof(Source);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<Source, 3> row;
    std::memcpy(row.data(), bytes + i * stride, sizeof row);
    std::copy(row.begin(), row.end(), rows[i].begin());
  }
  return rows;
}

}  // namespace

Mesh to_mesh(const MeshView& view) {
  Mesh mesh;
  mesh.positions = view.scalar == Scalar::float32
                       ? copy_rows<float, double>(view.positions, view.vertex_count, view.position_stride)
                       : copy_rows<double, double>(view.positions, view.vertex_count, view.position_stride);
  mesh.triangles = copy_rows<std::uint32_t, std::uint32_t>(view.triangles, view.triangle_count, view.triangle_stride);
  return mesh;
}

}  // namespace prcage
