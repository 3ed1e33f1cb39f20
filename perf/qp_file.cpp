// Layout: a line that names the format, then per problem the six entries of the form, the three of the linear term, the
// number of planes, and four numbers a plane. All numbers are doubles of this machine.
#include "perf/qp_file.h"

#include <array>
#include <fstream>
#include <stdexcept>

namespace prcage::perf {
namespace {

constexpr const char* title = "prcage placement problems 1";

using Head = std::array<double, 10>;
using Plane = std::array<double, 4>;

template <class Record>
void put(std::ofstream& out, const Record& record) {
  out.write(reinterpret_cast<const char*>(record.data()), sizeof(Record));
}

template <class Record>
bool get(std::ifstream& in, Record& record) {
  return static_cast<bool>(in.read(reinterpret_cast<char*>(record.data()), sizeof(Record)));
}

}  // namespace

void QpProblems::add(const Symmetric3& problem_form, const Vec3& problem_linear, const PlaneArrays& planes) {
  form.push_back(problem_form);
  linear.push_back(problem_linear);
  nx.insert(nx.end(), planes.nx, planes.nx + planes.count);
  ny.insert(ny.end(), planes.ny, planes.ny + planes.count);
  nz.insert(nz.end(), planes.nz, planes.nz + planes.count);
  offset.insert(offset.end(), planes.offset, planes.offset + planes.count);
  first_plane.push_back(static_cast<std::uint32_t>(nx.size()));
}

void write_qps(const std::string& path, const QpProblems& problems) {
  std::ofstream out(path, std::ios::binary);
  out << title << '\n';
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const Symmetric3& G = problems.form[i];
    const Vec3& g = problems.linear[i];
    const PlaneArrays planes = problems.planes(i);
    put(out, Head{G.xx, G.xy, G.xz, G.yy, G.yz, G.zz, g.x(), g.y(), g.z(), static_cast<double>(planes.count)});
    for (std::size_t k = 0; k < planes.count; ++k)
      put(out, Plane{planes.nx[k], planes.ny[k], planes.nz[k], planes.offset[k]});
  }
  out.close();
  if (!out) throw std::runtime_error(path + ": cannot be written");
}

QpProblems read_qps(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string line;
  if (!std::getline(in, line) || line != title) throw std::runtime_error(path + ": no file of placement problems");
  QpProblems problems;
  std::vector<double> nx, ny, nz, offset;
  Head h;
  while (get(in, h)) {
    const auto count = static_cast<std::size_t>(h[9]);
    for (auto* numbers : {&nx, &ny, &nz, &offset}) numbers->resize(count);
    Plane p;
    for (std::size_t k = 0; k < count; ++k) {
      if (!get(in, p)) throw std::runtime_error(path + ": truncated");
      nx[k] = p[0], ny[k] = p[1], nz[k] = p[2], offset[k] = p[3];
    }
    problems.add({h[0], h[1], h[2], h[3], h[4], h[5]}, {h[6], h[7], h[8]},
                 {nx.data(), ny.data(), nz.data(), offset.data(), count});
  }
  return problems;
}

}  // namespace prcage::perf
