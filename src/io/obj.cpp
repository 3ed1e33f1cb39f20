// Wavefront OBJ: vertices and faces, one statement a line. Texture coordinates, normals, colours, weights, groups
// and materials are passed over; a backslash at the end of a line continues the statement on the next one.
#include <algorithm>

#include "io/formats.h"

namespace prcage {
namespace {

// Statements by which a file is recognised. While reading, other words are passed over too: programs add their own.
constexpr std::array<std::string_view, 22> known_keywords{
    "v",  "vt",     "vn",     "vp",     "f",      "fo",     "l",     "p",        "o",        "g",   "s",
    "mg", "usemtl", "mtllib", "maplib", "usemap", "cstype", "bevel", "c_interp", "d_interp", "lod", "shadow_obj"};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

bool is_keyword_like(std::string_view word) {
  const auto may_follow = [](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '-'; };
  return is_letter(word.front()) && std::all_of(word.begin(), word.end(), may_follow);
}

class ObjReader {
 public:
  ObjReader(std::string_view bytes, MeshFile& file) : cursor_(bytes), file_(file) {}

  bool read() {
    while (true) {
      cursor_.skip_space_and_comments();
      if (cursor_.at_end()) break;
      if (!read_statement()) return false;
    }
    return !file_.mesh.positions.empty() || fail(file_, "no vertex (a line 'v x y z') in the file");
  }

 private:
  bool read_statement() {
    const std::string_view keyword = cursor_.peek_word();
    const TextCursor start = cursor_;
    cursor_.read_word();
    if (keyword == "v") {
      if (!read_vertex()) return false;
    } else if (keyword == "f" || keyword == "fo") {
      if (!read_face()) return false;
    } else if (keyword == "l" || keyword == "p" || keyword == "curv" || keyword == "curv2" || keyword == "surf") {
      ++file_.skipped_elements;
    } else if (!is_keyword_like(keyword)) {
      cursor_ = start;
      return fail(file_, cursor_, quoted(keyword) + " is no statement of an OBJ file");
    }
    skip_statement();
    return true;
  }

  bool read_vertex() {
    constexpr const char* too_many = "more vertices than 32-bit indices can name";
    if (file_.mesh.positions.size() == max_vertices) return fail(file_, too_many);
    std::array<double, 3> position;
    for (double& coordinate : position) {
      skip_blanks();
      if (!cursor_.read_number(coordinate)) {
        return fail_expected(file_, cursor_, "vertex", file_.mesh.positions.size(), "a coordinate");
      }
    }
    file_.mesh.positions.push_back(position);
    return true;
  }

  bool read_face() {
    Fan fan(file_);
    for (skip_blanks(); !cursor_.at_line_end() && !cursor_.at('#'); skip_blanks()) {
      std::uint32_t vertex = 0;
      if (!read_corner(vertex)) return false;
      fan.add(vertex);
    }
    fan.finish();
    ++faces_;
    return true;
  }

  bool read_corner(std::uint32_t& vertex) {
    const TextCursor start = cursor_;
    std::int64_t index = 0;
    if (cursor_.read_integer_prefix(index) && skip_attributes() && resolve(index, vertex)) return true;
    cursor_ = start;
    return fail_expected(file_, cursor_, "face", faces_, "a vertex index (counted from 1, or backwards from -1)");
  }

  // The texture and normal indices of "7/2", "7//5" and "7/2/5".
  bool skip_attributes() {
    std::int64_t ignored;
    while (cursor_.at('/')) {
      cursor_.advance();
      cursor_.read_integer_prefix(ignored);
    }
    return cursor_.at_number_end();
  }

  // Indices count from 1; negative ones count back from the vertex before.
  bool resolve(std::int64_t index, std::uint32_t& vertex) const {
    const auto vertices = static_cast<std::int64_t>(file_.mesh.positions.size());
    const std::int64_t from_zero = index > 0 ? index - 1 : index < 0 && index >= -vertices ? vertices + index : -1;
    if (!is_index(from_zero)) return false;
    vertex = static_cast<std::uint32_t>(from_zero);
    return true;
  }

  // Blanks and the line ends that a backslash hides.
  void skip_blanks() {
    cursor_.skip_blanks();
    while (cursor_.skip_backslash_line_end()) cursor_.skip_blanks();
  }

  // The rest of the statement, over continued lines.
  void skip_statement() {
    do {
      cursor_.skip_to_line_end();
    } while (cursor_.skip_line_end_after_backslash());
  }

  TextCursor cursor_;
  MeshFile& file_;
  std::size_t faces_ = 0;
};

}  // namespace

bool looks_like_obj(std::string_view bytes) {
  TextCursor cursor(bytes);
  cursor.skip_space_and_comments();
  const std::string_view word = cursor.read_word();
  return std::find(known_keywords.begin(), known_keywords.end(), word) != known_keywords.end() && !cursor.at_line_end();
}

bool read_obj(std::string_view bytes, MeshFile& file) {
  file.format = MeshFormat::obj;
  return ObjReader(bytes, file).read();
}

void write_obj(OutputFile& out, const Mesh& mesh, const std::string& comment) {
  if (!comment.empty()) out.write("# " + comment + "\n");
  for (const auto& p : mesh.positions) out.write_line("v ", p);
  for (const auto& triangle : mesh.triangles) {
    out.write("f");
    for (const std::uint32_t corner : triangle) {
      out.write_char(' ');
      out.write_number(std::uint64_t{corner} + 1);
    }
    out.write_char('\n');
  }
}

}  // namespace prcage
