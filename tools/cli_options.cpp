#include "tools/cli_options.h"

#include <initializer_list>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "tools/cli_command_options.h"
#include "tools/cli_help.h"

namespace prcage {
namespace {

constexpr const char* example_help =
    "COMMAND is required; 'prcage COMMAND --help' describes it.\n\n"
    "Example:\n"
    "  prcage make knot --faces 20000 -o knot.ply\n"
    "  prcage cage knot.ply -o knot-cage.ply\n"
    "  prcage check knot.ply --cage knot-cage.ply\n\n";

// `codes`: those that the command can return beside those of every command.
CLI::App& add_command(CLI::App& app, const std::string& name, const std::string& what, std::vector<std::string> usages,
                      std::initializer_list<ExitCode> codes) {
  std::vector<ExitCode> all{ExitCode::ok, ExitCode::internal_error, ExitCode::usage};
  all.insert(all.end(), codes);
  CLI::App* command = app.add_subcommand(name, what)->group("Commands");
  set_help(*command, std::move(usages), exit_codes_help(all));
  return *command;
}

void add_commands(CLI::App& app, std::optional<Command>& chosen) {
  using enum ExitCode;
  add_cage(
      add_command(
          app, "cage", "Make a certified cage of few faces around a dense mesh", {"INPUT -o OUTPUT [OPTIONS]"},
          {cannot_read, invalid_mesh, face_budget_not_reached, no_cage, cannot_write, deadline_reached, interrupted}),
      chosen);
  add_check(add_command(app, "check", "Validate a mesh, or certify a cage against a mesh",
                        {"INPUT [OPTIONS]", "INPUT --cage FILE [OPTIONS]"},
                        {cannot_read, invalid_mesh, no_cage, cannot_write}),
            chosen);
  add_eval(add_command(app, "eval", "Measure a cage: distances, normals, thickness, sizes, angles",
                       {"INPUT CAGE [OPTIONS]"}, {cannot_read, invalid_mesh, no_cage, cannot_write}),
           chosen);
  add_info(add_command(app, "info", "Describe a mesh file", {"FILE [OPTIONS]"}, {cannot_read, cannot_write}), chosen);
  add_make(add_command(app, "make", "Write a built-in shape", {"SHAPE --faces N -o OUTPUT [OPTIONS]", "--list"},
                       {cannot_write}),
           chosen);
  add_render(add_command(app, "render", "Draw a mesh, and its cage, as a PNG picture",
                         {"INPUT [CAGE] -o OUTPUT [OPTIONS]"}, {cannot_read, invalid_mesh, cannot_write}),
             chosen);
  add_bind(add_command(app, "bind", "Bind a mesh to a cage by mean value coordinates",
                       {"INPUT CAGE -o WEIGHTS [OPTIONS]"}, {cannot_read, invalid_mesh, cannot_write}),
           chosen);
  add_pose(add_command(app, "pose", "Bend or twist a cage",
                       {"CAGE --bend DEGREES -o OUTPUT [OPTIONS]", "CAGE --twist DEGREES -o OUTPUT [OPTIONS]"},
                       {cannot_read, cannot_write}),
           chosen);
  add_deform(add_command(app, "deform", "Deform a mesh by its deformed cage",
                         {"WEIGHTS DEFORMED_CAGE -o OUTPUT [OPTIONS]", "INPUT CAGE DEFORMED_CAGE -o OUTPUT [OPTIONS]"},
                         {cannot_read, invalid_mesh, cannot_write}),
             chosen);
  add_batch(add_command(app, "batch", "Make the cages of a whole directory, each in a process of its own",
                        {"INPUT -o DIR [OPTIONS]"},
                        {cannot_read, face_budget_not_reached, cannot_write, some_failed, interrupted}),
            chosen);
  add_merge(add_command(app, "merge", "Unite the tables of the shards of a batch", {"TABLES... -o TABLE [OPTIONS]"},
                        {cannot_read, cannot_write}),
            chosen);
  add_report(add_command(app, "report", "Make a page to look at from the table of a batch",
                         {"TABLE -o OUTPUT [OPTIONS]"}, {cannot_read, cannot_write}),
             chosen);
  add_simplify(add_command(app, "simplify", "Simplify a mesh within a tolerance on each side of it",
                           {"INPUT -o OUTPUT [OPTIONS]"},
                           {cannot_read, invalid_mesh, face_budget_not_reached, no_cage, cannot_write, interrupted}),
               chosen);
  add_low_poly(add_command(app, "lowpoly", "Make a mesh of very few faces that keeps the outlines",
                           {"INPUT -o OUTPUT --faces N [OPTIONS]"},
                           {cannot_read, invalid_mesh, face_budget_not_reached, no_cage, cannot_write, interrupted}),
               chosen);
}

// "help" asked for by name; the option --help is the parser's.
void print_help(const CLI::App& app, const std::string& topic) {
  if (topic.empty()) throw CLI::CallForHelp();
  const auto commands = app.get_subcommands([&](const CLI::App* command) { return command->get_name() == topic; });
  if (commands.empty()) throw CLI::ValidationError(unknown_command(app, topic));
  std::cout << commands.front()->help("prcage");
}

}  // namespace

CommandLine parse_command_line(int argc, const char* const* argv) {
  CLI::App app("Certified tight bounding cages of triangle meshes", "prcage");
  std::optional<Command> chosen;
  add_commands(app, chosen);
  std::string help_topic;
  add_command(app, "help", "Describe a command", {"[COMMAND]"}, {})
      .add_option("COMMAND", help_topic, "Name of the command")
      ->type_name("");
  app.require_subcommand(0, 1);  // none is refused below: the parser would complain of it before a misspelt one
  set_help(app, {"COMMAND [ARGUMENTS] [OPTIONS]"}, example_help + exit_codes_help(all_exit_codes));
  app.set_version_flag("--version", &version_text, "Print the version and the licences, and exit");
  app.failure_message(&usage_error);
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) throw CLI::RequiredError("A command");
    if (app.got_subcommand("help")) print_help(app, help_topic);
  } catch (const CLI::ParseError& error) {
    return {std::nullopt, app.exit(error) == 0 ? ExitCode::ok : ExitCode::usage};
  }
  return {chosen, ExitCode::ok};
}

}  // namespace prcage
