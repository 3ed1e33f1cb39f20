// prcage report: the page that shows the table of a batch.
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/output_file.h"
#include "tools/batch_table.h"
#include "tools/cli_commands.h"
#include "tools/cli_files.h"
#include "tools/page_model.h"
#include "tools/page_table.h"
#include "tools/page_template.h"

namespace prcage {
namespace {

namespace fs = std::filesystem;
using Json = PageTable::Json;

// A row's files. Paths of cages are relative to the table that names them.
PageModel model_of(const PageTable::Row& row, const fs::path& directory) {
  const std::string cage = row.cage_file.empty() ? std::string{} : (directory / row.cage_file).string();
  return page_model(row.input_file, cage);
}

// The model of each of these rows of the table, which are `places` on the page.
std::vector<std::string> add_models(Json& data, const PageTable& table, const fs::path& directory,
                                    const std::vector<std::size_t>& rows, const std::vector<std::size_t>& places) {
  std::vector<std::string> arrays;
  Json& models = data["models"] = Json::array();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const PageModel model = model_of(table.row(rows[i]), directory);
    Json described = {{"row", places[i]}, {"error", model.error}, {"diagonal", table.row(rows[i]).diagonal}};
    described.update(model.contents);
    models.push_back(described);
    arrays.push_back(base64(model.bytes));
  }
  return arrays;
}

// JSON that no text in it can end, or begin a comment in: a "<" is in strings only, and may be written as its code.
// Names of files need not be UTF-8: what is not is replaced.
std::string script_safe(const Json& data) {
  const std::string json = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  safe.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

WriteResult write_page(const std::string& path, const Json& data, const std::vector<std::string>& arrays) {
  const PageTemplate page = page_template();
  OutputFile file(path);
  file.write(page.head);
  file.write(fmt::format("<script type=\"application/json\" id=\"data\">{}</script>\n", script_safe(data)));
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    file.write(fmt::format("<script type=\"text/plain\" id=\"model-{}\">{}</script>\n", i, arrays[i]));
  }
  file.write(page.tail);
  return file.commit();
}

ExitCode report(const ReportCommand& command) {
  const PageTable table(BatchTable(command.table, BatchTable::Open::read_only));
  const std::vector<std::size_t> rows = table.worst(command.models);
  std::vector<std::size_t> places = rows;
  Json data = table.json(places);
  const fs::path path = fs::absolute(command.table).lexically_normal();
  data["table"] = path.filename().string();
  data["title"] = command.title.empty() ? path.filename().string() : command.title;
  data["version"] = version();
  const auto arrays = add_models(data, table, path.parent_path(), rows, places);
  const WriteResult written = write_page(command.output, data, arrays);
  if (written.ok) return ExitCode::ok;
  print_error(written.error);
  return ExitCode::cannot_write;
}

}  // namespace

ExitCode run(const ReportCommand& command) {
  if (page_template().empty()) {
    print_error(
        "this program was built without the page of the report: install npm and\n"
        "configure it again with -DPRCAGE_BUILD_REPORT_PAGE=ON");
    return ExitCode::usage;
  }
  if (!writable(command.output)) return ExitCode::cannot_write;
  try {
    return report(command);
  } catch (const BatchTableError& error) {
    print_error(error.what());
    return ExitCode::cannot_read;
  }
}

}  // namespace prcage
