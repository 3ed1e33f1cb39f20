// OFF of Geomview, ascii: "OFF" and its variants with colours (C), normals (N) and texture coordinates (ST) behind
// the coordinates, which are passed over like the colours behind faces. One vertex or face a line.
#include <algorithm>

#include "io/formats.h"

namespace prcage {
namespace {

// The first word of the file split in two: what stands before "OFF", and what is glued behind it. Some programs
// write the number of vertices right after the word.
struct Magic {
  bool found = false;
  std::string_view prefix;
  std::string_view suffix;
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

Magic find_magic(std::string_view word) {
  const std::size_t off = word.find("OFF");
  if (off == std::string_view::npos) return {};
  const Magic magic{true, word.substr(0, off), word.substr(off + 3)};
  const bool good_prefix = magic.prefix.find_first_not_of("STCN4n") == std::string_view::npos;
  const bool good_suffix = std::all_of(magic.suffix.begin(), magic.suffix.end(), is_digit);
  return good_prefix && good_suffix ? magic : Magic{};
}

class OffReader {
 public:
  OffReader(std::string_view bytes, MeshFile& file) : cursor_(bytes), file_(file) {}

  bool read() { return read_header() && read_vertices() && read_faces(); }

 private:
  bool read_header() {
    cursor_.skip_space_and_comments();
    const Magic magic = find_magic(cursor_.peek_word());
    if (magic.prefix.find_first_of("4n") != std::string_view::npos) {
      return fail(file_, cursor_, "vertices of four and more dimensions are not supported: write plain OFF");
    }
    cursor_.advance(magic.prefix.size() + 3);
    cursor_.skip_space_and_comments();
    if (cursor_.peek_word() == "BINARY") {
      return fail(file_, cursor_, "binary OFF is not supported: write it as text or as PLY");
    }
    if (!read_count(vertices_, "the number of vertices") || !read_count(faces_, "the number of faces")) return false;
    skip_edge_count();
    return check_sizes();
  }

  bool read_count(std::uint64_t& count, const char* expected) {
    cursor_.skip_space_and_comments();
    std::int64_t value = 0;
    const TextCursor start = cursor_;
    if (!cursor_.read_integer(value) || value < 0) {
      cursor_ = start;
      return fail(file_, cursor_, std::string("expected ") + expected + ", found " + cursor_.found());
    }
    count = static_cast<std::uint64_t>(value);
    return true;
  }

  // A vertex takes six characters at least ("0 0 0" and a line end), a face two.
  bool check_sizes() {
    const std::uint64_t room = cursor_.remaining() + 1;
    if (vertices_ > max_vertices) return fail(file_, cursor_, "more vertices than 32-bit indices can name");
    if (vertices_ <= room / 6 && faces_ <= (room - 6 * vertices_) / 2) return true;
    return fail(file_, cursor_,
                "the header announces " + std::to_string(vertices_) + " vertices and " + std::to_string(faces_) +
                    " faces, but only " + std::to_string(cursor_.remaining()) +
                    " bytes follow: the file is truncated or its header damaged");
  }

  // The number of edges means nothing. Some programs leave it out: on a line of its own it is alone, a vertex is not.
  void skip_edge_count() {
    cursor_.skip_blanks();
    if (cursor_.at_line_end()) {
      TextCursor ahead = cursor_;
      ahead.skip_space_and_comments();
      std::int64_t edges = 0;
      const bool whole = ahead.read_integer(edges);
      ahead.skip_blanks();
      if (whole && ahead.at_line_end()) cursor_ = ahead;
    }
    cursor_.skip_to_line_end();
  }

  bool read_vertices() {
    file_.mesh.positions.resize(vertices_);
    for (std::size_t i = 0; i < vertices_; ++i) {
      cursor_.skip_space_and_comments();
      if (!read_position(cursor_, file_, i, file_.mesh.positions[i])) return false;
      cursor_.skip_to_line_end();
    }
    return true;
  }

  bool read_faces() {
    constexpr std::size_t least_line = 8;  // "3 0 1 2" and a line end
    file_.mesh.triangles.reserve(std::min<std::size_t>(faces_, cursor_.remaining() / least_line + 1));
    for (std::size_t i = 0; i < faces_; ++i) {
      cursor_.skip_space_and_comments();
      if (!read_face(i)) return false;
      cursor_.skip_to_line_end();
    }
    return true;
  }

  bool read_face(std::size_t number) {
    std::int64_t corners = 0;
    if (!cursor_.read_integer(corners) || corners < 0) {
      return fail_expected(file_, cursor_, "face", number, "the number of corners");
    }
    Fan fan(file_);
    for (std::int64_t i = 0; i < corners; ++i) {
      cursor_.skip_blanks();
      const TextCursor start = cursor_;
      std::int64_t index = 0;
      if (!cursor_.read_integer(index) || !is_index(index)) {
        cursor_ = start;
        return fail_expected(file_, cursor_, "face", number, "a vertex index from 0 to 4294967295");
      }
      fan.add(static_cast<std::uint32_t>(index));
    }
    fan.finish();
    return true;
  }

  TextCursor cursor_;
  MeshFile& file_;
  std::uint64_t vertices_ = 0;
  std::uint64_t faces_ = 0;
};

}  // namespace

bool looks_like_off(std::string_view bytes) {
  TextCursor cursor(bytes);
  cursor.skip_space_and_comments();
  return find_magic(cursor.peek_word()).found;
}

bool read_off(std::string_view bytes, MeshFile& file) {
  file.format = MeshFormat::off;
  return OffReader(bytes, file).read();
}

void write_off(OutputFile& out, const Mesh& mesh, const std::string& comment) {
  out.write("OFF\n");
  if (!comment.empty()) out.write("# " + comment + "\n");
  out.write(std::to_string(mesh.positions.size()) + " " + std::to_string(mesh.triangles.size()) + " 0\n");
  for (const auto& p : mesh.positions) out.write_line("", p);
  for (const auto& triangle : mesh.triangles) out.write_line("3 ", triangle);
}

}  // namespace prcage
