// The table of a batch: one row for each mesh and settings, in an SQLite file.
//
// SQLite, because a row is then there as a whole or not at all, whatever kills the program or the machine, others can
// read while it grows, and it answers questions. Rows are committed one by one to a rollback journal, flushed to the
// disk: slower than a write-ahead log by milliseconds for each mesh, but it works on network file systems, and the
// table at rest is one file that can be copied.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

struct sqlite3;

namespace prcage {

// Where the value of a column comes from.
enum class BatchSource {
  batch,       // the program that runs the children
  statistics,  // prcage cage --stats
  cage,        // the same, if the run came as far as a cage
  evaluation,  // prcage eval --json
};

struct BatchColumn {
  const char* name;
  const char* type;  // of SQLite
  BatchSource source;
  const char* pointer;  // JSON pointer into what the source wrote; empty for the batch itself
  const char* meaning;  // a comment in the schema
};

std::span<const BatchColumn> batch_columns();

// NULL, whole number, number, text.
using BatchValue = std::variant<std::monostate, std::int64_t, double, std::string>;

// A row: a value for every column, NULL until it is set. The names must be those of columns.
class BatchRow {
 public:
  BatchRow();
  void set(std::string_view column, BatchValue value);
  const BatchValue& operator[](std::string_view column) const;
  std::string text(std::string_view column) const;  // empty if it is not a text

  const std::vector<BatchValue>& values() const { return values_; }

 private:
  friend class BatchTable;
  std::vector<BatchValue> values_;
};

// Does a row of this status have a cage?
bool has_cage(const std::string& status);

// A file that is not a table, or cannot be read or written. The message names it.
class BatchTableError : public std::runtime_error {
  using runtime_error::runtime_error;
};

class BatchTable {
 public:
  enum class Open { read_only, existing, or_create };

  BatchTable(const std::string& path, Open open);

  // Adds a row, in place of one of the same mesh and settings, in a transaction of its own or that of atomically().
  void put(const BatchRow& row);

  // All that `change` does to the table, or nothing of it.
  void atomically(const std::function<void()>& change);

  // Every row, ordered by mesh, then by settings.
  void for_each(const std::function<void(const BatchRow&)>& visit) const;

  std::optional<BatchRow> find(const std::string& mesh, const std::string& settings) const;
  std::set<std::string> settings() const;

 private:
  class Statement;
  static BatchRow row_of(const Statement& statement);
  void execute(const std::string& sql) const;
  void check_or_create(Open open);
  [[noreturn]] void fail(const std::string& what) const;

  std::string path_;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_;
};

}  // namespace prcage
