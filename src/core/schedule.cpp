#include "core/schedule.h"

#include <algorithm>
#include <cmath>

namespace prcage {
namespace {

// Relative to the edges of the cage to be: what smooth surfaces need, and where the search for a thickness begins.
constexpr double smooth_thickness = 0.25;
constexpr double first_thickness = 0.02;
// Where it ends, relative to l: cages farther away are no cages any more.
constexpr double last_thickness = 0.5;

// Steps in which a thickness is looked for that would have been enough.
constexpr double estimate_growth = 1.2;
constexpr std::size_t most_levels = 50;

// Length of the edges of a cage of so many faces.
double edge_length(double area, std::size_t faces) {
  return std::sqrt(4 / std::sqrt(3.0) * area / static_cast<double>(faces));
}

// Finer growth than that of the middle makes no tighter cages than more passes at the same cost.
double growth(Quality quality) { return quality == Quality::fast ? 1.6 : 1.15; }

int by_quality(const Options& options, int fast, int standard, int best) {
  return options.quality == Quality::fast ? fast : options.quality == Quality::standard ? standard : best;
}

}  // namespace

int tightening_passes(const Options& options) {
  const int passes = by_quality(options, 0, 4, 16);
  return finds_thickness(options) ? passes : passes / 2;  // a given thickness is there to be used
}

int fitting_passes(const Options& options) { return finds_thickness(options) ? by_quality(options, 0, 20, 100) : 0; }

int last_step_parts(const Options& options) { return by_quality(options, 4, 4, 8); }

double usual_thickness(double area, std::size_t faces) { return smooth_thickness * edge_length(area, faces); }

std::vector<double> thickness_steps(const Options& options, double diagonal, double area) {
  std::vector<double> steps;
  if (finds_thickness(options)) {
    const double ratio = growth(options.quality);
    const double last = last_thickness * diagonal;
    const double edge = edge_length(area, options.face_budget);
    if (edge > 0)  // else there is no surface
      for (double t = std::min(first_thickness * edge, last); t < last; t *= ratio) steps.push_back(t);
    steps.push_back(last);
    return steps;
  }
  const double tau = options.tau_absolute > 0 ? options.tau_absolute : options.tau * diagonal;
  for (const double beta : options.schedule) steps.push_back(beta * tau);
  if (options.schedule.empty())
    for (int k = 1; k <= options.cycles; ++k) steps.push_back(static_cast<double>(k) / options.cycles * tau);
  return steps;
}

std::vector<double> wider_steps(double tau, std::size_t face_budget, double diagonal, double area) {
  std::vector<double> steps;
  const double least = first_thickness * edge_length(area, face_budget);
  for (double t = std::max(estimate_growth * tau, least); t < last_thickness * diagonal; t *= estimate_growth)
    steps.push_back(t);
  return steps;
}

std::string levels_error(const std::vector<std::size_t>& face_budgets) {
  if (face_budgets.empty() || face_budgets.size() > most_levels)
    return "there must be 1 to " + std::to_string(most_levels) + " levels";
  for (std::size_t i = 0; i < face_budgets.size(); ++i)
    if (face_budgets[i] == 0 || (i > 0 && face_budgets[i] >= face_budgets[i - 1]))
      return "the numbers of faces of the levels must fall, and be at least 1";
  return {};
}

std::string options_error(const Options& options) {
  if (options.tau_absolute != 0 && !(options.tau_absolute > 0 && std::isfinite(options.tau_absolute)))
    return "tau_absolute must be positive and finite";
  if (finds_thickness(options) && options.face_budget == 0)
    return "tau must be in (0, 1], or 0 together with a face budget";
  if (options.tau_absolute == 0 && !(options.tau >= 0 && options.tau <= 1)) return "tau must be in [0, 1]";
  if (!(options.sigma > 0 && options.sigma <= 0.01)) return "sigma must be in (0, 0.01]";
  if (options.threads < 0 || options.threads > 4096) return "threads must be in [0, 4096]";
  if (options.schedule.empty()) {
    if (options.cycles < 1 || options.cycles > 10000) return "cycles must be in [1, 10000]";
    return {};
  }
  double last = 0;
  for (const double beta : options.schedule) {
    if (!(beta > last && beta <= 1)) return "schedule must rise strictly within (0, 1]";
    last = beta;
  }
  if (last != 1) return "schedule must end at 1";
  return {};
}

}  // namespace prcage
