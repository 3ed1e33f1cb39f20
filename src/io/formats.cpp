// What the text formats share: error messages and coordinates.
#include "io/formats.h"

namespace prcage {

bool fail_expected(MeshFile& file, const TextCursor& cursor, const std::string& element, std::size_t number,
                   const char* expected) {
  const char* const advice = cursor.at_end() ? ": the file is truncated" : "";
  return fail(file, cursor,
              element + " " + std::to_string(number) + ": expected " + expected + ", found " + cursor.found() + advice);
}

bool read_position(TextCursor& cursor, MeshFile& file, std::size_t number, std::array<double, 3>& position) {
  for (double& coordinate : position) {
    cursor.skip_blanks();
    if (!cursor.read_number(coordinate)) return fail_expected(file, cursor, "vertex", number, "a coordinate");
  }
  return true;
}

}  // namespace prcage
