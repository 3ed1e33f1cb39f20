// A finished picture, as bytes in rows from the top, and the file format that it goes into.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace prcage {

// A colour as it is on the screen (sRGB), 0..1.
using Color = std::array<double, 3>;

struct Picture {
  int width, height;
  std::vector<std::uint8_t> rgb;

  std::uint8_t* pixel(int x, int y) {
    return &rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x))];
  }
};

// As a PNG file. False and one sentence in `error` if that fails.
bool encode_png(const Picture& picture, std::vector<std::uint8_t>& bytes, std::string& error);

}  // namespace prcage
