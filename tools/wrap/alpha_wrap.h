// An alpha wrap of triangles of any kind: a closed, oriented manifold free of self-intersections that strictly encloses
// every one of them, as a ball of radius alpha sees them that rolls round them at a distance (Portaneri et al. 2022).
//
// A component of its own, because the package that does the work, CGAL's Alpha_wrap_3, is under the GPL-3.0-or-later
// and the library is not. A program links either prcage_wrap or prcage_no_wrap, where every call says how to get it.
#pragma once

#include "core/prcage.h"

namespace prcage {

// Relative to l, the diagonal of the bounding box of the faces that are wrapped.
struct WrapSettings {
  // Openings and tunnels that a ball of this radius cannot pass are closed; also about the size of the wrap's
  // triangles. 0 leaves the choice to the faces: open_alpha if they have a boundary, else closed_alpha.
  double alpha = 0;
  // Distance from the wrap's vertices to the faces. The smaller, the closer are edges and corners followed.
  double offset = 1.0 / 600;
};

// Wide enough for the holes that scanners leave, in our experience: a ball that gets through one wraps both sides of
// the surface instead of the solid that is meant.
inline constexpr double open_alpha = 1.0 / 20;
// Where there is nothing to close, holes and slots that are a fiftieth of l wide stay open.
inline constexpr double closed_alpha = 1.0 / 100;

// Of the paper's topology-simplified cages (sec. 3.4), whose alpha is the reader's choice.
inline constexpr double topology_offset = 1.0 / 3000;

struct Wrap {
  // ok; cancelled, deadline_reached, invalid_options, invalid_input: nothing wrapped
  Status status = Status::internal_error;
  std::string message;    // empty if ok; one clause for people otherwise
  Mesh mesh;              // for make_cage_around() to check and to use
  DroppedFaces dropped;   // faces that have no area or no place
  WrapSettings settings;  // as given, alpha chosen
  double diagonal = 0;    // l
  double seconds = 0;
};

// Is the component built in?
bool has_alpha_wrap();

// What to say where it is not.
inline constexpr const char* missing_alpha_wrap =
    "this program was built without the alpha wrap; to have it, install CGAL 5.5 or later (Debian: libcgal-dev) and "
    "configure with -DPRCAGE_WITH_ALPHA_WRAP=ON (the program is then under the GPL-3.0-or-later)";

// One thread; the same triangles and settings give the same wrap. `control` may be null.
Wrap alpha_wrap(const MeshView& input, const WrapSettings& settings, Control* control = nullptr);

}  // namespace prcage
