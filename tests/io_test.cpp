// Tests of src/io: what is written reads back to the last bit, the quirks of files in the wild are understood, and
// damaged files are refused with a message instead of a crash.
#include "io/mesh_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <random>
#include <sstream>
#include <thread>

#include "io/formats.h"

namespace prcage {
namespace {

namespace fs = std::filesystem;
using testing::TestWithParam;
using testing::Values;

constexpr std::array<MeshFormat, 6> all_formats{MeshFormat::ply_binary, MeshFormat::ply_ascii, MeshFormat::obj,
                                                MeshFormat::stl_binary, MeshFormat::stl_ascii, MeshFormat::off};

// ------------------------------------------------------------------------------------------------------- helpers

class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    path_ = (fs::path(testing::TempDir()) / "prcage-io-XXXXXX").string();
    if (!mkdtemp(path_.data())) throw std::runtime_error("no temporary directory");
  }
  ~TemporaryDirectory() { fs::remove_all(path_); }

  std::string file(const std::string& name) const { return path_ + "/" + name; }
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(path_), fs::directory_iterator()));
  }

 private:
  std::string path_;
};

void put_file(const std::string& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

std::string get_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

Mesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
}

// Equal down to the bits: 0 is not -0.
bool identical(const Mesh& a, const Mesh& b) {
  const auto same_bits = [](const std::array<double, 3>& p, const std::array<double, 3>& q) {
    return std::memcmp(p.data(), q.data(), sizeof p) == 0;
  };
  return a.triangles == b.triangles &&
         std::equal(a.positions.begin(), a.positions.end(), b.positions.begin(), b.positions.end(), same_bits);
}

// The bytes that the writer of a format makes of a mesh.
std::string written(const Mesh& mesh, MeshFormat format, const std::string& comment = {}) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("mesh");
  const WriteResult result = write_mesh(path, format, mesh, comment);
  EXPECT_TRUE(result.ok) << result.error;
  return get_file(path);
}

void expect_mesh(const std::string& bytes, const Mesh& expected) {
  const MeshFile file = parse_mesh(bytes);
  EXPECT_TRUE(file.ok) << file.error << "\n" << bytes;
  EXPECT_TRUE(identical(file.mesh, expected)) << bytes;
}

void expect_error(const std::string& bytes, const std::string& part) {
  const MeshFile file = parse_mesh(bytes);
  EXPECT_FALSE(file.ok) << bytes;
  EXPECT_NE(file.error.find(part), std::string::npos) << file.error << "\nlacks: " << part;
}

// Vertices of every size that a double has, a triangle for every three of them in order.
Mesh extreme_mesh() {
  using Limits = std::numeric_limits<double>;
  std::vector<double> values{-0.0,
                             0.0,
                             Limits::denorm_min(),
                             -Limits::denorm_min(),
                             Limits::min(),
                             Limits::max(),
                             Limits::lowest(),
                             0.1,
                             1.0 / 3,
                             1e22,
                             1e23,
                             123456789,
                             5e-324,
                             2.2250738585072011e-308};
  std::mt19937_64 random(1);
  while (values.size() < 3000) {
    const double x = std::bit_cast<double>(random());
    if (std::isfinite(x)) values.push_back(x);
  }
  Mesh mesh;
  for (std::size_t i = 0; i + 3 <= values.size(); ++i) {
    mesh.positions.push_back({values[i], values[i + 1], values[i + 2]});
  }
  for (std::uint32_t i = 0; i + 3 <= mesh.positions.size(); i += 3) mesh.triangles.push_back({i, i + 1, i + 2});
  return mesh;
}

Mesh rounded_to_float(Mesh mesh) {
  for (auto& p : mesh.positions) {
    for (double& x : p) {
      const double largest = std::numeric_limits<float>::max();
      x = static_cast<float>(std::clamp(x, -largest, largest));
    }
  }
  return mesh;
}

// STL keeps no vertices but corners: what welding makes of the mesh is what comes back.
Mesh as_stl_keeps_it(const Mesh& mesh) {
  Mesh soup;
  for (const auto& triangle : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    for (const std::uint32_t corner : triangle) soup.positions.push_back(mesh.positions[corner]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  weld_equal_positions(soup);
  return soup;
}

// -------------------------------------------------------------------------------------------------------- formats

TEST(MeshFormatNames, ReadBackAndFollowTheExtension) {
  for (const MeshFormat format : all_formats) {
    MeshFormat parsed{};
    EXPECT_TRUE(parse_mesh_format(to_string(format), parsed));
    EXPECT_EQ(parsed, format);
    EXPECT_EQ(stores_floats(format), format == MeshFormat::stl_binary);
  }
  MeshFormat format{};
  EXPECT_FALSE(parse_mesh_format("PLY", format));
  EXPECT_FALSE(parse_mesh_format("", format));

  const std::map<std::string, MeshFormat> paths{{"a.ply", MeshFormat::ply_binary},
                                                {"b/c.d.OBJ", MeshFormat::obj},
                                                {"x.Stl", MeshFormat::stl_binary},
                                                {".off", MeshFormat::off}};
  for (const auto& [path, expected] : paths) {
    EXPECT_TRUE(mesh_format_of_path(path, format)) << path;
    EXPECT_EQ(format, expected) << path;
  }
  for (const char* path : {"", "ply", "a.", "a.ply-ascii", "a.plyx", "a.ply/b", "a.glb"}) {
    EXPECT_FALSE(mesh_format_of_path(path, format)) << path;
  }
}

class RoundTrip : public TestWithParam<MeshFormat> {};

TEST_P(RoundTrip, IsExact) {
  Mesh mesh = extreme_mesh();
  if (stores_floats(GetParam())) mesh = rounded_to_float(mesh);
  const bool stl = GetParam() == MeshFormat::stl_binary || GetParam() == MeshFormat::stl_ascii;
  if (stl) mesh = as_stl_keeps_it(mesh);

  const std::string bytes = written(mesh, GetParam(), "a comment");
  const MeshFile file = parse_mesh(bytes);
  ASSERT_TRUE(file.ok) << file.error;
  EXPECT_EQ(file.format, GetParam());
  EXPECT_EQ(file.float_positions, stores_floats(GetParam()));
  EXPECT_EQ(file.polygons, 0u);
  EXPECT_EQ(file.skipped_elements, 0u);
  EXPECT_EQ(file.welded_corners, stl ? 3 * mesh.triangles.size() - mesh.positions.size() : 0u);
  EXPECT_TRUE(identical(file.mesh, mesh));
  EXPECT_EQ(written(file.mesh, GetParam(), "a comment"), bytes);
}

TEST_P(RoundTrip, KeepsValuesThatAreNotFinite) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Mesh mesh = tetrahedron();
  mesh.positions[3] = {std::nan(""), infinity, -infinity};
  const MeshFile file = parse_mesh(written(mesh, GetParam()));
  ASSERT_TRUE(file.ok) << file.error;
  const auto found = std::find_if(file.mesh.positions.begin(), file.mesh.positions.end(),
                                  [](const std::array<double, 3>& p) { return std::isnan(p[0]); });
  ASSERT_NE(found, file.mesh.positions.end());
  EXPECT_EQ((*found)[1], infinity);
  EXPECT_EQ((*found)[2], -infinity);
}

TEST_P(RoundTrip, CommentStaysOneLineAndHidesNothing) {
  const std::string bytes = written(tetrahedron(), GetParam(), "first\nv 9 9 9\r\nend_header\\");
  const bool has_comments = GetParam() != MeshFormat::stl_binary && GetParam() != MeshFormat::stl_ascii;
  EXPECT_EQ(bytes.find("first v 9 9 9  end_header\\") != std::string::npos, has_comments);
  const MeshFile file = parse_mesh(bytes);
  ASSERT_TRUE(file.ok) << file.error;
  EXPECT_EQ(file.mesh.positions.size(), 4u);
  EXPECT_EQ(file.mesh.triangles.size(), 4u);
}

TEST_P(RoundTrip, TrianglesOutOfRangeAreNotWritten) {
  const TemporaryDirectory directory;
  Mesh mesh = tetrahedron();
  mesh.triangles[2][1] = 4;
  const WriteResult result = write_mesh(directory.file("mesh"), GetParam(), mesh);
  EXPECT_FALSE(result.ok);
  EXPECT_NE(result.error.find("triangle 2 names vertex 4"), std::string::npos) << result.error;
  EXPECT_EQ(directory.entries(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrip, testing::ValuesIn(all_formats),
                         [](const auto& parameter) { return replaced(to_string(parameter.param), "-", "_"); });

// The same mesh in the dialects of editors and operating systems.
class TextDialects : public TestWithParam<MeshFormat> {};

TEST_P(TextDialects, AreUnderstood) {
  Mesh mesh = tetrahedron();
  mesh.positions[3] = {-1.5, 2.5e-10, 3e20};
  if (GetParam() == MeshFormat::stl_ascii) mesh = as_stl_keeps_it(mesh);
  const std::string text = written(mesh, GetParam(), "comment");
  expect_mesh(text, mesh);
  expect_mesh("\xef\xbb\xbf" + text, mesh);
  expect_mesh(replaced(text, "\n", "\r\n"), mesh);
  expect_mesh(replaced(text, "\n", "\r"), mesh);
  expect_mesh(replaced(text, "\n", " \t \n"), mesh);
  expect_mesh(replaced(text, " ", " \t  "), mesh);
  expect_mesh(replaced(text, "2.5e-10", "+.25E-9"), mesh);
  expect_mesh(replaced(text, "3e+20", "300000000000000000000.000"), mesh);
  expect_mesh(text + "\n\n", mesh);
  expect_mesh(text.substr(0, text.size() - 1), mesh);
}

INSTANTIATE_TEST_SUITE_P(Formats, TextDialects,
                         Values(MeshFormat::ply_ascii, MeshFormat::obj, MeshFormat::off, MeshFormat::stl_ascii),
                         [](const auto& parameter) { return replaced(to_string(parameter.param), "-", "_"); });

TEST(TextNumbers, BeyondTheDoublesBecomeInfinityOrZero) {
  const auto x_of = [](const std::string& number) {
    const MeshFile file = parse_mesh("v " + number + " 0 0\n");
    EXPECT_TRUE(file.ok) << file.error;
    return file.ok ? file.mesh.positions[0][0] : 7;
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const char* number : {"1e400", "+1e309", "1e99999999999999999999", "123456789e+308"}) {
    EXPECT_EQ(x_of(number), infinity) << number;
  }
  EXPECT_EQ(x_of("-1e400"), -infinity);
  EXPECT_EQ(x_of("1" + std::string(400, '0')), infinity);
  for (const char* number : {"1e-400", "2e-324", "1e-99999999999999999999", "0.00000001e-320"}) {
    EXPECT_EQ(x_of(number), 0) << number;
  }
  EXPECT_TRUE(std::signbit(x_of("-1e-400")));
  EXPECT_EQ(x_of("0." + std::string(400, '0') + "1"), 0);
  EXPECT_EQ(x_of("0." + std::string(400, '0') + "1e401"), 1);
  EXPECT_EQ(x_of("INF"), infinity);
  EXPECT_TRUE(std::isnan(x_of("-nan(ind)")));
}

TEST(Detection, UnknownContentIsNamed) {
  expect_error("", "empty");
  for (const char* text : {"hello\n", "\n\n", "# only a comment\n", "v", "plywood\n", "1 2 3\n"}) {
    expect_error(text, "(PLY, OBJ, STL, OFF)");
  }
  expect_error("\x1f\x8b rest", "gzip");
  expect_error("PK\x03\x04 rest", "zip");
  expect_error("glTF rest", "glTF");
}

// ------------------------------------------------------------------------------------------------------------ PLY

// Bytes of a number in one of the PLY types.
std::string encoded(double value, const std::string& type, bool big_endian) {
  const auto bytes_of = [&](auto number) {
    std::string bytes(sizeof number, '\0');
    std::memcpy(bytes.data(), &number, sizeof number);
    if (big_endian != (std::endian::native == std::endian::big)) std::reverse(bytes.begin(), bytes.end());
    return bytes;
  };
  if (type == "char" || type == "int8") return bytes_of(static_cast<std::int8_t>(value));
  if (type == "uchar" || type == "uint8") return bytes_of(static_cast<std::uint8_t>(value));
  if (type == "short" || type == "int16") return bytes_of(static_cast<std::int16_t>(value));
  if (type == "ushort" || type == "uint16") return bytes_of(static_cast<std::uint16_t>(value));
  if (type == "int" || type == "int32") return bytes_of(static_cast<std::int32_t>(value));
  if (type == "uint" || type == "uint32") return bytes_of(static_cast<std::uint32_t>(value));
  if (type == "float" || type == "float32") return bytes_of(static_cast<float>(value));
  return bytes_of(value);
}

// A file in which the elements, properties and values are the same in all three encodings.
class PlyBuilder {
 public:
  explicit PlyBuilder(const std::string& encoding)
      : ascii_(encoding == "ascii"), big_endian_(encoding == "binary_big_endian") {
    header_ = "ply\nformat " + encoding + " 1.0\ncomment made by a test\nobj_info none\n";
  }

  PlyBuilder& declare(const std::string& line) {
    header_ += line + "\n";
    return *this;
  }

  // A record: pairs of type and value.
  PlyBuilder& record(const std::vector<std::pair<std::string, double>>& values) {
    for (const auto& [type, value] : values) {
      std::ostringstream number;
      number << value << " ";
      body_ += ascii_ ? number.str() : encoded(value, type, big_endian_);
    }
    if (ascii_) body_ += "\n";
    return *this;
  }

  std::string bytes() const { return header_ + "end_header\n" + body_; }

 private:
  bool ascii_;
  bool big_endian_;
  std::string header_;
  std::string body_;
};

class PlyEncodings : public TestWithParam<const char*> {};

TEST_P(PlyEncodings, EveryTypeServesForCoordinatesLengthsAndIndices) {
  const std::vector<std::string> types{"char", "uchar", "short", "ushort", "int",   "uint",   "float",   "double",
                                       "int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"};
  for (const std::string& type : types) {
    const std::string count_type = type.find("loat") == std::string::npos && type != "double" ? type : "uchar";
    PlyBuilder ply(GetParam());
    ply.declare("element vertex 3").declare("property " + type + " x");
    ply.declare("property " + type + " y").declare("property " + type + " z");
    ply.declare("element face 1").declare("property list " + count_type + " " + type + " vertex_index");
    ply.record({{type, 1}, {type, 2}, {type, 3}}).record({{type, 4}, {type, 5}, {type, 6}});
    ply.record({{type, 7}, {type, 8}, {type, 100}});
    ply.record({{count_type, 3}, {type, 2}, {type, 0}, {type, 1}});
    SCOPED_TRACE(type);
    expect_mesh(ply.bytes(), {{{1, 2, 3}, {4, 5, 6}, {7, 8, 100}}, {{2, 0, 1}}});
    const bool binary_floats = std::string(GetParam()) != "ascii" && (type == "float" || type == "float32");
    EXPECT_EQ(parse_mesh(ply.bytes()).float_positions, binary_floats);
  }
}

TEST_P(PlyEncodings, UnknownElementsAndPropertiesArePassedOver) {
  PlyBuilder ply(GetParam());
  ply.declare("element material 2").declare("property uchar kind").declare("property list ushort float values");
  ply.declare("element nothing 4000000000");
  ply.declare("element vertex 4").declare("property float confidence").declare("property double z");
  ply.declare("property uchar red").declare("property short x").declare("property float y");
  ply.declare("element face 4").declare("property uchar flags");
  ply.declare("property list uchar uint vertex_indices").declare("property list uchar float texcoord");
  ply.declare("element edge 1").declare("property int vertex1").declare("property int vertex2");
  ply.record({{"uchar", 1}, {"ushort", 0}});
  ply.record({{"uchar", 1}, {"ushort", 2}, {"float", 0.5}, {"float", 0.25}});
  for (int i = 0; i < 4; ++i) {
    ply.record({{"float", 0.5}, {"double", i + 0.125}, {"uchar", 200}, {"short", -i}, {"float", 0.75}});
  }
  ply.record({{"uchar", 9}, {"uchar", 3}, {"uint", 0}, {"uint", 1}, {"uint", 2}, {"uchar", 1}, {"float", 0.5}});
  ply.record({{"uchar", 9}, {"uchar", 4}, {"uint", 3}, {"uint", 2}, {"uint", 1}, {"uint", 0}, {"uchar", 0}});
  ply.record({{"uchar", 9}, {"uchar", 2}, {"uint", 0}, {"uint", 1}, {"uchar", 0}});
  ply.record({{"uchar", 9}, {"uchar", 0}, {"uchar", 0}});
  ply.record({{"int", 0}, {"int", 1}});

  expect_mesh(ply.bytes(), {{{0, 0.75, 0.125}, {-1, 0.75, 1.125}, {-2, 0.75, 2.125}, {-3, 0.75, 3.125}},
                            {{0, 1, 2}, {3, 2, 1}, {3, 1, 0}}});
  const MeshFile file = parse_mesh(ply.bytes());
  EXPECT_EQ(file.polygons, 1u);
  EXPECT_EQ(file.skipped_elements, 2u + 4000000000u + 2u + 1u);
}

TEST_P(PlyEncodings, VerticesMayHaveLists) {
  PlyBuilder ply(GetParam());
  ply.declare("element vertex 2").declare("property list uchar int neighbours").declare("property float x");
  ply.declare("property float y").declare("property list int uchar more").declare("property float z");
  ply.record({{"uchar", 2}, {"int", 5}, {"int", 6}, {"float", 1}, {"float", 2}, {"int", 0}, {"float", 3}});
  ply.record({{"uchar", 0}, {"float", 4}, {"float", 5}, {"int", 1}, {"uchar", 7}, {"float", 6}});
  expect_mesh(ply.bytes(), {{{1, 2, 3}, {4, 5, 6}}, {}});
}

TEST_P(PlyEncodings, FacesMayComeFirst) {
  PlyBuilder ply(GetParam());
  ply.declare("element face 1").declare("property list uchar int vertex_indices");
  ply.declare("element vertex 1").declare("property float x").declare("property float y").declare("property float z");
  ply.record({{"uchar", 3}, {"int", 0}, {"int", 2147483647}, {"int", 5}});
  ply.record({{"float", 1}, {"float", 2}, {"float", 3}});
  const MeshFile file = parse_mesh(replaced(ply.bytes(), "2.14748e+09", "2147483647"));
  ASSERT_TRUE(file.ok) << file.error;
  EXPECT_EQ(file.mesh.triangles[0][1], 2147483647u) << "out of range is for validate() to report";
}

TEST_P(PlyEncodings, BadIndicesAndLengthsAreErrors) {
  const auto file_with = [](const std::string& count_type, double count, const std::string& type, double index) {
    PlyBuilder ply(GetParam());
    ply.declare("element vertex 0").declare("property float x").declare("property float y");
    ply.declare("property float z");
    ply.declare("element face 2").declare("property list " + count_type + " " + type + " vertex_indices");
    ply.record({{count_type, 3}, {type, 0}, {type, 0}, {type, 0}});
    return ply.record({{count_type, count}, {type, 0}, {type, 0}, {type, index}}).bytes();
  };
  ASSERT_TRUE(parse_mesh(file_with("uchar", 3, "int", 1)).ok);
  expect_error(file_with("uchar", 3, "int", -1), "face 1");
  expect_error(file_with("uchar", 3, "short", -2), "face 1");
  expect_error(file_with("uchar", 3, "float", 0.5), "face 1");
  expect_error(file_with("uchar", 3, "double", 4294967296.0), "face 1");
  expect_error(file_with("uchar", 3, "double", std::nan("")), "face 1");
  expect_error(file_with("char", -3, "int", 1), "face 1");
  expect_error(file_with("uchar", 200, "int", 1), "face 1");
  expect_error(file_with("uint", 4000000000.0, "int", 1), "face 1");
}

TEST_P(PlyEncodings, AbsurdCountsAllocateNothing) {
  const std::string coordinates = "property float x\nproperty float y\nproperty float z\n";
  const std::string start = std::string("ply\nformat ") + GetParam() + " 1.0\nelement vertex ";
  const std::string faces = "element face 4000000000000000000\nproperty list uchar int vertex_indices\n";
  expect_error(start + "4000000000\n" + coordinates + "end_header\n0 0 0\n", "4000000000");
  expect_error(start + "18446744073709551615\n" + coordinates + "end_header\n0 0 0\n", "32-bit");
  expect_error(start + "0\n" + coordinates + faces + "end_header\n3 0 0 0\n", "4000000000000000000");
  expect_error(start + "99999999999999999999\n" + coordinates + "end_header\n", "line 3");
}

INSTANTIATE_TEST_SUITE_P(Encodings, PlyEncodings, Values("ascii", "binary_little_endian", "binary_big_endian"),
                         [](const auto& parameter) { return std::string(parameter.param); });

TEST(Ply, BinaryBodyMayBeginLikeALineEnd) {
  for (const std::string line_end : {"\n", "\r\n", "\r"}) {
    PlyBuilder ply("binary_little_endian");
    ply.declare("element vertex 1").declare("property uchar x").declare("property uchar y");
    ply.declare("property uchar z");
    const std::string header = replaced(ply.bytes(), "\n", line_end);
    expect_mesh(header + "\n\r\n", {{{10, 13, 10}}, {}});
  }
}

TEST(Ply, BadHeadersAreErrors) {
  const std::string good =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 0\nproperty list uchar int vertex_indices\nend_header\n1 2 3\n";
  ASSERT_TRUE(parse_mesh(good).ok);
  const auto expect_change = [&](const std::string& from, const std::string& to, const std::string& part) {
    ASSERT_NE(good.find(from), std::string::npos);
    expect_error(replaced(good, from, to), part);
  };
  expect_change("ascii 1.0", "text 1.0", "line 2: format 'text'");
  expect_change("ascii 1.0", "ascii 2.0", "version");
  expect_change("format ascii 1.0\n", "", "no format");
  expect_change("element vertex 1\n", "", "line 3: a property before");
  expect_change("vertex 1", "vertex", "line 3");
  expect_change("vertex 1", "vertex -1", "'-1'");
  expect_change("vertex 1", "vertices 1", "no element 'vertex'");
  expect_change("float x", "floating x", "'floating' is no type");
  expect_change("float x", "float u", "'x'");
  expect_change("float x", "list uchar float x", "'x'");
  expect_change("list uchar int vertex_indices", "list uchar int corners", "vertex_indices");
  expect_change("list uchar int vertex_indices", "int vertex_indices", "vertex_indices");
  expect_change("list uchar", "list float", "length of a list");
  expect_change("list uchar", "list", "line 8: expected 'property");
  expect_change("end_header\n1 2 3\n", "", "no end_header");
  expect_change("end_header", "end_of_header", "line 9: 'end_of_header'");
  expect_change("element face 0", "element vertex 0", "declared twice");
  expect_change("face 0", "tristrips 1", "triangle strips");
}

TEST(Ply, AsciiErrorsNameLineAndElement) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  expect_error(head + "0 0 0\n1 1\n3 0 1 0\n", "line 11: vertex 1: expected a coordinate, found the end of the line");
  expect_error(head + "0 0 0\n1 1 1,5\n3 0 1 0\n", "found '1,5'");
  expect_error(head + "0 0 0\n1 1 1 1\n3 0 1 0\n", "line 11: vertex 1");
  expect_error(head + "0 0 0\n1 1 1\n3 0 4294967296 0\n", "line 12: face 0");
  expect_error(head + "0 0 0\n1 1 1\n3 0 -1 0\n", "found '-1'");
  expect_error(head + "0 0 0\n1 1 1\n4 0 1 0\n", "the end of the line");
  expect_error(head + "0 0 0\n1 1 1\n        ",
               "line 12: face 0: expected the length of a list, found the end of the file");
}

// ------------------------------------------------------------------------------------------------------------ OBJ

TEST(Obj, CornersInAllForms) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  const Mesh expected{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}}};
  for (const char* face : {"f 1 2 3", "f 1/1 2/2 3/3", "f 1//1 2//2 3//3", "f 1/1/1 2/2/2 3/3/3", "f -4 -3 -2",
                           "f -4/-1 -3/-1/-1 3//-1", "f 1/ 2/ 3/", "f +1 +2 +3", "f 1 2 3 # comment", "fo 1 2 3",
                           "f 1 2 \\\n 3", "f 1 2 \\\r\n 3", "f 1 2\\\n3", "f \\\n\\\n 1 2 3", "f 1 2 3\\\n"}) {
    expect_mesh(vertices + face, expected);
    expect_mesh(vertices + face + "\n", expected);
  }
}

TEST(Obj, OtherStatementsArePassedOver) {
  const std::string text =
      "# a comment that ends in a backslash \\\nmtllib a.mtl\no thing\ng a b\nv 1 2 3 0.5\nvt 0 0\nvn 0 0 1\n"
      "v 4 5 6 0.1 0.2 0.3\nvp 1\n\n  s off\nusemtl red\nv 7 8 9 \\\n 1 \\\n 1 1\nf 1 2 3\nl 1 2\np 1\nf 1 2\nf\n"
      "f 3 2 1 2 3 # a pentagon\nvendor_extension 1 2 3\n";
  expect_mesh(text, {{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, {{0, 1, 2}, {2, 1, 0}, {2, 0, 1}, {2, 1, 2}}});
  const MeshFile file = parse_mesh(text);
  EXPECT_EQ(file.polygons, 1u);
  EXPECT_EQ(file.skipped_elements, 4u);
}

TEST(Obj, IndicesBeyondTheVerticesAreKept) {
  expect_mesh("v 0 0 0\nf 1 4294967296 7\nv 1 1 1\n", {{{0, 0, 0}, {1, 1, 1}}, {{0, 0xffffffffu, 6}}});
}

TEST(Obj, ErrorsNameLineAndElement) {
  const std::string head = "# head\r\nv 0 0 0\r\nv 1 0 0\r\nf 1 2 1\r\n";
  expect_error(head + "f 0 1 2\r\n", "line 5: face 1: expected a vertex index");
  for (const char* corner : {"0", "0/1", "-3", "4294967297", "99999999999999999999", "a", "1.5", "1/a", "1a", "/1"}) {
    expect_error(head + "f 1 2 " + corner + "\r\n", std::string("found '") + corner + "'");
  }
  expect_error(head + "v 1 2\r\n", "line 5: vertex 2: expected a coordinate, found the end of the line");
  expect_error(head + "v 1 2 x\r\n", "found 'x'");
  expect_error(head + "v 1 2", "found the end of the file: the file is truncated");
  expect_error(head + "\r\n1 2 3\r\n", "line 6: '1' is no statement");
  expect_error(head + "v 1 2 \\\n\n", "line 6: vertex 2");
  expect_error("g nothing\n", "no vertex");
  expect_error(head + "v 1 2 \x01\x02\n", "found '" + std::string(2, '?') + "'");
  expect_error(head + "v 1 2 " + std::string(100000, 'x') + "\n", "xxx...'");
}

// ------------------------------------------------------------------------------------------------------------ OFF

TEST(Off, VariantsOfTheHeader) {
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const Mesh expected{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  for (const char* header :
       {"OFF\n3 1 0\n", "OFF 3 1 0\n", "OFF3 1 0\n", "OFF\n3 1\n", "# c\n\nOFF # c\n# c\n3 1 0 # c\n\n",
        "OFF\n3\n1\n0\n", "COFF\n3 1 0\n", "NOFF\n3 1 0\n", "STCNOFF\n3 1 0\n"}) {
    expect_mesh(header + body, expected);
  }
}

TEST(Off, ColoursNormalsAndTextureAreCutOff) {
  const std::string text =
      "STCNOFF\n4 3 0\n0 0 0 0 0 1 255 0 0 255 0.5 0.5\n1 0 0 0 0 1 1 0 0 1 0 0 # comment\n# between\n0 1 0\n0 0 1\n"
      "3 0 1 2 255 0 0\n\n4 3 2 1 0 0.5 0.5 0.5 1 # comment\n2 0 1\n";
  expect_mesh(text, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}, {3, 2, 1}, {3, 1, 0}}});
  const MeshFile file = parse_mesh(text);
  EXPECT_EQ(file.polygons, 1u);
  EXPECT_EQ(file.skipped_elements, 1u);
}

TEST(Off, ErrorsNameLineAndElement) {
  expect_error("OFF BINARY\nxxxx", "binary OFF");
  expect_error("4OFF\n1 0 0\n0 0 0 0\n", "dimensions");
  expect_error("nOFF\n3\n1 0 0\n0 0 0\n", "dimensions");
  expect_error("OFF\n", "the number of vertices");
  expect_error("OFF\n3\n", "the number of faces");
  expect_error("OFF\n-3 1 0\n", "found '-3'");
  expect_error("OFF\n4000000000 1 0\n0 0 0\n", "announces 4000000000 vertices");
  expect_error("OFF\n1 4000000000 0\n0 0 0\n", "4000000000 faces");
  expect_error("OFF\n9000000000000000000 9000000000000000000 0\n0 0 0\n", "32-bit");
  const std::string head = "OFF\n3 1 0\n0 0 0\n1 0 0\n";
  expect_error(head + "0 z 0\n3 0 1 2\n", "line 5: vertex 2: expected a coordinate, found 'z'");
  expect_error(head + "0 1 0\n3 0 1\n", "line 6: face 0: expected a vertex index");
  expect_error(head + "0 1 0\n3 0 -1 2\n", "found '-1'");
  expect_error(head + "0 1 0\n-3 0 1 2\n", "number of corners");
  expect_error(head + "0 1 0\n# no face\n", "the file is truncated");
}

// ------------------------------------------------------------------------------------------------------------ STL

TEST(Stl, BinaryMayBeginWithSolid) {
  std::string bytes = written(tetrahedron(), MeshFormat::stl_binary);
  const Mesh expected = as_stl_keeps_it(tetrahedron());
  ASSERT_EQ(bytes.size(), 84u + 4 * 50);
  for (const char* title : {"solid of the wild\n", "OFF 1 1 0\n", "v 1 2 3\n"}) {
    bytes.replace(0, std::strlen(title), title);
    expect_mesh(bytes, expected);
  }
  bytes.replace(0, 5, "solid");
  expect_error(bytes.substr(0, bytes.size() - 1), "announces 4 triangles, which take 284 bytes, but it has 283");
  expect_error(std::string(1, '\xff') + bytes, "PLY, OBJ, STL, OFF");
}

TEST(Stl, AttributesAndNormalsAreIgnoredAndNormalsWritten) {
  std::string bytes = written(tetrahedron(), MeshFormat::stl_binary);
  const auto float_at = [&](std::size_t offset) {
    float x;
    std::memcpy(&x, bytes.data() + offset, sizeof x);
    return x;
  };
  EXPECT_EQ(float_at(84), 0);
  EXPECT_EQ(float_at(88), 0);
  EXPECT_EQ(float_at(92), -1) << "the first face looks down";
  for (std::size_t triangle = 0; triangle < 4; ++triangle) {
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(84 + 50 * triangle), 12, '\x7f');
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(84 + 50 * triangle + 48), 2, '\xff');
  }
  expect_mesh(bytes, as_stl_keeps_it(tetrahedron()));
  EXPECT_EQ(parse_mesh(bytes).welded_corners, 8u);
}

TEST(Stl, NormalsOfTinyHugeAndFlatTriangles) {
  const auto normal_line = [](double size) {
    const Mesh mesh{{{0, 0, 0}, {size, 0, 0}, {0, size, 0}}, {{0, 1, 2}}};
    const std::string text = written(mesh, MeshFormat::stl_ascii);
    return text.substr(text.find("facet"), text.find("\nouter") - text.find("facet"));
  };
  EXPECT_EQ(normal_line(1e-300), "facet normal 0 0 1");
  EXPECT_EQ(normal_line(1e300), "facet normal 0 0 1");
  EXPECT_EQ(normal_line(0), "facet normal 0 0 0");
}

TEST(Stl, AsciiSolidsCasesAndLoops) {
  const std::string facet =
      "facet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex 0 1 0\n endloop\nendfacet\n";
  const std::string mirror =
      "FACET NORMAL nan 1.#IND x\nOuter Loop\nVERTEX 0 0 -0\nvertex 0 1 0\nvertex 1 0 0\nENDLOOP\nEndFacet\n";
  const std::string quad = replaced(facet, " endloop", " vertex 1 1 0\n endloop");
  const Mesh expected{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  expect_mesh("solid a name of facets\n" + facet + "endsolid a name\nSOLID\n" + mirror + "ENDSOLID\n", expected);
  EXPECT_EQ(parse_mesh("solid\n" + quad + "endsolid").polygons, 1u);
  expect_mesh("solid empty\nendsolid\n", {});

  expect_error("solid\n" + facet, "'endsolid'");
  expect_error("solid\n" + facet + "solid\n" + facet + "endsolid\n", "facet 1: expected 'facet', found 'solid'");
  expect_error("solid\n" + facet + "endsolid\nvertex 0 0 0", "expected 'solid'");
  expect_error("solid\n" + replaced(facet, "vertex 1 0 0", "vertex 1 0"), "line 5: vertex 1");
  expect_error("solid\n" + replaced(facet, " vertex 1 0 0\n", ""), "expected 'vertex', found 'endloop'");
  expect_error("solid\n" + replaced(facet, "outer", "inner"), "line 3: facet 0: expected 'outer', found 'inner'");
}

// -------------------------------------------------------------------------------------------------------- damage

std::vector<std::string> samples() {
  std::vector<std::string> result;
  for (const MeshFormat format : all_formats) result.push_back(written(tetrahedron(), format, "comment"));
  PlyBuilder rich("binary_big_endian");
  rich.declare("element other 1").declare("property list int double values");
  rich.declare("element vertex 3").declare("property list uchar uchar list").declare("property float z");
  rich.declare("property double y").declare("property ushort x").declare("element face 1");
  rich.declare("property uchar flag").declare("property list int uint vertex_index");
  rich.record({{"int", 1}, {"double", 1}});
  for (int i = 0; i < 3; ++i) rich.record({{"uchar", 1}, {"uchar", 1}, {"float", 1}, {"double", 2}, {"ushort", 3}});
  rich.record({{"uchar", 0}, {"int", 4}, {"uint", 0}, {"uint", 1}, {"uint", 2}, {"uint", 0}});
  result.push_back(rich.bytes());
  result.push_back("v 0 0 0 1 1 1\nv 1e-400 nan inf\nvn 1 0 0\nv 1 1 \\\n 1 \\\nf 1/1/1 2//1 -1/2 \\\n 1\nl 1 2\n");
  result.push_back("COFF\n# c\n3 2 0\n0 0 0 1 1 1 1\n1 0 0\n0 1 0\n4 0 1 2 0 255 0 0\n2 0 1\n");
  return result;
}

// A file is read or refused with one line of text; nothing else may happen, the sanitizers' checks included.
void expect_clean_answer(const std::string& bytes) {
  const MeshFile file = parse_mesh(bytes);
  EXPECT_NE(file.ok, file.error.size() > 0);
  EXPECT_EQ(file.error.find('\n'), std::string::npos);
  EXPECT_LT(file.error.size(), 400u);
  EXPECT_LE(file.mesh.positions.size() + file.mesh.triangles.size(), bytes.size());
  EXPECT_TRUE(file.ok || (file.mesh.positions.empty() && file.mesh.triangles.empty()));
}

TEST(DamagedFiles, TruncatedAtEveryLength) {
  for (const std::string& sample : samples()) {
    ASSERT_TRUE(parse_mesh(sample).ok) << parse_mesh(sample).error;
    const bool binary = sample.find('\0') != std::string::npos;
    for (std::size_t size = 0; size < sample.size(); ++size) {
      expect_clean_answer(sample.substr(0, size));
      EXPECT_FALSE(binary && parse_mesh(sample.substr(0, size)).ok) << "lost " << sample.size() - size << " bytes";
    }
  }
}

TEST(DamagedFiles, RandomBytesChanged) {
  std::mt19937_64 random(2);
  const std::string likely = "0123456789-+.e/\\# \t\r\nvfOFF\xff\x7f\x80\x01" + std::string(1, '\0');
  for (const std::string& sample : samples()) {
    for (int i = 0; i < 3000; ++i) {
      std::string bytes = sample;
      for (std::uint64_t flips = 1 + random() % 4; flips > 0; --flips) {
        const bool any = random() % 2 == 0;
        bytes[random() % bytes.size()] = any ? static_cast<char>(random()) : likely[random() % likely.size()];
      }
      expect_clean_answer(bytes);
    }
  }
}

TEST(DamagedFiles, RandomPiecesMoved) {
  std::mt19937_64 random(3);
  for (const std::string& sample : samples()) {
    for (int i = 0; i < 1000; ++i) {
      std::string bytes = sample;
      const std::string piece = bytes.substr(random() % bytes.size(), random() % 40);
      bytes.insert(random() % bytes.size(), piece);
      bytes.erase(random() % bytes.size(), random() % 40);
      expect_clean_answer(bytes);
    }
  }
}

// -------------------------------------------------------------------------------------------------- files and pipes

TEST(Files, UnreadablePathsAreNamed) {
  const TemporaryDirectory directory;
  const std::string missing = directory.file("missing.ply");
  EXPECT_EQ(read_mesh(missing).error, missing + ": cannot open: No such file or directory");
  EXPECT_EQ(read_mesh(directory.file("")).error, directory.file("") + ": is a directory, not a mesh file");
  put_file(directory.file("empty.ply"), "");
  EXPECT_EQ(read_mesh(directory.file("empty.ply")).error, directory.file("empty.ply") + ": the file is empty");
  if (fs::exists("/proc/self/mem")) {
    EXPECT_EQ(read_mesh("/proc/self/mem").error, "/proc/self/mem: cannot read: Input/output error");
  }
  put_file(directory.file("bad.obj"), "v 0 0\n");
  EXPECT_TRUE(read_mesh(directory.file("bad.obj")).error.starts_with(directory.file("bad.obj") + ": line 1: "));
}

TEST(Files, TheExtensionDoesNotMatter) {
  const TemporaryDirectory directory;
  for (const MeshFormat format : all_formats) {
    ASSERT_TRUE(write_mesh(directory.file("mesh.ply"), format, tetrahedron()).ok);
    const MeshFile file = read_mesh(directory.file("mesh.ply"));
    EXPECT_TRUE(file.ok) << file.error;
    EXPECT_EQ(file.format, format);
  }
}

// A pipe with a reader or writer at its other end, reachable as a path.
class Pipe {
 public:
  Pipe() {
    if (pipe(ends_.data()) != 0) throw std::runtime_error("no pipe");
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  void close_end(std::size_t i) {
    if (ends_[i] >= 0) close(ends_[i]);
    ends_[i] = -1;
  }
  int end(std::size_t i) const { return ends_[i]; }
  std::string path(std::size_t i) const { return "/dev/fd/" + std::to_string(ends_[i]); }

 private:
  std::array<int, 2> ends_{-1, -1};
};

TEST(Files, PipesAreReadAndWritten) {
  Mesh mesh = extreme_mesh();  // longer than a pipe holds
  mesh.triangles.resize(mesh.triangles.size() * 50, {0, 1, 2});
  Pipe pipe;
  WriteResult result;
  std::thread writer([&] {
    result = write_mesh(pipe.path(1), MeshFormat::ply_binary, mesh);
    pipe.close_end(1);
  });
  const MeshFile file = read_mesh(pipe.path(0));
  writer.join();
  EXPECT_TRUE(result.ok) << result.error;
  ASSERT_TRUE(file.ok) << file.error;
  EXPECT_TRUE(identical(file.mesh, mesh));
}

// Puts a file in the place of standard input or output while it lives.
class Redirection {
 public:
  Redirection(int standard, const std::string& path, int flags) : standard_(standard), saved_(dup(standard)) {
    const int descriptor = open(path.c_str(), flags, 0600);
    dup2(descriptor, standard);
    close(descriptor);
  }
  ~Redirection() {
    dup2(saved_, standard_);
    close(saved_);
  }

 private:
  int standard_;
  int saved_;
};

TEST(Files, DashIsStandardInputAndOutput) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("mesh");
  const Mesh mesh = tetrahedron();
  std::fflush(stdout);
  for (const char* name : {"-", "/dev/stdout"}) {
    put_file(path, "OFF\n");  // what is there already stays: the shell appends
    const Redirection redirection(STDOUT_FILENO, path, O_WRONLY | O_APPEND);
    ASSERT_TRUE(write_mesh(name, MeshFormat::obj, mesh).ok);
    EXPECT_EQ(get_file(path), "OFF\n" + written(mesh, MeshFormat::obj));
  }
  put_file(path, written(mesh, MeshFormat::ply_binary));
  const Redirection redirection(STDIN_FILENO, path, O_RDONLY);
  const MeshFile file = read_mesh("-");
  ASSERT_TRUE(file.ok) << file.error;
  EXPECT_TRUE(identical(file.mesh, mesh));
  EXPECT_EQ(read_mesh("-").error, "standard input: the file is empty");
}

TEST(AtomicWrite, MissingDirectoryIsNamed) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("no/such/mesh.ply");
  const WriteResult result = write_mesh(path, MeshFormat::ply_binary, tetrahedron());
  EXPECT_FALSE(result.ok);
  EXPECT_EQ(result.error, path + ": cannot create a temporary file beside it: No such file or directory");
  EXPECT_FALSE(write_file(directory.file(""), "x", 1).ok);
  EXPECT_EQ(directory.entries(), 0u);
}

TEST(AtomicWrite, DirectoryIsNotReplaced) {
  const TemporaryDirectory directory;
  fs::create_directory(directory.file("target"));
  EXPECT_EQ(write_file(directory.file("target"), "x", 1).error,
            directory.file("target") + ": cannot write: Is a directory");
  EXPECT_TRUE(fs::is_directory(directory.file("target")));
}

// A limit on the size of files stands in for a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : previous_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &previous_);
    const rlimit limit{bytes, previous_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &previous_);
    std::signal(SIGXFSZ, previous_handler_);
  }

 private:
  void (*previous_handler_)(int);
  rlimit previous_{};
};

TEST(AtomicWrite, FullDiskLeavesTheOldFileAndNoOther) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("mesh.ply");
  put_file(path, "what was there");
  {
    const FileSizeLimit limit(1000);
    const WriteResult result = write_mesh(path, MeshFormat::ply_binary, extreme_mesh());
    EXPECT_EQ(result.error, path + ": cannot write: File too large");
    const std::string bytes(3 << 20, 'x');
    EXPECT_FALSE(write_file(directory.file("new"), bytes.data(), bytes.size()).ok);
  }
  EXPECT_EQ(get_file(path), "what was there");
  EXPECT_EQ(directory.entries(), 1u);
}

TEST(AtomicWrite, FullDeviceIsReported) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  EXPECT_EQ(write_file("/dev/full", "x", 1).error, "/dev/full: cannot write: No space left on device");
  EXPECT_FALSE(write_mesh("/dev/full", MeshFormat::stl_ascii, extreme_mesh()).ok);
}

TEST(AtomicWrite, LinksAndPermissionsStay) {
  const TemporaryDirectory directory;
  put_file(directory.file("target"), "old");
  fs::permissions(directory.file("target"), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("target", directory.file("link"));
  fs::create_symlink(directory.file("link"), directory.file("second_link"));
  fs::create_symlink("nowhere_yet", directory.file("dangling"));
  ASSERT_TRUE(write_file(directory.file("second_link"), "new", 3).ok);
  ASSERT_TRUE(write_file(directory.file("dangling"), "more", 4).ok);
  EXPECT_TRUE(fs::is_symlink(directory.file("link")) && fs::is_symlink(directory.file("second_link")));
  EXPECT_EQ(get_file(directory.file("target")), "new");
  EXPECT_EQ(get_file(directory.file("nowhere_yet")), "more");
  EXPECT_EQ(fs::status(directory.file("target")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(directory.entries(), 5u);
}

TEST(AtomicWrite, AnyBytesOfAnySize) {
  const TemporaryDirectory directory;
  constexpr std::size_t block = 1 << 20;  // the writer's
  std::string all(3 * block, '\0');
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<char>(i * 0x9e3779b97f4a7c15u >> 56);
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, block - 1, block, block + 1, 3 * block}) {
    ASSERT_TRUE(write_file(directory.file("bytes"), all.data(), size).ok);
    EXPECT_TRUE(get_file(directory.file("bytes")) == all.substr(0, size)) << size;
  }
}

// -------------------------------------------------------------------------------------------------------- welding

TEST(Weld, KeepsFirstOccurrencesInOrder) {
  const double nan = std::nan("");
  Mesh mesh{{{1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {-0.0, 0, -0.0}, {nan, 0, 0}, {nan, 0, 0}, {1, 0, 1e-300}},
            {{0, 1, 2}, {2, 3, 4}, {4, 5, 6}, {6, 7, 4000000000u}}};
  EXPECT_EQ(weld_equal_positions(mesh), 3u);
  ASSERT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.positions[0][0], 1);
  EXPECT_FALSE(std::signbit(mesh.positions[1][0]));
  EXPECT_EQ(mesh.positions[3][2], 1e-300);
  const Mesh expected{{}, {{0, 1, 0}, {0, 1, 2}, {2, 2, 3}, {3, 7, 4000000000u}}};
  EXPECT_EQ(mesh.triangles, expected.triangles);
  EXPECT_EQ(weld_equal_positions(mesh), 0u);
  Mesh nothing;
  EXPECT_EQ(weld_equal_positions(nothing), 0u);
}

TEST(Weld, AgreesWithAnOrderedMap) {
  std::mt19937_64 random(5);
  Mesh mesh;
  for (std::uint32_t i = 0; i < 30000; ++i) {
    mesh.positions.push_back({static_cast<double>(random() % 20), static_cast<double>(random() % 30) / 7, 0});
    mesh.triangles.push_back({i, static_cast<std::uint32_t>(random() % 30000), 0});
  }
  std::map<std::array<double, 3>, std::uint32_t> numbers;
  Mesh expected;
  std::vector<std::uint32_t> new_index;
  for (const auto& p : mesh.positions) {
    const auto [entry, is_new] = numbers.try_emplace(p, static_cast<std::uint32_t>(numbers.size()));
    if (is_new) expected.positions.push_back(p);
    new_index.push_back(entry->second);
  }
  for (const auto& t : mesh.triangles)
    expected.triangles.push_back({new_index[t[0]], new_index[t[1]], new_index[t[2]]});
  EXPECT_EQ(weld_equal_positions(mesh), 30000 - numbers.size());
  EXPECT_TRUE(identical(mesh, expected));
}

// ---------------------------------------------------------------------------------------------------- real meshes

std::string shared_directory() {
  if (const char* directory = std::getenv("PRCAGE_SHARED_DIR")) return directory;
#ifdef PRCAGE_SHARED_DIR
  return PRCAGE_SHARED_DIR;
#else
  return "../shared";
#endif
}

TEST(RealMeshes, HaveTheCountsOfTheManifest) {
  const fs::path meshes = fs::path(shared_directory()) / "meshes";
  std::ifstream manifest(meshes / "MANIFEST.csv");
  if (!manifest) GTEST_SKIP() << "no " << meshes / "MANIFEST.csv";
  std::string line;
  std::getline(manifest, line);
  ASSERT_TRUE(line.starts_with("name,category,faces,vertices,")) << line;
  std::size_t read = 0;
  while (std::getline(manifest, line)) {
    std::istringstream fields(line);
    std::string name, category, faces, vertices;
    std::getline(fields, name, ',');
    std::getline(fields, category, ',');
    std::getline(fields, faces, ',');
    std::getline(fields, vertices, ',');
    const MeshFile file = read_mesh((meshes / category / name).string());
    ASSERT_TRUE(file.ok) << file.error;
    EXPECT_EQ(file.mesh.triangles.size(), std::stoul(faces)) << name;
    EXPECT_EQ(file.mesh.positions.size(), std::stoul(vertices)) << name;
    ++read;
  }
  EXPECT_GT(read, 0u);
}

}  // namespace
}  // namespace prcage
