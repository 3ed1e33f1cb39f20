#include "tools/page_table.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>

#include <fmt/format.h>

namespace prcage {
namespace {

// The columns of the page; settings and tau_rel, which the page has in another form, are added to them.
constexpr std::array page_columns{"mesh",
                                  "status",
                                  "cause",
                                  "exit_code",
                                  "signal",
                                  "message",
                                  "defects",
                                  "evaluation_failure",
                                  "input_vertices",
                                  "input_faces",
                                  "cage_faces",
                                  "components",
                                  "euler_characteristic",
                                  "seconds",
                                  "process_seconds",
                                  "peak_memory_bytes",
                                  "certified",
                                  "paper_success",
                                  "hausdorff_rel",
                                  "hausdorff_cage_to_input_rel",
                                  "hausdorff_input_to_cage_rel",
                                  "normal_deviation_deg",
                                  "violation_max_rel",
                                  "violation_fraction",
                                  "volume_ratio",
                                  "area_ratio",
                                  "min_angle_deg"};

// Where the largest value is the worst.
constexpr std::array ranked_columns{"hausdorff_rel", "normal_deviation_deg", "violation_max_rel", "seconds",
                                    "cage_faces"};

constexpr std::size_t always_kept = 20;  // of each ranking

std::size_t page_column(std::string_view name) {
  return static_cast<std::size_t>(std::find(page_columns.begin(), page_columns.end(), name) - page_columns.begin());
}

double number_of(const BatchValue& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  if (const auto* number = std::get_if<double>(&value)) return *number;
  return 0;
}

// Six digits are more than a page shows, and half the size.
double rounded(double value) { return std::stod(fmt::format("{:.6g}", value)); }

PageTable::Json json_of(const BatchValue& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return *whole;
  if (const auto* number = std::get_if<double>(&value)) return rounded(*number);
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  return nullptr;
}

// Evenly chosen, at most `most` of them.
std::vector<std::size_t> thinned(const std::vector<std::size_t>& rows, std::size_t most) {
  if (rows.size() <= most) return rows;
  std::vector<std::size_t> chosen(most);
  for (std::size_t i = 0; i < most; ++i) chosen[i] = rows[i * rows.size() / most];
  return chosen;
}

}  // namespace

PageTable::PageTable(const BatchTable& table) {
  table.for_each([this](const BatchRow& row) { add(row); });
  std::size_t number = 0;
  for (auto& [settings, place] : settings_) place = number++;
}

void PageTable::add(const BatchRow& row) {
  Row& added = rows_.emplace_back();
  added.values.reserve(page_columns.size());
  for (const char* column : page_columns) added.values.push_back(row[column]);
  added.settings = row.text("settings");
  added.status = row.text("status");
  added.cause = row.text("cause");
  added.input_file = row.text("input_file");
  added.cage_file = row.text("cage_file");
  added.diagonal = number_of(row["diagonal"]);
  added.tau = number_of(row["tau"]);
  settings_.emplace(added.settings, 0);
  last_finished_ = std::max(last_finished_, row.text("finished"));
}

// Of each settings and each ranked column the rows whose value is above zero, the largest first; then the rows
// without a cage.
std::vector<std::vector<std::size_t>> PageTable::rankings() const {
  std::vector<std::vector<std::size_t>> all;
  for (const char* name : ranked_columns) {
    const auto value = [this, column = page_column(name)](std::size_t i) { return number_of(rows_[i].values[column]); };
    const std::size_t first = all.size();
    all.resize(first + settings_.size());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (has_cage(rows_[i].status) && value(i) > 0) all[first + settings_.at(rows_[i].settings)].push_back(i);
    }
    for (std::size_t s = first; s < all.size(); ++s) {
      std::stable_sort(all[s].begin(), all[s].end(), [&](std::size_t a, std::size_t b) { return value(a) > value(b); });
    }
  }
  std::vector<std::size_t>& failures = all.emplace_back();
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (!has_cage(rows_[i].status)) failures.push_back(i);
  }
  return all;
}

std::vector<std::size_t> PageTable::worst(std::size_t count) const {
  count = std::min(count, rows_.size());
  auto lists = rankings();
  lists.emplace_back(rows_.size());
  std::iota(lists.back().begin(), lists.back().end(), std::size_t{0});
  std::vector<std::size_t> order;
  std::vector<bool> taken(rows_.size(), false);
  std::vector<std::size_t> next(lists.size(), 0);
  const auto take_next = [&](std::size_t list) {
    while (next[list] < lists[list].size() && taken[lists[list][next[list]]]) ++next[list];
    if (next[list] == lists[list].size()) return false;
    order.push_back(lists[list][next[list]]);
    taken[order.back()] = true;
    return true;
  };
  const std::size_t rest = lists.size() - 1;
  for (bool found = true; found && order.size() < count;) {
    found = false;
    for (std::size_t list = 0; list < rest && order.size() < count; ++list) found |= take_next(list);
  }
  while (order.size() < count) take_next(rest);
  return order;
}

std::vector<std::size_t> PageTable::choose(const std::vector<std::size_t>& wanted, std::size_t max_rows) const {
  std::vector<std::size_t> with_cage;
  std::vector<std::size_t> without;
  for (std::size_t i = 0; i < rows_.size(); ++i) (has_cage(rows_[i].status) ? with_cage : without).push_back(i);
  std::set<std::size_t> chosen(wanted.begin(), wanted.end());
  const auto failures = thinned(without, max_rows / 2);
  const auto cages = thinned(with_cage, max_rows - failures.size());
  chosen.insert(failures.begin(), failures.end());
  chosen.insert(cages.begin(), cages.end());
  for (const auto& ranking : rankings()) {
    chosen.insert(ranking.begin(),
                  ranking.begin() + static_cast<std::ptrdiff_t>(std::min(always_kept, ranking.size())));
  }
  return {chosen.begin(), chosen.end()};
}

PageTable::Json PageTable::counts_json() const {
  std::map<std::tuple<std::size_t, std::string, std::string>, std::size_t> counts;
  for (const Row& row : rows_) ++counts[{settings_.at(row.settings), row.status, row.cause}];
  Json json = Json::array();
  for (const auto& [key, count] : counts) {
    const auto& [settings, status, cause] = key;
    json.push_back({{"settings", settings},
                    {"status", status},
                    {"cause", cause},
                    {"has_cage", has_cage(status)},
                    {"count", count}});
  }
  return json;
}

// Column by column: a row of its own for each would repeat every name.
PageTable::Json PageTable::columns_json(const std::vector<std::size_t>& chosen) const {
  Json json;
  for (std::size_t column = 0; column < page_columns.size(); ++column) {
    Json& values = json[page_columns[column]] = Json::array();
    for (const std::size_t i : chosen) values.push_back(json_of(rows_[i].values[column]));
  }
  Json& settings = json["settings"] = Json::array();
  Json& tau = json["tau_rel"] = Json::array();
  Json& has = json["has_cage"] = Json::array();
  for (const std::size_t i : chosen) {
    const Row& row = rows_[i];
    settings.push_back(settings_.at(row.settings));
    tau.push_back(row.diagonal > 0 && row.tau > 0 ? Json(rounded(row.tau / row.diagonal)) : Json());
    has.push_back(has_cage(row.status) ? 1 : 0);
  }
  return json;
}

PageTable::Json PageTable::json(std::vector<std::size_t>& wanted, std::size_t max_rows) const {
  const std::vector<std::size_t> chosen = choose(wanted, max_rows);
  for (std::size_t& i : wanted) {
    i = static_cast<std::size_t>(std::lower_bound(chosen.begin(), chosen.end(), i) - chosen.begin());
  }
  Json settings = Json::array();
  for (const auto& [text, number] : settings_) settings.push_back(text);
  return {{"last_finished", last_finished_},
          {"total_rows", rows_.size()},
          {"settings", settings},
          {"counts", counts_json()},
          {"columns", columns_json(chosen)}};
}

}  // namespace prcage
