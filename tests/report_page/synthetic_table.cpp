// A table of made-up results for the test of the page: synthetic_table TABLE ROWS
//
// One row in twenty has no cage; the time is that of faces to the power 1.2, with noise. Among the names are some that
// a careless page would take for code.
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "core/counter_random.h"
#include "tools/batch_table.h"

namespace prcage {
namespace {

class Synthetic {
 public:
  explicit Synthetic(std::int64_t number) : number_(number), random_(0, static_cast<std::uint64_t>(number)) {}

  BatchRow row() {
    row_.set("mesh", name());
    row_.set("settings", std::string("--tau 0.025"));
    row_.set("input_file", fmt::format("/nowhere/{}.ply", number_));
    const double faces = std::floor(std::pow(10, 2.5 + 3.5 * random()));
    row_.set("input_faces", static_cast<std::int64_t>(faces));
    row_.set("process_seconds", 1 + random());
    if (number_ % 20 == 0) {
      fail();
    } else {
      succeed(faces);
    }
    return row_;
  }

 private:
  std::string name() const {
    if (number_ == 0) return "</script><script>window.taken_for_code = 1</script>.ply";
    if (number_ == 1) return "<img src=x onerror=\"window.taken_for_code = 2\">.ply";
    return fmt::format("synthetic/{:05}.ply", number_);
  }

  void fail() {
    const std::int64_t kind = number_ / 20 % 3;
    row_.set("status", std::string(kind == 0 ? "timeout" : kind == 1 ? "invalid_input" : "crashed"));
    row_.set("cause", std::string(kind == 0 ? "timeout" : kind == 1 ? "exit code" : "signal"));
    if (kind == 1) row_.set("exit_code", std::int64_t{4});
    if (kind == 2) row_.set("signal", std::int64_t{11});
    row_.set("message", std::string("made up"));
  }

  void succeed(double faces) {
    row_.set("status", std::string("ok"));
    row_.set("cage_file", fmt::format("{}.cage.ply", number_));
    row_.set("seconds", 2e-5 * std::pow(faces, 1.2) * std::exp(0.4 * normal()));
    row_.set("cage_faces", static_cast<std::int64_t>(std::floor(60 * std::exp(std::abs(normal())))));
    row_.set("certified", std::int64_t{1});
    row_.set("paper_success", std::int64_t{1});
    row_.set("hausdorff_rel", 0.014 * std::exp(0.4 * normal()));
    row_.set("normal_deviation_deg", 7 * std::exp(0.3 * normal()));
    row_.set("violation_max_rel", number_ % 50 == 7 ? 0.001 * random() : 0.0);
    row_.set("volume_ratio", 1 + 0.2 * random());
    row_.set("area_ratio", 1 - 0.1 * random());
  }

  double random() { return random_.uniform(draw_++); }
  double normal() {  // near enough: a sum of twelve
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += random();
    return sum;
  }

  std::int64_t number_;
  CounterRandom random_;
  std::uint64_t draw_ = 0;
  BatchRow row_;
};

}  // namespace
}  // namespace prcage

int main(int argc, char** argv) {
  std::int64_t rows = 0;
  const std::string_view text = argc == 3 ? argv[2] : "";
  if (std::from_chars(text.data(), text.data() + text.size(), rows).ec != std::errc{}) {
    std::cerr << "usage: synthetic_table TABLE ROWS\n";
    return EXIT_FAILURE;
  }
  prcage::BatchTable table(argv[1], prcage::BatchTable::Open::or_create);
  table.atomically([&] {
    for (std::int64_t i = 0; i < rows; ++i) table.put(prcage::Synthetic(i).row());
  });
  return EXIT_SUCCESS;
}
