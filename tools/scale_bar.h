// The colours that stand for distances in a picture, and the bar that says which is which.
#pragma once

#include "tools/picture.h"

namespace prcage {

// From dark blue at 0 to yellow at 1, through green: the scale viridis, as in the page of a report. Lightness rises
// evenly, so that it can be read in grey and by the colour-blind.
Color scale_color(double part);

// Pixels across that the bar and its labels take: at most a third of a picture that is wide enough for one.
inline constexpr int least_width_with_scale = 200;
int scale_bar_width(int picture_width, int picture_height);

// Draws the bar at the right border, from 0 to `largest`, which is relative to the diagonal: labels are percent of it.
void draw_scale_bar(Picture& picture, double largest);

}  // namespace prcage
