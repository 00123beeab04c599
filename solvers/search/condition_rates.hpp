#pragma once

#include <functional>
#include <limits>
#include <vector>

#include "solvers/problem/equilibrium.hpp"

namespace peristat {

/// Where the loads are for a value of the unknown.
using LoadPath = std::function<LoadPoint(double unknown)>;

/// Values of the unknown from which the loads' rates may be taken: a programme has kinks.
struct LoadRange {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

/// Rates of supports and loads, and of what the load changes of the internal forces, per degree of
/// freedom.
struct ConditionRates {
  std::vector<double> force{}, displacement{};
  std::vector<double> eigenstretch{};  ///< per point; empty without eigenstrains
};

/// Central differences over 2^-13, one-sided where the range ends, or an expression: sqrt(load) at
/// zero for one.
[[nodiscard]] ConditionRates rates_of(const EquilibriumProblem& problem, const StateView& at,
                                      const LoadPath& loads, double unknown,
                                      const LoadRange& range = {});

}  // namespace peristat
