// The staircase schedule (paper eq. 6): which thickness each cycle may use.
#pragma once

#include <string>
#include <vector>

#include "core/prcage.h"

namespace prcage {

// The thickness of each cycle in the unit of the input, rising. With tau given its shares by the list in the options,
// or `cycles` uniform steps (k / cycles) tau. Without, growing steps, from a small share of the length of the edges
// that a cage of the budget has on a surface of this area, to where it is no cage any more.
std::vector<double> thickness_steps(const Options& options, double diagonal, double area);

// Is the thickness to be found?
inline bool finds_thickness(const Options& options) { return options.tau == 0 && options.tau_absolute == 0; }

// How often vertices are moved inward after a cycle in which cages are tightened.
int tightening_passes(Quality quality);

// Empty if the options are in range, else one sentence that names the option at fault.
std::string options_error(const Options& options);

}  // namespace prcage
