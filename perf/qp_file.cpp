// Layout: a line that names the format, then per problem the six entries of the form, the three of the linear term, the
// number of planes, the length of a row, and the nine rows. All numbers are doubles of this machine.
#include "perf/qp_file.h"

#include <array>
#include <fstream>
#include <stdexcept>

namespace prcage::perf {
namespace {

constexpr const char* title = "prcage placement problems 2";

using Head = std::array<double, 11>;

void put(std::ofstream& out, const double* from, std::size_t count) {
  out.write(reinterpret_cast<const char*>(from), static_cast<std::streamsize>(count * sizeof(double)));
}

bool get(std::ifstream& in, double* to, std::size_t count) {
  return static_cast<bool>(in.read(reinterpret_cast<char*>(to), static_cast<std::streamsize>(count * sizeof(double))));
}

}  // namespace

void QpProblems::clear() {
  form.clear();
  linear.clear();
  first_row.clear();
  row_length.clear();
  rows.clear();
  plane_count.clear();
}

void QpProblems::add(const Symmetric3& problem_form, const Vec3& problem_linear, const SlabRows& slabs,
                     std::size_t planes) {
  form.push_back(problem_form);
  linear.push_back(problem_linear);
  first_row.push_back(static_cast<std::uint32_t>(rows.size()));
  row_length.push_back(static_cast<std::uint32_t>(slabs.length));
  rows.insert(rows.end(), slabs.rows, slabs.rows + slab_rows * slabs.length);
  plane_count.push_back(static_cast<std::uint32_t>(planes));
}

void write_qps(const std::string& path, const QpProblems& problems) {
  std::ofstream out(path, std::ios::binary);
  out << title << '\n';
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const Symmetric3& G = problems.form[i];
    const Vec3& g = problems.linear[i];
    const SlabRows planes = problems.planes(i);
    const Head head{G.xx,
                    G.xy,
                    G.xz,
                    G.yy,
                    G.yz,
                    G.zz,
                    g.x(),
                    g.y(),
                    g.z(),
                    static_cast<double>(problems.plane_count[i]),
                    static_cast<double>(planes.length)};
    put(out, head.data(), head.size());
    put(out, planes.rows, slab_rows * planes.length);
  }
  out.close();
  if (!out) throw std::runtime_error(path + ": cannot be written");
}

QpProblems read_qps(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string line;
  if (!std::getline(in, line) || line != title) throw std::runtime_error(path + ": no file of placement problems");
  QpProblems problems;
  std::vector<double> rows;
  Head h;
  while (get(in, h.data(), h.size())) {
    const auto length = static_cast<std::size_t>(h[10]);
    rows.resize(slab_rows * length);
    if (!get(in, rows.data(), rows.size())) throw std::runtime_error(path + ": truncated");
    problems.add({h[0], h[1], h[2], h[3], h[4], h[5]}, {h[6], h[7], h[8]}, {rows.data(), length},
                 static_cast<std::size_t>(h[9]));
  }
  return problems;
}

}  // namespace prcage::perf
