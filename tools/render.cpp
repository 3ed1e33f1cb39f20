// A picture is a row of panels. Each is rendered in bands of rows; within a band, first the wires are marked on the
// sample grid, then every sample is shaded and the samples of a pixel are averaged.
#include "tools/render.h"

#include <fmt/core.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/surface.h"
#include "io/mesh_file.h"
#include "tools/render_panel.h"
#include "tools/scale_bar.h"

namespace prcage {
namespace raycast {
namespace {

std::vector<Panel> make_panels(const Body& input, const Body* cage, const DistanceColors* distance,
                               const RenderOptions& options) {
  const Vec3f input_color = linear_color(options.input_color), cage_color = linear_color(options.cage_color);
  const Panel plain{&input, nullptr, nullptr, options.smooth, input_color};
  if (cage == nullptr) return {plain};
  const Panel caged{&input, cage, cage, options.smooth, input_color};
  const Panel alone{cage, nullptr, cage, false, cage_color, distance};
  if (!options.panels) return {distance != nullptr ? alone : caged};
  return {plain, caged, alone};
}

class PanelRenderer {
 public:
  PanelRenderer(const Panel& panel, const Style& style, const Camera& camera, int width)
      : style_(style),
        camera_(camera),
        width_(width),
        wires_(panel, style, camera, width * style.samples),
        shading_(panel, style, camera) {}

  // Rows [first, last) of pixels; put(x, y, linear colour) takes the result.
  template <class Put>
  void render_rows(int first, int last, const Put& put) const {
    const std::vector<Wire> wires = wires_.mark(first * style_.samples, last * style_.samples);
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < width_; ++x) put(x, y, render_pixel(x, y, first * style_.samples, wires));
    }
  }

 private:
  Vec3f render_pixel(int x, int y, int first_row, const std::vector<Wire>& wires) const {
    const int n = style_.samples;
    PixelSequence sequence(x, y);
    Vec3f sum = Vec3f::Zero();
    for (int row = y * n; row < (y + 1) * n; ++row) {
      for (int column = x * n; column < (x + 1) * n; ++column) {
        const auto entry = static_cast<std::size_t>(row - first_row) * static_cast<std::size_t>(width_ * n);
        const Vec3f ray = camera_.direction(static_cast<float>(column) + 0.5f, static_cast<float>(row) + 0.5f);
        sum += over_wire(wires[entry + static_cast<std::size_t>(column)], shading_(ray, sequence));
      }
    }
    return sum / static_cast<float>(n * n);
  }

  Vec3f over_wire(Wire wire, const Vec3f& color) const {
    if (wire == Wire::none) return color;
    const float opacity = wire == Wire::front ? 0.92f : 0.3f;
    return (1 - opacity) * color + opacity * style_.line_color;
  }

  const Style& style_;
  const Camera& camera_;
  int width_;
  Wires wires_;
  Shading shading_;
};

// Draws a panel into columns [left, left + width) of the picture.
void draw_panel(const Panel& panel, const Style& style, const Camera& camera, int left, int width, Picture& picture) {
  constexpr int band = 8;
  const PanelRenderer renderer(panel, style, camera, width);
  tbb::parallel_for(0, (picture.height + band - 1) / band, [&](int b) {
    renderer.render_rows(b * band, std::min((b + 1) * band, picture.height), [&](int x, int y, const Vec3f& color) {
      std::uint8_t* const pixel = picture.pixel(left + x, y);
      for (int channel = 0; channel < 3; ++channel) pixel[channel] = to_srgb_byte(color[channel]);
    });
  });
}

Picture render(const Mesh& input, const Mesh* cage, const RenderOptions& options) {
  const Device device(rtcNewDevice(nullptr));
  const Placement place = place_in_unit_ball(input, cage);
  const Body input_body(input, place, device.get());
  std::optional<Body> cage_body;
  if (cage != nullptr) cage_body.emplace(*cage, place, device.get());
  const Body* const cage_or_null = cage_body ? &*cage_body : nullptr;
  std::optional<DistanceColors> distance;
  if (cage != nullptr && options.distance_max > 0)
    distance.emplace(input, place, options.distance_max * extent(input.positions).diagonal());

  const std::vector<Panel> panels = make_panels(input_body, cage_or_null, distance ? &*distance : nullptr, options);
  const int count = static_cast<int>(panels.size());
  const int width = (options.width - (distance ? scale_bar_width(options.width, options.height) : 0)) / count;
  Camera camera(options, width * options.samples, options.height * options.samples);
  camera.fit(cage_or_null != nullptr ? std::vector{&input_body, cage_or_null} : std::vector{&input_body});

  const Style style{linear_color(options.cage_color), linear_color(options.line_color), options.shadow,
                    static_cast<float>(options.line_width * options.samples), options.samples};
  const std::size_t pixels = static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
  Picture picture{options.width, options.height, std::vector<std::uint8_t>(3 * pixels, 255)};
  int left = 0;
  for (const Panel& panel : panels) {
    draw_panel(panel, style, camera, left, width, picture);
    left += width;
  }
  if (distance) draw_scale_bar(picture, options.distance_max);
  return picture;
}

}  // namespace
}  // namespace raycast

namespace {

bool check_options(const RenderOptions& options, std::string& error) {
  const auto in_range = [](double x, double low, double high) { return x >= low && x <= high; };
  if (!in_range(options.width, 16, 16384) || !in_range(options.height, 16, 16384)) {
    error = "width and height must be 16 to 16384 pixels";
  } else if (!in_range(options.samples, 1, 16)) {
    error = "samples must be 1 to 16";
  } else if (!in_range(options.line_width, 0, 100)) {
    error = "line width must be 0 to 100 pixels";
  } else if (!(options.distance_max >= 0 && std::isfinite(options.distance_max))) {
    error = "the end of the scale of distances must be a finite number, not negative";
  } else if (options.distance_max > 0 && options.width < least_width_with_scale) {
    error = fmt::format("a picture with a scale must be at least {} pixels wide", least_width_with_scale);
  } else if (!in_range(options.elevation, -90, 90) || !std::isfinite(options.azimuth)) {
    error = "elevation must be -90 to 90 degrees and azimuth finite";
  } else {
    return true;
  }
  return false;
}

bool check_mesh(const Mesh& mesh, const std::string& name, std::string& error) {
  const auto finite = [](const Position& p) { return vec(p).allFinite(); };
  const auto in_range = [&](const Triangle& t) { return std::max({t[0], t[1], t[2]}) < mesh.positions.size(); };
  if (mesh.triangles.empty()) {
    error = "the " + name + " has no faces";
  } else if (!std::all_of(mesh.triangles.begin(), mesh.triangles.end(), in_range)) {
    error = "the " + name + " has a face with a vertex that does not exist";
  } else if (!std::all_of(mesh.positions.begin(), mesh.positions.end(), finite)) {
    error = "the " + name + " has a position that is not finite";
  } else {
    return true;
  }
  return false;
}

}  // namespace

bool render_png(const Mesh& input, const Mesh* cage, const RenderOptions& options, const std::string& path,
                std::string& error) {
  if (!check_options(options, error) || !check_mesh(input, "input", error)) return false;
  if (cage != nullptr && !check_mesh(*cage, "cage", error)) return false;
  // An arena of our own: Embree changes floating-point modes on workers, and those must not be the caller's. Embree
  // also limits the process to the machine's threads, and TBB complains about an arena of more.
  const int machine = tbb::info::default_concurrency();
  tbb::task_arena arena(options.threads > 0 ? std::min(options.threads, machine) : machine);
  const Picture picture = arena.execute([&] { return raycast::render(input, cage, options); });
  std::vector<std::uint8_t> bytes;
  if (!encode_png(picture, bytes, error)) return false;
  const WriteResult written = write_file(path, bytes.data(), bytes.size());
  if (!written.ok) error = written.error;
  return written.ok;
}

}  // namespace prcage
