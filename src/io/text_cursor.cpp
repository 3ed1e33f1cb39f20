// The rarely used parts of the text cursor: positions and words for messages, numbers outside the doubles.
#include "io/text_cursor.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace prcage {

std::size_t TextCursor::line() const {
  std::size_t lines = 1;
  for (const char* c = begin_; c != position_; ++c) {
    const bool half_of_crlf = *c == '\r' && c + 1 != end_ && c[1] == '\n';
    lines += is_line_end(*c) && !half_of_crlf;
  }
  return lines;
}

std::string TextCursor::found() const {
  if (at_end()) return "the end of the file";
  if (at_line_end()) return "the end of the line";
  return quoted(peek_word());
}

void TextCursor::skip_to_line_end() {
  if (at_end()) return;
  // memchr is faster than a loop of our own even for two passes over a line.
  const void* feed = std::memchr(position_, '\n', remaining());
  const char* stop = feed ? static_cast<const char*>(feed) : end_;
  const void* carriage = std::memchr(position_, '\r', static_cast<std::size_t>(stop - position_));
  position_ = carriage ? static_cast<const char*>(carriage) : stop;
}

// The number is out of range: only the power of ten of its first digit that is not zero has to be found.
double TextCursor::infinity_or_zero(std::string_view number) {
  const bool negative = number.front() == '-';
  if (negative) number.remove_prefix(1);
  const std::size_t mantissa_size = std::min(number.find_first_of("eE"), number.size());
  const std::string_view mantissa = number.substr(0, mantissa_size);
  const auto point = static_cast<std::int64_t>(std::min(mantissa.find('.'), mantissa.size()));
  const auto digit = static_cast<std::int64_t>(std::min(mantissa.find_first_of("123456789"), mantissa.size()));

  // Exponents that do not even fit an integer are as large as matters.
  std::int64_t exponent = 0;
  if (mantissa_size < number.size()) {
    std::string_view text = number.substr(mantissa_size + 1);
    if (text.front() == '+') text.remove_prefix(1);
    const auto result = std::from_chars(text.data(), text.data() + text.size(), exponent);
    constexpr std::int64_t huge = std::numeric_limits<std::int64_t>::max() / 4;
    if (result.ec == std::errc::result_out_of_range) exponent = text.front() == '-' ? -huge : huge;
    exponent = std::min(std::max(exponent, -huge), huge);
  }
  const double magnitude = point - digit + exponent > 0 ? std::numeric_limits<double>::infinity() : 0.0;
  return negative ? -magnitude : magnitude;
}

std::string quoted(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string result = "'";
  for (const char c : text.substr(0, longest)) result += c >= ' ' && c <= '~' ? c : '?';
  return result + (text.size() > longest ? "...'" : "'");
}

}  // namespace prcage
