// Reads words and numbers from text in memory, for all text formats.
//
// Numbers go through std::from_chars: correctly rounded, independent of the locale, fast. Line ends are LF, CR LF
// or CR alone. The cursor counts no lines while it reads; line() counts them when an error has to be reported.
#pragma once

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>

namespace prcage {

class TextCursor {
 public:
  explicit TextCursor(std::string_view text, std::size_t offset = 0)
      : begin_(text.data()), position_(text.data() + offset), end_(text.data() + text.size()) {}

  bool at_end() const { return position_ == end_; }
  bool at_line_end() const { return at_end() || is_line_end(*position_); }
  bool at(char c) const { return !at_end() && *position_ == c; }
  std::size_t remaining() const { return static_cast<std::size_t>(end_ - position_); }

  // Number of the current line, from 1. Costs a pass over the text: for messages only.
  std::size_t line() const;

  // What stands here, for messages: the next word in quotes, or that a line or the file ends.
  std::string found() const;

  // Passes over characters that are known to be there.
  void advance(std::size_t characters = 1) { position_ += characters; }

  // Spaces and tabs.
  void skip_blanks() {
    while (!at_end() && is_blank(*position_)) ++position_;
  }

  // Spaces, tabs and line ends.
  void skip_space() {
    while (!at_end() && (is_blank(*position_) || is_line_end(*position_))) ++position_;
  }

  // Like skip_space(), and comments from '#' to the end of the line too.
  void skip_space_and_comments() {
    for (skip_space(); at('#'); skip_space()) skip_to_line_end();
  }

  void skip_to_line_end();

  // The characters up to the next space or line end.
  std::string_view peek_word() const {
    const char* stop = position_;
    while (stop != end_ && !is_space(*stop)) ++stop;
    return {position_, static_cast<std::size_t>(stop - position_)};
  }

  std::string_view read_word() {
    const std::string_view word = peek_word();
    position_ += word.size();
    return word;
  }

  // OBJ continues a line by a backslash before its end. Passes over both, at the backslash.
  bool skip_backslash_line_end() {
    if (!at('\\') || end_ - position_ < 2 || !is_line_end(position_[1])) return false;
    ++position_;
    skip_line_end();
    return true;
  }

  // The same at the end of a line whose characters were skipped without a look.
  bool skip_line_end_after_backslash() {
    if (at_end() || position_ == begin_ || position_[-1] != '\\') return false;
    skip_line_end();
    return true;
  }

  // A number must end here: at a space, a backslash or the end of the text.
  bool at_number_end() const { return ends_number(position_); }

  // A number, up to where numbers may end. What is beyond the doubles becomes infinite, what is
  // too small becomes zero. False, and nothing is consumed, if there is no such number.
  bool read_number(double& value) {
    const char* const first = after_plus();
    const auto [stop, error] = std::from_chars(first, end_, value);
    if (error == std::errc::invalid_argument || !ends_number(stop)) return false;
    if (error == std::errc::result_out_of_range) value = infinity_or_zero({first, stop});
    position_ = stop;
    return true;
  }

  // The leading whole number of a word, whatever follows. False, and nothing is consumed, if there is none.
  bool read_integer_prefix(std::int64_t& value) {
    const auto [stop, error] = std::from_chars(after_plus(), end_, value);
    if (error != std::errc()) return false;
    position_ = stop;
    return true;
  }

  // A whole number up to where numbers may end.
  bool read_integer(std::int64_t& value) {
    const char* const start = position_;
    if (read_integer_prefix(value) && at_number_end()) return true;
    position_ = start;
    return false;
  }

  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
  static bool is_line_end(char c) { return c == '\n' || c == '\r'; }
  static bool is_space(char c) { return is_blank(c) || is_line_end(c); }

 private:
  bool ends_number(const char* c) const { return c == end_ || is_space(*c) || *c == '\\'; }

  // At a line end.
  void skip_line_end() {
    const bool crlf = *position_ == '\r' && end_ - position_ >= 2 && position_[1] == '\n';
    position_ += crlf ? 2 : 1;
  }

  // std::from_chars knows no plus sign.
  const char* after_plus() const {
    const bool plus = end_ - position_ >= 2 && position_[0] == '+' && position_[1] != '-';
    return position_ + plus;
  }

  static double infinity_or_zero(std::string_view number);

  const char* begin_;
  const char* position_;
  const char* end_;
};

// Text from a file made fit for a one-line message: shortened, and nothing in it but printable ASCII.
std::string quoted(std::string_view text);

}  // namespace prcage
