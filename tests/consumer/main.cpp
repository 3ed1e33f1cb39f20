// Makes a cage of an octahedron through the installed headers and says whether that worked.
#include <prcage/mesh_file.h>
#include <prcage/prcage.h>

#include <cstdio>

int main() {
  prcage::Mesh octahedron;
  octahedron.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  octahedron.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};

  const prcage::Result result = prcage::make_cage(octahedron);
  std::printf("prcage %s: %s, %zu faces, %s\n", prcage::version(), prcage::to_string(result.status),
              result.cage.triangles.size(), result.message.c_str());
  if (!result.has_cage() || !result.certificate.valid()) return 1;

  const prcage::WriteResult written = prcage::write_mesh("cage.off", prcage::MeshFormat::off, result.cage);
  const prcage::MeshFile read = prcage::read_mesh("cage.off");
  return written.ok && read.ok && read.mesh.positions == result.cage.positions ? 0 : 1;
}
