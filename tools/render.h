// Pictures of meshes and their cages for documentation: ray cast, soft light, white ground, crisp wires.
//
// Offline and of fixed style. The picture of a given input, cage and options is the same for any number of threads.
#pragma once

#include <string>

#include "core/prcage.h"
#include "tools/picture.h"

namespace prcage {

struct RenderOptions {
  // Of the whole picture, in pixels, 16 to 16384.
  int width = 1800;
  int height = 640;

  // Degrees. The camera looks at the middle of the scene from this direction: azimuth 0 is the +z side, 90 the +x
  // side; elevation 90 is above. It backs off until everything is in the picture.
  double azimuth = 30;
  double elevation = 18;
  bool z_up = false;  // z is up instead of y; azimuth 0 is then the -y side

  // With a cage: input, cage over input and cage alone, side by side. Otherwise one picture, cage over input.
  bool panels = true;

  // Above 0: colours the cage by its distance to the input, with a bar that says how, where otherwise is the cage alone
  // or the one picture. The colours end at this distance, relative to the diagonal of the input.
  double distance_max = 0;

  bool smooth = true;       // interpolate normals of the input where it has no crease; otherwise facets
  bool shadow = true;       // on an invisible white floor
  double line_width = 1.3;  // of the wires, in pixels
  int samples = 4;          // per pixel and axis, 1 to 16: anti-aliasing, and noise of the soft light
  int threads = 0;          // 0: as many as the machine has

  Color input_color{0.88, 0.71, 0.52};
  Color cage_color{0.60, 0.73, 0.87};
  Color line_color{0.08, 0.13, 0.22};
};

// Renders `input` and, unless null, `cage`, and writes a PNG as a whole or not at all ("-": standard output).
// The meshes need not be valid, but must have faces, indices in range and finite positions. False and one
// sentence in `error` otherwise, or if the file cannot be written.
bool render_png(const Mesh& input, const Mesh* cage, const RenderOptions& options, const std::string& path,
                std::string& error);

}  // namespace prcage
