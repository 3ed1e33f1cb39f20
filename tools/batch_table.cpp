#include "tools/batch_table.h"

#include <algorithm>
#include <array>
#include <cassert>

#include <fmt/format.h>
#include <sqlite3.h>

namespace prcage {
namespace {

constexpr int application = 0x70726367;  // "prcg" at the head of the file
constexpr int schema = 1;                // rises when a column is renamed or removed, or its meaning changes

constexpr auto batch = BatchSource::batch;
constexpr auto statistics = BatchSource::statistics;
constexpr auto cage = BatchSource::cage;
constexpr auto evaluation = BatchSource::evaluation;

// The one place where columns are named and the keys of the statistics are mapped to them.
constexpr std::array columns{
    BatchColumn{"mesh", "TEXT NOT NULL", batch, "", "path of the input below the batch's directory, or as listed"},
    BatchColumn{"settings", "TEXT NOT NULL", batch, "", "options that the row depends on, defaults written out"},
    BatchColumn{"status", "TEXT NOT NULL", batch, "", "as in the statistics, or timeout, out_of_memory, crashed"},
    BatchColumn{"cause", "TEXT", batch, "", "of a failure: exit code, signal, timeout, memory; NULL: there is a cage"},
    BatchColumn{"exit_code", "INTEGER", batch, "", "of the process; NULL: ended by a signal"},
    BatchColumn{"signal", "INTEGER", batch, "", "that ended the process"},
    BatchColumn{"message", "TEXT", batch, "", "what the process said, one line"},
    BatchColumn{"defects", "TEXT", batch, "", "of an invalid input: kind and number of each"},
    BatchColumn{"input_file", "TEXT", batch, "", "absolute path"},
    BatchColumn{"cage_file", "TEXT", batch, "", "relative to the directory of this table"},
    BatchColumn{"input_bytes", "INTEGER", batch, "", "size of the input file"},
    BatchColumn{"timeout_seconds", "REAL", batch, "", "limit for each process; 0: none"},
    BatchColumn{"memory_limit_mb", "INTEGER", batch, "", "limit of the address space of each process; 0: none"},
    BatchColumn{"process_seconds", "REAL", batch, "", "wall time of the process that made the cage"},
    BatchColumn{"peak_memory_bytes", "INTEGER", batch, "", "of the process that made the cage: resident, from outside"},
    BatchColumn{"finished", "TEXT", batch, "", "when, UTC"},
    BatchColumn{"tool_version", "TEXT", statistics, "/tool/version", "of prcage"},
    BatchColumn{"content_hash", "TEXT", statistics, "/input/content_hash", "of the input's positions and faces"},
    BatchColumn{"input_vertices", "INTEGER", statistics, "/input/vertices", "as read"},
    BatchColumn{"input_faces", "INTEGER", statistics, "/input/faces", "as read"},
    BatchColumn{"cage_vertices", "INTEGER", cage, "/statistics/cage_vertices", ""},
    BatchColumn{"cage_faces", "INTEGER", cage, "/statistics/cage_faces", ""},
    BatchColumn{"components", "INTEGER", statistics, "/validation/components", "of the input"},
    BatchColumn{"euler_characteristic", "INTEGER", statistics, "/validation/euler_characteristic", "of the input"},
    BatchColumn{"diagonal", "REAL", statistics, "/validation/diagonal", "of the input's box, in its unit"},
    BatchColumn{"tau", "REAL", statistics, "/statistics/tau", "in the input's unit"},
    BatchColumn{"threads", "INTEGER", statistics, "/statistics/threads", ""},
    BatchColumn{"simd", "TEXT", statistics, "/statistics/simd", "instruction set of the kernels"},
    BatchColumn{"seconds", "REAL", statistics, "/seconds/total", "wall time by stage, from here on"},
    BatchColumn{"seconds_read", "REAL", statistics, "/seconds/read", ""},
    BatchColumn{"seconds_validate", "REAL", statistics, "/statistics/seconds/validate", ""},
    BatchColumn{"seconds_displace", "REAL", statistics, "/statistics/seconds/displace", ""},
    BatchColumn{"seconds_evaluate", "REAL", statistics, "/statistics/seconds/evaluate", ""},
    BatchColumn{"seconds_select", "REAL", statistics, "/statistics/seconds/select", ""},
    BatchColumn{"seconds_build", "REAL", statistics, "/statistics/seconds/build", ""},
    BatchColumn{"seconds_distance", "REAL", statistics, "/statistics/seconds/distance", ""},
    BatchColumn{"seconds_collide", "REAL", statistics, "/statistics/seconds/collide", ""},
    BatchColumn{"seconds_commit", "REAL", statistics, "/statistics/seconds/commit", ""},
    BatchColumn{"seconds_flip", "REAL", statistics, "/statistics/seconds/flip", ""},
    BatchColumn{"seconds_tighten", "REAL", statistics, "/statistics/seconds/tighten", ""},
    BatchColumn{"seconds_certify", "REAL", statistics, "/statistics/seconds/certify", ""},
    BatchColumn{"seconds_write", "REAL", statistics, "/seconds/write", ""},
    BatchColumn{"certified", "INTEGER", cage, "/certificate/valid", "all of the certificate, 0 or 1; then each"},
    BatchColumn{"closed", "INTEGER", cage, "/certificate/closed", ""},
    BatchColumn{"manifold", "INTEGER", cage, "/certificate/manifold", ""},
    BatchColumn{"oriented", "INTEGER", cage, "/certificate/oriented", ""},
    BatchColumn{"no_degenerate_face", "INTEGER", cage, "/certificate/no_degenerate_face", ""},
    BatchColumn{"self_intersection_free", "INTEGER", cage, "/certificate/self_intersection_free", ""},
    BatchColumn{"no_contact", "INTEGER", cage, "/certificate/no_contact", ""},
    BatchColumn{"encloses", "INTEGER", cage, "/certificate/encloses", ""},
    BatchColumn{"euler_characteristic_equal", "INTEGER", cage, "/certificate/euler_characteristic_equal", ""},
    BatchColumn{"component_count_equal", "INTEGER", cage, "/certificate/component_count_equal", ""},
    BatchColumn{"evaluation_failure", "TEXT", batch, "", "why a cage has none of the following"},
    BatchColumn{"paper_success", "INTEGER", evaluation, "/conditions/success", "the paper's four conditions, 0 or 1"},
    BatchColumn{"hausdorff_rel", "REAL", evaluation, "/measures/hausdorff",
                "the larger of the two; distances are relative to the diagonal"},
    BatchColumn{"hausdorff_cage_to_input_rel", "REAL", evaluation, "/measures/cage_to_input/hausdorff", ""},
    BatchColumn{"hausdorff_input_to_cage_rel", "REAL", evaluation, "/measures/input_to_cage/hausdorff", ""},
    BatchColumn{"mean_distance_cage_to_input_rel", "REAL", evaluation, "/measures/cage_to_input/mean_distance", ""},
    BatchColumn{"mean_distance_input_to_cage_rel", "REAL", evaluation, "/measures/input_to_cage/mean_distance", ""},
    BatchColumn{"normal_deviation_deg", "REAL", evaluation, "/measures/cage_to_input/normal_deviation",
                "mean over the cage"},
    BatchColumn{"normal_deviation_input_to_cage_deg", "REAL", evaluation, "/measures/input_to_cage/normal_deviation",
                "mean over the input"},
    BatchColumn{"violation_max_rel", "REAL", evaluation, "/measures/violation/max",
                "by how much the cage is beyond tau, eq. 8"},
    BatchColumn{"violation_mean_rel", "REAL", evaluation, "/measures/violation/mean", ""},
    BatchColumn{"violation_fraction", "REAL", evaluation, "/measures/violation/fraction", "of the cage's area"},
    BatchColumn{"volume_ratio", "REAL", evaluation, "/measures/volume_ratio", "cage to input"},
    BatchColumn{"area_ratio", "REAL", evaluation, "/measures/area_ratio", "cage to input"},
    BatchColumn{"min_angle_deg", "REAL", evaluation, "/measures/smallest_angle/min", "of the faces of the cage"},
    BatchColumn{"min_angle_p05_deg", "REAL", evaluation, "/measures/smallest_angle/fifth_percentile", ""},
    BatchColumn{"min_angle_mean_deg", "REAL", evaluation, "/measures/smallest_angle/mean", ""},
    BatchColumn{"seconds_measure", "REAL", evaluation, "/seconds/measure", "of the evaluation"},
};

std::size_t index_of(std::string_view name) {
  const auto found = std::find_if(columns.begin(), columns.end(), [name](const auto& c) { return c.name == name; });
  assert(found != columns.end());
  return static_cast<std::size_t>(found - columns.begin());
}

std::string create_table() {
  std::string sql = "CREATE TABLE results (\n";
  for (const BatchColumn& column : columns) {
    const std::string comment = column.meaning[0] == '\0' ? "" : fmt::format("  -- {}", column.meaning);
    sql += fmt::format("  {} {},{}\n", column.name, column.type, comment);
  }
  // No hidden number of the row: the order of the rows is that of their keys, not that of their arrival.
  return sql + "  PRIMARY KEY (mesh, settings)\n) WITHOUT ROWID";
}

int open_flags(BatchTable::Open open) {
  switch (open) {
    case BatchTable::Open::read_only:
      return SQLITE_OPEN_READONLY;
    case BatchTable::Open::existing:
      return SQLITE_OPEN_READWRITE;
    case BatchTable::Open::or_create:
      break;
  }
  return SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
}

std::string column_names() {
  std::vector<const char*> names;
  names.reserve(columns.size());
  for (const BatchColumn& column : columns) names.push_back(column.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::span<const BatchColumn> batch_columns() { return columns; }

bool has_cage(const std::string& status) { return status == "ok" || status == "face_budget_not_reached"; }

// ---------------------------------------------------------------------------------------------------- rows

BatchRow::BatchRow() : values_(columns.size()) {}

void BatchRow::set(std::string_view column, BatchValue value) { values_[index_of(column)] = std::move(value); }

const BatchValue& BatchRow::operator[](std::string_view column) const { return values_[index_of(column)]; }

std::string BatchRow::text(std::string_view column) const {
  const auto* text = std::get_if<std::string>(&(*this)[column]);
  return text == nullptr ? std::string{} : *text;
}

// ---------------------------------------------------------------------------------------------- statements

class BatchTable::Statement {
 public:
  Statement(const BatchTable& table, const std::string& sql) : table_(table) {
    check(sqlite3_prepare_v2(table.database_.get(), sql.c_str(), -1, &statement_, nullptr));
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  // Parameters count from 1, columns from 0.
  void bind(int parameter, const BatchValue& value) {
    if (const auto* whole = std::get_if<std::int64_t>(&value)) {
      check(sqlite3_bind_int64(statement_, parameter, *whole));
    } else if (const auto* number = std::get_if<double>(&value)) {
      check(sqlite3_bind_double(statement_, parameter, *number));
    } else if (const auto* text = std::get_if<std::string>(&value)) {
      check(sqlite3_bind_text64(statement_, parameter, text->data(), text->size(), SQLITE_TRANSIENT, SQLITE_UTF8));
    }
  }

  // False if there is no further row.
  bool step() {
    const int result = sqlite3_step(statement_);
    if (result != SQLITE_ROW && result != SQLITE_DONE) table_.fail(sqlite3_errmsg(table_.database_.get()));
    return result == SQLITE_ROW;
  }

  BatchValue value(int column) const {
    switch (sqlite3_column_type(statement_, column)) {
      case SQLITE_INTEGER:
        return std::int64_t{sqlite3_column_int64(statement_, column)};
      case SQLITE_FLOAT:
        return sqlite3_column_double(statement_, column);
      case SQLITE_TEXT:
        return text(column);
      default:
        return {};
    }
  }

  std::string text(int column) const {
    const auto* bytes = static_cast<const char*>(sqlite3_column_blob(statement_, column));
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
    return size == 0 ? std::string{} : std::string(bytes, size);
  }

 private:
  void check(int result) const {
    if (result != SQLITE_OK) table_.fail(sqlite3_errmsg(table_.database_.get()));
  }

  const BatchTable& table_;
  sqlite3_stmt* statement_ = nullptr;
};

// --------------------------------------------------------------------------------------------------- table

BatchTable::BatchTable(const std::string& path, Open open) : path_(path), database_(nullptr, &sqlite3_close) {
  sqlite3* database = nullptr;
  const int result = sqlite3_open_v2(path.c_str(), &database, open_flags(open), nullptr);
  database_.reset(database);  // there also after most errors, which it then describes
  if (database == nullptr) fail("not enough memory");
  if (result != SQLITE_OK) fail(sqlite3_errmsg(database));
  constexpr int patience_ms = 60000;  // with readers
  sqlite3_busy_timeout(database, patience_ms);
  execute("PRAGMA synchronous = EXTRA");
  check_or_create(open);
}

void BatchTable::check_or_create(Open open) {
  const auto number = [this](const char* pragma) {
    Statement statement(*this, fmt::format("PRAGMA {}", pragma));
    statement.step();
    return std::get<std::int64_t>(statement.value(0));
  };
  if (open == Open::or_create && number("schema_version") == 0) {  // an empty file
    atomically([this] {
      execute(create_table());
      execute(fmt::format("PRAGMA application_id = {}", application));
      execute(fmt::format("PRAGMA user_version = {}", schema));
    });
  }
  if (number("application_id") != application) fail("is not a table of prcage batch");
  if (number("user_version") != schema) fail("was made by another version of prcage, with other columns");
}

void BatchTable::put(const BatchRow& row) {
  const std::string marks = fmt::format("{}", fmt::join(std::vector<const char*>(columns.size(), "?"), ", "));
  Statement statement(*this, fmt::format("INSERT OR REPLACE INTO results ({}) VALUES ({})", column_names(), marks));
  int parameter = 0;
  for (const BatchValue& value : row.values()) statement.bind(++parameter, value);
  statement.step();
}

void BatchTable::atomically(const std::function<void()>& change) {
  execute("BEGIN IMMEDIATE");
  try {
    change();
    execute("COMMIT");
  } catch (...) {
    sqlite3_exec(database_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
    throw;
  }
}

BatchRow BatchTable::row_of(const Statement& statement) {
  BatchRow row;
  for (std::size_t i = 0; i < columns.size(); ++i) row.values_[i] = statement.value(static_cast<int>(i));
  return row;
}

void BatchTable::for_each(const std::function<void(const BatchRow&)>& visit) const {
  Statement statement(*this, fmt::format("SELECT {} FROM results ORDER BY mesh, settings", column_names()));
  while (statement.step()) visit(row_of(statement));
}

std::optional<BatchRow> BatchTable::find(const std::string& mesh, const std::string& settings) const {
  Statement statement(*this, fmt::format("SELECT {} FROM results WHERE mesh = ? AND settings = ?", column_names()));
  statement.bind(1, mesh);
  statement.bind(2, settings);
  if (!statement.step()) return std::nullopt;
  return row_of(statement);
}

std::set<std::string> BatchTable::settings() const {
  std::set<std::string> all;
  Statement statement(*this, "SELECT DISTINCT settings FROM results");
  while (statement.step()) all.insert(statement.text(0));
  return all;
}

void BatchTable::execute(const std::string& sql) const {
  if (sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) {
    fail(sqlite3_errmsg(database_.get()));
  }
}

void BatchTable::fail(const std::string& what) const {
  if (sqlite3_extended_errcode(database_.get()) == SQLITE_READONLY_ROLLBACK) {
    throw BatchTableError(
        fmt::format("{}: was left by a batch that was killed while it wrote; resuming the batch puts it right", path_));
  }
  throw BatchTableError(fmt::format("{}: {}", path_, what));
}

}  // namespace prcage
