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

// Where a thickness proves to be too small for the budget: growing steps beyond it, to where it is no cage any more. A
// cage of the budget has edges so long that the smallest of them can be passed over.
std::vector<double> wider_steps(double tau, std::size_t face_budget, double diagonal, double area);

// What a cage of so many faces around a smooth surface of this area needs.
double usual_thickness(double area, std::size_t faces);

// How much of each thickness is left between a level and the next, and which share of it level i of n has then.
inline constexpr double level_gap = 0.01;
inline double level_share(std::size_t i, std::size_t n) { return 1 - static_cast<double>(n - 1 - i) * level_gap; }

// Empty if nested cages can have these budgets, else one sentence.
std::string levels_error(const std::vector<std::size_t>& face_budgets);

// How often vertices are moved inward after a cycle in which cages are tightened.
int tightening_passes(const Options& options);
// And how often in the end, either way, so that the cage fits the input better.
int fitting_passes(const Options& options);
// Growths, all alike, into which the last one of a thickness that is found is divided to see whether less is enough,
// and with how many seeds that is tried.
int last_step_parts(const Options& options);
int last_step_tries(const Options& options);

// Empty if the options are in range, else one sentence that names the option at fault.
std::string options_error(const Options& options);

}  // namespace prcage
