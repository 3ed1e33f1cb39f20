#include "tools/cli_help.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <utility>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "core/prcage.h"
#include "tools/wrap/alpha_wrap.h"

namespace prcage {
namespace {

class HelpFormatter : public CLI::Formatter {
 public:
  explicit HelpFormatter(std::vector<std::string> usages) : usages_(std::move(usages)) {
    column_width(28);
    label("Positionals", "Arguments");
  }

  std::string make_usage(const CLI::App*, std::string name) const override {
    std::string text;
    for (const std::string& usage : usages_)
      text += fmt::format("{:<6} {} {}\n", text.empty() ? "Usage:" : "", name, usage);
    return text;
  }

  // The kind of value alone: what is required or excluded is said by the usage and the descriptions.
  std::string make_option_opts(const CLI::Option* option) const override {
    const bool has_value = option->get_expected_max() > 0 && !option->get_type_name().empty();
    return has_value ? fmt::format(" {}", option->get_type_name()) : "";
  }

 private:
  std::vector<std::string> usages_;
};

// ------------------------------------------------------------------------------------------------ suggestions

// Least number of characters to insert, remove or replace that turns one word into the other.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

// "; did you mean ...?", or nothing if no word is close.
std::string suggestion(const std::string& name, const std::vector<std::string>& words) {
  constexpr std::size_t largest_distance = 2;
  const auto distance = [&name](const std::string& word) { return edit_distance(name, word); };
  const auto nearest = std::min_element(words.begin(), words.end(), [&](const std::string& a, const std::string& b) {
    return distance(a) < distance(b);
  });
  if (nearest == words.end() || distance(*nearest) > std::min(largest_distance, name.size() / 2)) return {};
  return fmt::format("; did you mean {}?", *nearest);
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back(fmt::format("--{}", name));
  }
  return names;
}

// ------------------------------------------------------------------------------------------------ usage errors

std::string unknown_option(const CLI::App& command, const std::string& argument) {
  const std::string name = argument.substr(0, argument.find('='));
  return fmt::format("unknown option {}{}", name, suggestion(name, option_names(command)));
}

// The first argument that the program or its command did not take and that `predicate` holds for, or nothing.
template <typename Predicate>
std::string first_left_over(const CLI::App& app, const Predicate& predicate) {
  const std::vector<std::string> arguments = app.remaining();
  const auto found = std::find_if(arguments.begin(), arguments.end(), predicate);
  return found == arguments.end() ? std::string{} : *found;
}

// What is wrong with arguments that nobody took, or nothing. A misspelt option is the cause also where what it was
// meant to be is missing, or its value was taken for another argument.
std::string left_over_text(const CLI::App& app, const CLI::App& command, bool only_options) {
  const auto is_option = [](const std::string& text) { return text.size() > 1 && text[0] == '-' && text != "--"; };
  const auto is_argument = [&](const std::string& text) { return text != "--" && !is_option(text); };
  for (const CLI::App* level : {&app, &command}) {
    if (const std::string option = first_left_over(*level, is_option); !option.empty()) {
      return unknown_option(*level, option);
    }
  }
  if (only_options) return {};
  if (const std::string name = first_left_over(app, is_argument); !name.empty()) return unknown_command(app, name);
  return fmt::format("unexpected argument '{}'", first_left_over(command, is_argument));
}

// The parser's message starts with the name of the option, that of a switch without its dashes.
std::string wrong_number_of_values(const CLI::App& command, const std::string& message) {
  const std::string name = message.substr(0, message.find_first_of(": "));
  const CLI::Option* option = command.get_option_no_throw(name);
  if (option == nullptr) return fmt::format("--{} takes no value", name);
  return fmt::format("{} {}", name, option->count() > 1 ? "is given more than once" : "needs a value");
}

std::string commands_line(const CLI::App& app) {
  return fmt::format("Commands: {}", fmt::join(command_names(app), ", "));
}

std::string usage_message(const CLI::App& app, const CLI::App& command, const CLI::Error& error) {
  const auto is = [&error](CLI::ExitCodes kind) { return error.get_exit_code() == static_cast<int>(kind); };
  if (is(CLI::ExitCodes::ArgumentMismatch)) return wrong_number_of_values(command, error.what());
  if (is(CLI::ExitCodes::ExtrasError)) return left_over_text(app, command, false);
  if (is(CLI::ExitCodes::RequiredError)) {
    if (const std::string text = left_over_text(app, command, true); !text.empty()) return text;
    if (&command == &app) return fmt::format("a command is required\n{}", commands_line(app));
  }
  return error.what();
}

// ------------------------------------------------------------------------------------------------ version

constexpr const char* licence_text = "Licence: Apache-2.0. Nothing that it links requires the GPL. Libraries:\n";
constexpr const char* licence_with_wrap_text =
    "Licence: Apache-2.0; GPL-3.0-or-later as a whole, because of the alpha wrap that is built in. Libraries:\n"
    "  CGAL Alpha_wrap_3 and what it uses of CGAL (GPL-3.0-or-later),\n";
constexpr const char* libraries_text =
    "  CGAL kernel (LGPL-3.0-or-later), GMP and MPFR (LGPL-3.0-or-later), Embree (Apache-2.0), oneTBB (Apache-2.0),\n"
    "  OpenVDB (MPL-2.0), Eigen (MPL-2.0), Boost (BSL-1.0), xsimd (BSD-3-Clause), {fmt} (MIT), CLI11 (BSD-3-Clause),\n"
    "  JSON for Modern C++ (MIT), xxHash (BSD-2-Clause), SQLite (public domain), zlib (Zlib), libpng (libpng-2.0),\n"
    "  meshoptimizer (MIT), stb (MIT); in the page of a report: three.js (MIT), Tabulator (MIT), Observable Plot and "
    "D3 (ISC)";

}  // namespace

void set_help(CLI::App& app, std::vector<std::string> usages, const std::string& footer) {
  app.formatter(std::make_shared<HelpFormatter>(std::move(usages)));
  app.footer(footer);
}

std::string exit_codes_help(std::span<const ExitCode> codes) {
  std::string text = "Exit codes:";
  for (const ExitCode code : codes) text += fmt::format("\n  {:<4} {}", static_cast<int>(code), meaning(code));
  return text;
}

std::string version_text() {
  return fmt::format("prcage {}\n{}{}", version(), has_alpha_wrap() ? licence_with_wrap_text : licence_text,
                     libraries_text);
}

std::string unknown_command(const CLI::App& app, const std::string& name) {
  return fmt::format("no such command '{}'{}\n{}", name, suggestion(name, command_names(app)), commands_line(app));
}

std::string usage_error(const CLI::App* app, const CLI::Error& error) {
  const auto commands = app->get_subcommands();
  const CLI::App& command = commands.empty() ? *app : *commands.front();
  return fmt::format("prcage: error: {}\nTry 'prcage{}{} --help'.\n", usage_message(*app, command, error),
                     commands.empty() ? "" : " ", commands.empty() ? "" : command.get_name());
}

}  // namespace prcage
