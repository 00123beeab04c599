#pragma once

#include <functional>
#include <limits>
#include <vector>

#include "solvers/problem/equilibrium.hpp"

namespace peristat {

/// Load point as a function of the unknown.
using LoadPath = std::function<LoadPoint(double unknown)>;

/// Range of the unknown within which rates of loads may be taken: a programme has kinks.
struct LoadRange {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

/// Rates of supports and of loads, less those of the internal forces at fixed displacements, per
/// degree of freedom.
struct ConditionRates {
  std::vector<double> force{}, displacement{};
  std::vector<double> eigenstretch{};  ///< per point; empty without eigenstrains
};

/// Central differences over 2^-13; one-sided at the ends of the range, and where an expression is
/// defined on one side only, such as sqrt(load) at zero.
[[nodiscard]] ConditionRates rates_of(const EquilibriumProblem& problem, const StateView& at,
                                      const LoadPath& loads, double unknown,
                                      const LoadRange& range = {});

}  // namespace peristat
