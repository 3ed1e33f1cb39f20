// Parser of PLY headers. Line ends may be LF, CR LF or CR; the first line tells which, because a binary body may
// begin with a byte that looks like a line end.
#include "io/ply_header.h"

#include <algorithm>
#include <array>
#include <utility>

#include "io/text_cursor.h"

namespace prcage {
namespace {

constexpr std::array<std::pair<std::string_view, PlyType>, 16> type_names{{
    {"char", PlyType::int8},
    {"uchar", PlyType::uint8},
    {"short", PlyType::int16},
    {"ushort", PlyType::uint16},
    {"int", PlyType::int32},
    {"uint", PlyType::uint32},
    {"float", PlyType::float32},
    {"double", PlyType::float64},
    {"int8", PlyType::int8},
    {"uint8", PlyType::uint8},
    {"int16", PlyType::int16},
    {"uint16", PlyType::uint16},
    {"int32", PlyType::int32},
    {"uint32", PlyType::uint32},
    {"float32", PlyType::float32},
    {"float64", PlyType::float64},
}};

class HeaderParser {
 public:
  explicit HeaderParser(std::string_view bytes) : bytes_(bytes) {}

  PlyHeader parse() {
    choose_line_end();
    while (header_.error.empty() && !ended_) {
      if (!next_line()) fail("the header has no end_header: the file is truncated");
      if (header_.error.empty() && line_number_ > 1) parse_line();
    }
    if (header_.error.empty() && !has_format_) fail("the header has no format line");
    header_.body = offset_;
    return std::move(header_);
  }

 private:
  void choose_line_end() {
    const std::size_t first = std::min(bytes_.find_first_of("\r\n"), bytes_.size());
    const bool carriage_only = bytes_.substr(first, 1) == "\r" && bytes_.substr(first, 2) != "\r\n";
    line_end_ = carriage_only ? '\r' : '\n';
  }

  // Splits the next line into words; a CR before the LF is blank.
  bool next_line() {
    const std::size_t stop = bytes_.find(line_end_, offset_);
    if (stop == std::string_view::npos && offset_ == bytes_.size()) return false;
    const std::string_view line = bytes_.substr(offset_, stop == std::string_view::npos ? stop : stop - offset_);
    offset_ = stop == std::string_view::npos ? bytes_.size() : stop + 1;
    ++line_number_;
    words_.clear();
    TextCursor cursor(line);
    for (cursor.skip_space(); !cursor.at_end(); cursor.skip_space()) words_.push_back(cursor.read_word());
    return true;
  }

  void parse_line() {
    const std::string_view keyword = words_.empty() ? std::string_view() : words_[0];
    if (keyword.empty() || keyword == "comment" || keyword == "obj_info") return;
    if (keyword == "format") return parse_format();
    if (keyword == "element") return parse_element();
    if (keyword == "property") return parse_property();
    if (keyword == "end_header") {
      ended_ = true;
      return;
    }
    fail(quoted(keyword) + " is no keyword of a PLY header");
  }

  void parse_format() {
    const std::string_view name = words_.size() > 1 ? words_[1] : std::string_view();
    has_format_ = true;
    if (name == "ascii") {
      header_.encoding = PlyEncoding::ascii;
    } else if (name == "binary_little_endian") {
      header_.encoding = PlyEncoding::little_endian;
    } else if (name == "binary_big_endian") {
      header_.encoding = PlyEncoding::big_endian;
    } else {
      fail("format " + quoted(name) + " is none of ascii, binary_little_endian, binary_big_endian");
    }
    if (words_.size() != 3 || words_[2] != "1.0") fail("only version 1.0 of the PLY format is known");
  }

  void parse_element() {
    PlyElement element;
    if (words_.size() != 3) return fail("expected 'element <name> <count>'");
    const auto [stop, error] = std::from_chars(words_[2].data(), words_[2].data() + words_[2].size(), element.count);
    if (error != std::errc() || stop != words_[2].data() + words_[2].size()) {
      return fail("the count " + quoted(words_[2]) + " is not a whole number that fits 64 bits");
    }
    constexpr std::size_t most_elements = 1000;  // real files have two or three; keeps the search below cheap
    if (header_.elements.size() == most_elements) return fail("more than 1000 elements");
    element.name = words_[1];
    for (const PlyElement& other : header_.elements) {
      if (other.name == element.name) return fail("element " + quoted(element.name) + " is declared twice");
    }
    header_.elements.push_back(std::move(element));
  }

  void parse_property() {
    if (header_.elements.empty()) return fail("a property before the first element");
    PlyProperty property;
    property.is_list = words_.size() > 1 && words_[1] == "list";
    if (words_.size() != (property.is_list ? 5u : 3u)) {
      return fail("expected 'property <type> <name>' or 'property list <type> <type> <name>'");
    }
    if (property.is_list) property.count_type = parse_type(words_[2]);
    property.type = parse_type(words_[property.is_list ? 3 : 1]);
    property.name = words_.back();
    const bool bad_count = property.count_type == PlyType::float32 || property.count_type == PlyType::float64;
    if (bad_count) return fail("the length of a list cannot be of a floating-point type");
    header_.elements.back().properties.push_back(std::move(property));
  }

  PlyType parse_type(std::string_view word) {
    for (const auto& [name, type] : type_names) {
      if (name == word) return type;
    }
    fail(quoted(word) + " is no type of the PLY format");
    return {};
  }

  void fail(const std::string& what) {
    if (header_.error.empty()) header_.error = "line " + std::to_string(line_number_) + ": " + what;
  }

  std::string_view bytes_;
  char line_end_ = '\n';
  std::size_t offset_ = 0;
  std::size_t line_number_ = 0;
  std::vector<std::string_view> words_;
  bool has_format_ = false;
  bool ended_ = false;
  PlyHeader header_;
};

}  // namespace

std::size_t size_of(PlyType type) {
  constexpr std::array<std::uint8_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

std::size_t PlyElement::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property) return i;
  }
  return none;
}

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.is_list; });
}

std::size_t PlyElement::least_bytes() const {
  std::size_t bytes = 0;
  for (const PlyProperty& p : properties) bytes += size_of(p.is_list ? p.count_type : p.type);
  return bytes;
}

PlyHeader parse_ply_header(std::string_view bytes) { return HeaderParser(bytes).parse(); }

}  // namespace prcage
