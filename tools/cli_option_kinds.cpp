#include "tools/cli_option_kinds.h"

#include <cmath>
#include <utility>

#include <CLI/CLI.hpp>

namespace prcage {
namespace {

bool parse_decimal(std::string_view text, double& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && stop == end;
}

}  // namespace

AddedOption AddedOption::required() const { return AddedOption(option_->required()); }
AddedOption AddedOption::needs(AddedOption other) const { return AddedOption(option_->needs(other.option_)); }
AddedOption AddedOption::excludes(AddedOption other) const { return AddedOption(option_->excludes(other.option_)); }
AddedOption AddedOption::described(const std::string& help) const { return AddedOption(option_->description(help)); }
AddedOption AddedOption::of_kind(const std::string& kind) const { return AddedOption(option_->type_name(kind)); }

void refuse(const std::string& option, const std::string& why) { throw CLI::ValidationError(option, why); }
void refuse(const std::string& why) { throw CLI::ValidationError(why); }
void refuse_missing(const std::string& option) { throw CLI::RequiredError(option); }

AddedOption add_argument(CLI::App& app, const std::string& name, std::string& value, const std::string& help) {
  return AddedOption(app.add_option(name, value, help)->type_name(""));
}

AddedOption add_arguments(CLI::App& app, const std::string& name, std::vector<std::string>& values,
                          const std::string& help) {
  return AddedOption(app.add_option(name, values, help)->type_name(""));
}

AddedOption add_text(CLI::App& app, const std::string& name, std::string& value, const std::string& kind,
                     const std::string& help) {
  return AddedOption(app.add_option(name, value, help)->type_name(kind));
}

// The parser would accept "--quiet=maybe" and pass over the value.
AddedOption add_flag(CLI::App& app, const std::string& name, bool& value, const std::string& help) {
  return AddedOption(app.add_flag(name, value, help)->disable_flag_override());
}

AddedOption add_off_flag(CLI::App& app, const std::string& name, bool& value, const std::string& help) {
  const auto turn_off = [&value] { value = false; };
  return AddedOption(app.add_flag_callback(name, turn_off, help)->disable_flag_override());
}

AddedOption add_ratio(CLI::App& app, const std::string& name, double& value, double most, const std::string& help) {
  const auto parse = [name, &value, most](const std::string& text) {
    double parsed = 0;
    if (!parse_ratio(text, parsed))
      refuse(name, fmt::format("'{}' is not a positive number such as 0.025 or 1/40", text));
    if (parsed > most) refuse(name, fmt::format("'{}' is out of range: above 0, at most {}", text, most));
    value = parsed;
  };
  return add_parsed(app, name, parse, "X", help);
}

AddedOption add_degrees(CLI::App& app, const std::string& name, double& value, double most, const std::string& help) {
  const auto parse = [name, &value, most](const std::string& text) {
    double parsed = 0;
    if (!parse_decimal(text, parsed) || !(std::abs(parsed) <= most))
      refuse(name, fmt::format("'{}' is not a number from {} to {}", text, -most, most));
    value = parsed;
  };
  return add_parsed(app, name, parse, "DEGREES", help);
}

AddedOption add_parsed(CLI::App& app, const std::string& name, const std::function<void(const std::string&)>& parse,
                       const std::string& kind, const std::string& help) {
  return AddedOption(app.add_option_function<std::string>(name, parse, help)->type_name(kind));
}

std::vector<std::string> split_at_commas(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

bool parse_ratio(const std::string& text, double& value) {
  const std::size_t slash = text.find('/');
  double numerator = 0;
  double denominator = 1;
  if (!parse_decimal(std::string_view(text).substr(0, slash), numerator)) return false;
  if (slash != std::string::npos && !parse_decimal(std::string_view(text).substr(slash + 1), denominator)) return false;
  const double ratio = numerator / denominator;
  if (!(std::isfinite(denominator) && std::isfinite(ratio) && numerator > 0 && ratio > 0)) return false;
  value = ratio;
  return true;
}

bool given(const CLI::App& app, const std::string& option) { return app.count(option) != 0; }

std::size_t number_given(const CLI::App& app) { return app.parse_order().size(); }

void when_parsed(CLI::App& app, std::function<void()> finish) { app.callback(std::move(finish)); }

}  // namespace prcage
