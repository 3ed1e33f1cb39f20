#include "tools/scale_bar.h"

#include <fmt/core.h>
#include <stb/stb_easy_font.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace prcage {
namespace {

// What the bar and its letters are made of, in units of one pixel of the font.
constexpr int unit_width = 62;  // of everything
constexpr int bar_left = 6;     // from the left end of that
constexpr int bar_width = 12;
constexpr int label_gap = 4;
constexpr int line_height = 11;
constexpr int margin = 10;  // above and below
constexpr int steps = 4;    // from label to label

int unit(int picture_width, int picture_height) {
  return std::max(1, std::min(picture_width / 600, picture_height / 300));
}

void fill(Picture& picture, int left, int top, int width, int height, const Color& color) {
  for (int y = std::max(0, top); y < std::min(top + height, picture.height); ++y) {
    for (int x = std::max(0, left); x < std::min(left + width, picture.width); ++x) {
      for (std::size_t k = 0; k < 3; ++k) {
        picture.pixel(x, y)[k] = static_cast<std::uint8_t>(std::lround(255 * color[k]));
      }
    }
  }
}

// The font gives rectangles, four corners each, clockwise from the upper left.
void write(Picture& picture, int left, int top, int scale, std::string text) {
  struct Corner {
    float x, y, z;
    std::uint8_t color[4];
  };
  std::vector<Corner> corners(4 * 32 * (text.size() + 1));
  const int rectangles = stb_easy_font_print(0, 0, text.data(), nullptr, corners.data(),
                                             static_cast<int>(corners.size() * sizeof(Corner)));
  const auto pixels = [scale](float length) { return static_cast<int>(std::lround(length)) * scale; };
  for (int i = 0; i < rectangles; ++i) {
    const Corner& first = corners[4 * static_cast<std::size_t>(i)];
    const Corner& opposite = corners[4 * static_cast<std::size_t>(i) + 2];
    fill(picture, left + pixels(first.x), top + pixels(first.y), pixels(opposite.x - first.x),
         pixels(opposite.y - first.y), {0.1, 0.1, 0.1});
  }
}

}  // namespace

Color scale_color(double part) {
  // Nine points of the scale, evenly spaced.
  constexpr std::array<std::array<int, 3>, 9> points{{{68, 1, 84},
                                                      {71, 44, 122},
                                                      {59, 81, 139},
                                                      {44, 113, 142},
                                                      {33, 144, 141},
                                                      {39, 173, 129},
                                                      {92, 200, 99},
                                                      {170, 220, 50},
                                                      {253, 231, 37}}};
  const double at = std::clamp(part, 0.0, 1.0) * static_cast<double>(points.size() - 1);
  const std::size_t low = std::min(static_cast<std::size_t>(at), points.size() - 2);
  const double t = at - static_cast<double>(low);
  Color color{};
  for (std::size_t k = 0; k < 3; ++k) color[k] = ((1 - t) * points[low][k] + t * points[low + 1][k]) / 255;
  return color;
}

int scale_bar_width(int picture_width, int picture_height) { return unit_width * unit(picture_width, picture_height); }

void draw_scale_bar(Picture& picture, double largest) {
  const int u = unit(picture.width, picture.height);
  const int left = picture.width - unit_width * u + bar_left * u;
  write(picture, left, margin * u, u, "distance,\n% of the\ndiagonal");
  const int top = (margin + 4 * line_height) * u;
  const int height = picture.height - top - (margin + line_height / 2) * u;
  for (int y = 0; y < height; ++y) {
    const double part = 1 - (y + 0.5) / height;
    fill(picture, left, top + y, bar_width * u, 1, scale_color(part));
  }
  for (int i = 0; i <= steps; ++i) {
    const double part = static_cast<double>(i) / steps;
    const int y = top + static_cast<int>(std::lround((1 - part) * (height - 1)));
    write(picture, left + (bar_width + label_gap) * u, y - 4 * u, u, fmt::format("{:.3g}", 100 * largest * part));
  }
}

}  // namespace prcage
