// What the page of `prcage report` says of a table: its rows, thinned where there are too many of them for a page, the
// numbers of all of them, and which are worth a look.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/batch_table.h"

namespace prcage {

class PageTable {
 public:
  using Json = nlohmann::ordered_json;

  // A row of the table as far as the page shows it.
  struct Row {
    std::vector<BatchValue> values;  // of the columns of the page
    std::string settings;
    std::string status;
    std::string cause;
    std::string input_file;
    std::string cage_file;  // empty: none
    double diagonal = 0;    // of the input's box; 0: not known
    double tau = 0;         // in the input's unit; 0: not known
  };

  explicit PageTable(const BatchTable& table);

  const Row& row(std::size_t i) const { return rows_[i]; }
  std::size_t size() const { return rows_.size(); }

  // At most `count` rows, the worst first: by turns the next of each ranking and the next failure, then the others in
  // the order of the table.
  std::vector<std::size_t> worst(std::size_t count) const;

  // Rows, counts and settings for the page. Of more than max_rows those of `wanted`, the worst of each ranking and an
  // even choice of the others are there; `wanted` becomes their places among the rows of the page.
  Json json(std::vector<std::size_t>& wanted, std::size_t max_rows = 20000) const;

 private:
  void add(const BatchRow& row);
  std::vector<std::vector<std::size_t>> rankings() const;
  std::vector<std::size_t> choose(const std::vector<std::size_t>& wanted, std::size_t max_rows) const;
  Json counts_json() const;
  Json columns_json(const std::vector<std::size_t>& chosen) const;

  std::vector<Row> rows_;
  std::map<std::string, std::size_t> settings_;  // and their numbers, in their own order
  std::string last_finished_;
};

}  // namespace prcage
