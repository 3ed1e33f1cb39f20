// Options that several commands have: one wording and one meaning, wherever they are given.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/prcage.h"
#include "io/mesh_file.h"
#include "tools/cli_option_kinds.h"
#include "tools/cli_options.h"

namespace prcage {

AddedOption add_format(CLI::App& app, std::optional<MeshFormat>& format);
AddedOption add_threads(CLI::App& app, int& threads);
AddedOption add_weld(CLI::App& app, bool& weld);
AddedOption add_edge_flips(CLI::App& app, bool& flips);

// The mesh that is made of another one, or out of nothing.
AddedOption add_mesh_output(CLI::App& app, std::string& path, const std::string& what = "Mesh");

// What all commands have that make a mesh of another one; `made` is what that is.
void add_mesh_files(CLI::App& app, MeshCommand& command, const std::string& made);

template <class AnyCommand>
void add_input_settings(CLI::App& app, AnyCommand& command) {
  add_count(app, "--seed", command.options.seed, {},
            "Breaks ties between edges of equal cost [0];\nthe same seed gives the same result");
  add_flag(app, "--flip", command.options.accept_inside_out,
           "Accept an inside-out input, whose faces look inward: turn it\nround instead of refusing it");
  add_weld(app, command.weld);
}

void add_run_settings(CLI::App& app, MeshCommand& command, int& threads, std::optional<MeshFormat>& format);

// What decides on a cage, however many of them are made. Gives the option --faces.
AddedOption add_cage_settings(CLI::App& app, CageCommand& command);

// To be called at the end of a command that makes cages: without a thickness or a schedule of it, a number of faces
// asks for the smallest thickness that reaches it.
void find_thickness_if_free(const CLI::App& app, Options& options, bool levels = false);

std::vector<double> parse_schedule(const std::string& text);
TauMode parse_tau_mode(const std::string& text);
Quality parse_quality(const std::string& text);

// The format that the extension of `path`, given for `option`, stands for. `remedy` ends the error if it is none.
MeshFormat format_of_extension(const std::string& option, const std::string& path, const std::string& remedy);

// The format to write `path` in: as asked for, or as its extension says.
MeshFormat output_format(const std::string& path, const std::optional<MeshFormat>& asked);

// Refuses standard input as both; `option` is how the second one is given.
void refuse_stdin_twice(const std::string& input, const std::string& cage, const std::string& option);

// Refuses standard output as both; `made` is what the command makes.
void refuse_stdout_twice(const MeshCommand& command, const std::string& made);

}  // namespace prcage
