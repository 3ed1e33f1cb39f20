#include "tools/batch_job.h"

#include <algorithm>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "core/schedule.h"

namespace prcage {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Null if it is not JSON.
Json json_file(const fs::path& path) {
  Json json = Json::parse(contents(path), nullptr, false);
  return json.is_discarded() ? Json() : json;
}

BatchValue value_of(const Json& json) {
  if (json.is_boolean()) return std::int64_t{json.get<bool>()};
  if (json.is_number_integer()) return json.get<std::int64_t>();
  if (json.is_number()) return json.get<double>();
  if (json.is_string()) return json.get<std::string>();
  return {};
}

void set_from_json(BatchRow& row, BatchSource source, const Json& json) {
  for (const BatchColumn& column : batch_columns()) {
    if (column.source != source) continue;
    const Json::json_pointer pointer(column.pointer);
    if (json.contains(pointer)) row.set(column.name, value_of(json[pointer]));
  }
}

std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of('\n');
  if (end == std::string::npos) return {};
  const std::size_t start = text.find_last_of('\n', end);
  return text.substr(start == std::string::npos ? 0 : start + 1, end - (start == std::string::npos ? 0 : start));
}

// Memory runs out in many places: in our code, in a thread or a destructor where nobody can catch it, in the loader
// before the program begins. The system refuses threads for other reasons, too, unless memory is what is limited.
bool ran_out_of_memory(const std::string& errors, bool limited) {
  const auto said = [&errors](const char* text) { return errors.find(text) != std::string::npos; };
  return said(out_of_memory_text) || said("std::bad_alloc") || said("Cannot allocate memory") ||
         said("failed to map segment") || (limited && said("Resource temporarily unavailable"));
}

struct Verdict {
  std::string status;
  std::string cause;  // empty: there is a cage
  std::string message;
};

Verdict judge(const BatchPlan& plan, const ChildEnd& end, const Json& statistics, const std::string& errors) {
  if (end.timed_out) return {"timeout", "timeout", fmt::format("stopped after {} s", plan.timeout_seconds)};
  if (end.signal != 0 || end.exit_code != static_cast<int>(ExitCode::ok)) {
    if (ran_out_of_memory(errors, plan.memory_limit_mb > 0)) return {"out_of_memory", "memory", last_line(errors)};
  }
  if (end.signal != 0) {
    const std::string said =
        end.signal == SIGKILL ? "killed from outside, often for lack of memory" : last_line(errors);
    return {"crashed", "signal", fmt::format("{}{}{}", strsignal(end.signal), said.empty() ? "" : ": ", said)};
  }
  if (!statistics.contains("status")) return {"crashed", "exit code", last_line(errors)};
  Verdict verdict{statistics["status"], "", statistics["message"]};
  if (!has_cage(verdict.status)) verdict.cause = "exit code";
  return verdict;
}

// "boundary_edge 3, inside_out 1"
std::string defects_text(const Json& statistics) {
  std::vector<std::string> defects;
  for (const Json& defect : statistics.value(Json::json_pointer("/validation/defects"), Json::array())) {
    defects.push_back(fmt::format("{} {}", defect["kind"].get<std::string>(), defect["count"].get<std::size_t>()));
  }
  return fmt::format("{}", fmt::join(defects, ", "));
}

// One that fails its certificate is not kept, but of interest.
bool reached_a_cage(const std::string& status) {
  return has_cage(status) || status == to_string(Status::certificate_failed);
}

std::vector<std::string> tau_arguments(const Options& options) {
  if (options.tau_absolute > 0) return {"--tau-abs", fmt::format("{}", options.tau_absolute)};
  if (finds_thickness(options)) return {};
  return {"--tau", fmt::format("{}", options.tau)};
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[sizeof("2000-01-01T00:00:00Z")];
  std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

// So that a row which says that there is a cage is not on the disk before the cage.
void synchronize_directory(const fs::path& directory) {
  const int descriptor = open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

void move_durably(const fs::path& from, const fs::path& to) {
  fs::create_directories(to.parent_path());
  fs::rename(from, to);
  synchronize_directory(to.parent_path());
}

}  // namespace

std::vector<std::string> cage_arguments(const CageCommand& command) {
  const Options& options = command.options;
  std::vector<std::string> words = tau_arguments(options);
  const auto add = [&words](const char* name, const auto& value) {
    words.emplace_back(name);
    words.push_back(fmt::format("{}", value));
  };
  if (!words.empty() && options.schedule.empty()) {
    add("--cycles", options.cycles);
  } else if (!words.empty()) {
    add("--schedule", fmt::format("{}", fmt::join(options.schedule, ",")));
  }
  add("--tau-mode", options.tau_mode == TauMode::strict ? "strict" : "paper");
  add("--faces", options.face_budget);
  add("--bound", options.bound == Bound::both ? "both" : "cage");
  add("--quality", to_string(options.quality));
  add("--sigma", options.sigma);
  add("--seed", options.seed);
  add("--format", to_string(command.format));
  if (!options.flips) words.emplace_back("--no-edge-flips");
  if (options.accept_inside_out) words.emplace_back("--flip");
  if (command.weld) words.emplace_back("--weld");
  return words;
}

CoreShare share_cores(int cores, std::size_t meshes, int jobs, int threads) {
  const int most = static_cast<int>(std::clamp<std::size_t>(meshes, 1, static_cast<std::size_t>(cores)));
  if (jobs == 0) jobs = threads == 0 ? most : std::min(most, std::max(1, cores / threads));
  if (threads == 0) threads = std::max(1, cores / jobs);
  return {static_cast<std::size_t>(jobs), threads};
}

BatchJob::BatchJob(const BatchPlan& plan, BatchInput input, fs::path scratch)
    : plan_(plan), input_(std::move(input)), scratch_(std::move(scratch)) {
  fs::create_directories(scratch_);
  child_ = std::make_unique<ChildProcess>(cage_child());
}

BatchJob::~BatchJob() {
  child_.reset();  // before it loses the ground that it stands on
  std::error_code error;
  fs::remove_all(scratch_, error);
}

// With its streams in files of this name.
ChildCommand BatchJob::child(const char* name, std::vector<std::string> arguments) const {
  ChildCommand child;
  child.arguments = std::move(arguments);
  child.arguments.insert(child.arguments.end(), {"--threads", fmt::format("{}", plan_.cage.options.threads)});
  child.out = scratch_ / fmt::format("{}.stdout", name);
  child.err = scratch_ / fmt::format("{}.stderr", name);
  child.memory_limit_bytes = plan_.memory_limit_mb << 20;
  child.timeout_seconds = plan_.timeout_seconds;
  return child;
}

ChildCommand BatchJob::cage_child() const {
  std::vector<std::string> arguments{
      "cage", input_.file, "--output", unplaced_cage(), "--stats", scratch_ / "cage.json", "--quiet"};
  const std::vector<std::string> settings = cage_arguments(plan_.cage);
  arguments.insert(arguments.end(), settings.begin(), settings.end());
  return child("cage", std::move(arguments));
}

ChildCommand BatchJob::evaluation_child() const {
  std::vector<std::string> arguments{"eval", input_.file, unplaced_cage(),       "--views",
                                     "0",    "--json",    scratch_ / "eval.json"};
  const std::vector<std::string> tau = tau_arguments(plan_.cage.options);
  arguments.insert(arguments.end(), tau.begin(), tau.end());
  if (plan_.cage.weld) arguments.emplace_back("--weld");
  return child("eval", std::move(arguments));
}

std::optional<BatchRow> BatchJob::poll() {
  const std::optional<ChildEnd> end = child_->poll();
  if (!end) return std::nullopt;
  if (evaluating_) {
    record_evaluation(*end);
  } else {
    record_cage(*end);
    evaluating_ = plan_.evaluates && has_cage(row_.text("status"));
    if (evaluating_) {
      child_ = std::make_unique<ChildProcess>(evaluation_child());
      return std::nullopt;
    }
  }
  place_cage();
  row_.set("finished", utc_now());
  return row_;
}

void BatchJob::record_cage(const ChildEnd& end) {
  const Json statistics = json_file(scratch_ / "cage.json");
  const Verdict verdict = judge(plan_, end, statistics, contents(scratch_ / "cage.stderr"));
  // When a run is told to end, it depends on the moment what it has to say.
  if (!end.timed_out) set_from_json(row_, BatchSource::statistics, statistics);
  if (reached_a_cage(verdict.status)) set_from_json(row_, BatchSource::cage, statistics);
  row_.set("mesh", input_.mesh);
  row_.set("settings", plan_.settings);
  row_.set("status", verdict.status);
  if (!verdict.cause.empty()) row_.set("cause", verdict.cause);
  if (end.signal != 0) {
    row_.set("signal", std::int64_t{end.signal});
  } else {
    row_.set("exit_code", std::int64_t{end.exit_code});
  }
  if (!verdict.message.empty()) row_.set("message", verdict.message);
  if (verdict.status == to_string(Status::invalid_input)) row_.set("defects", defects_text(statistics));
  row_.set("input_file", input_.file);
  row_.set("input_bytes", static_cast<std::int64_t>(input_.bytes));
  row_.set("timeout_seconds", plan_.timeout_seconds);
  row_.set("memory_limit_mb", static_cast<std::int64_t>(plan_.memory_limit_mb));
  row_.set("process_seconds", end.seconds);
  row_.set("peak_memory_bytes", static_cast<std::int64_t>(end.peak_memory_bytes));
}

// The cage stays what it is if it cannot be measured. One that fails its certificate this time is measured all the
// same.
void BatchJob::record_evaluation(const ChildEnd& end) {
  const Json report = json_file(scratch_ / "eval.json");
  if (!end.timed_out && end.signal == 0 && report.contains("measures")) {
    set_from_json(row_, BatchSource::evaluation, report);
  } else {
    const Verdict verdict = judge(plan_, end, Json(), contents(scratch_ / "eval.stderr"));
    row_.set("evaluation_failure", fmt::format("{}: {}", verdict.status, verdict.message));
  }
}

// A mesh that has no cage must not seem to have one that an earlier run left.
void BatchJob::place_cage() {
  const std::string name = cage_name(input_.mesh) + plan_.extension;
  if (!has_cage(row_.text("status"))) {
    fs::remove(plan_.output / name);
    return;
  }
  move_durably(unplaced_cage(), plan_.output / name);
  row_.set("cage_file", name);
}

}  // namespace prcage
