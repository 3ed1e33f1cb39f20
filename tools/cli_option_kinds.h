// What options are made of, in words of our own: kinds of values, each with its check and its error, and what one
// option may say of another. The headers of the parser take seconds to compile; only the sources that implement this
// and the command line as a whole include them.
#pragma once

#include <charconv>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace prcage {

// An option or argument that a command has by now.
class AddedOption {
 public:
  explicit AddedOption(CLI::Option* option) : option_(option) {}

  AddedOption required() const;
  AddedOption needs(AddedOption other) const;
  AddedOption excludes(AddedOption other) const;
  AddedOption described(const std::string& help) const;
  AddedOption of_kind(const std::string& kind) const;  // "N", "FILE": what the help calls its value

 private:
  CLI::Option* option_;
};

// Errors in what was given for an option, or in arguments as a whole: end the parsing.
[[noreturn]] void refuse(const std::string& option, const std::string& why);
[[noreturn]] void refuse(const std::string& why);
[[noreturn]] void refuse_missing(const std::string& option);

// Every `value` must outlive the parsing, and holds its default before it.
AddedOption add_argument(CLI::App& app, const std::string& name, std::string& value, const std::string& help);
AddedOption add_arguments(CLI::App& app, const std::string& name, std::vector<std::string>& values,
                          const std::string& help);
AddedOption add_text(CLI::App& app, const std::string& name, std::string& value, const std::string& kind,
                     const std::string& help);
AddedOption add_flag(CLI::App& app, const std::string& name, bool& value, const std::string& help);
AddedOption add_off_flag(CLI::App& app, const std::string& name, bool& value, const std::string& help);

// A positive number of at most `most`, which may be infinite.
AddedOption add_ratio(CLI::App& app, const std::string& name, double& value, double most, const std::string& help);

// A number of at most `most` in magnitude.
AddedOption add_degrees(CLI::App& app, const std::string& name, double& value, double most, const std::string& help);

// `parse` takes the text, and refuses it if it is wrong.
AddedOption add_parsed(CLI::App& app, const std::string& name, const std::function<void(const std::string&)>& parse,
                       const std::string& kind, const std::string& help);

template <class Value>
AddedOption add_parsed(CLI::App& app, const std::string& name, Value& value, Value (*parse)(const std::string&),
                       const std::string& kind, const std::string& help) {
  return add_parsed(
      app, name, [&value, parse](const std::string& text) { value = parse(text); }, kind, help);
}

template <class Integer>
struct CountRange {
  Integer least = 0;
  Integer most = std::numeric_limits<Integer>::max();

  std::string text() const {
    const bool bounded = most < std::numeric_limits<Integer>::max();
    return bounded ? fmt::format("from {} to {}", least, most) : fmt::format("of at least {}", least);
  }
};

// Whole decimal number. The parser's own conversion takes -1 as a huge unsigned number and 010 as an octal one.
template <class Integer>
bool parse_whole(std::string_view text, Integer& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && stop == end;
}

template <class Integer>
AddedOption add_count(CLI::App& app, const std::string& name, Integer& value, CountRange<Integer> range,
                      const std::string& help) {
  const auto parse = [name, &value, range](const std::string& text) {
    Integer parsed{};
    if (!parse_whole(text, parsed) || parsed < range.least || parsed > range.most)
      refuse(name, fmt::format("'{}' is not a whole number {}", text, range.text()));
    value = parsed;
  };
  return add_parsed(app, name, parse, "N", help);
}

// What is between the commas of a list, empty parts as well.
std::vector<std::string> split_at_commas(const std::string& text);

// Positive finite number: a decimal ("0.025", "2.5e-2") or a fraction ("1/40"), the nearest double to it. False if
// `text` is anything else.
bool parse_ratio(const std::string& text, double& value);

bool given(const CLI::App& app, const std::string& option);
std::size_t number_given(const CLI::App& app);  // of options and arguments

// `finish` is called once all that was given to the command has been taken, and may still refuse it.
void when_parsed(CLI::App& app, std::function<void()> finish);

}  // namespace prcage
