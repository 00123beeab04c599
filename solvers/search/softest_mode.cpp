#include "solvers/search/softest_mode.hpp"

#include <algorithm>
#include <cmath>

#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

/// Near a critical point the other eigenvalues are larger by orders: a few iterations suffice.
constexpr int most_iterations = 50;
constexpr double direction_tolerance = 1e-8;
constexpr double tolerance_of_solves = 1e-10;

void normalise(std::vector<double>& mode) {
  double largest = 0.0;
  for (const double entry : mode) largest = std::max(largest, std::abs(entry));
  const auto first = std::find_if(mode.begin(), mode.end(),
                                  [&](double entry) { return std::abs(entry) >= 0.5 * largest; });
  const double size = std::copysign(norm(mode), first == mode.end() ? 1.0 : *first);
  for (double& entry : mode) entry /= size;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  return norm_of(a.size(), [&](std::size_t k) { return a[k] - b[k]; });
}

}  // namespace

LinearOutcome find_softest_mode(const EquilibriumProblem& problem, LinearSolver& solver,
                                TangentOperator& tangent, const StateView& at,
                                std::vector<double>& mode) {
  tangent.linearise(problem.assembler, at, 0.0);
  LinearOutcome outcome = solver.factorize(tangent, FactorUse::factorize_now);
  // The start oscillates, so that it has a part in every mode.
  std::vector<double> now(problem.free.dof.size()), next(now.size());
  for (std::size_t e = 0; e < now.size(); ++e) now[e] = std::sin(1.0 + 1e4 * double(e));
  normalise(now);
  for (int k = 0; k < most_iterations && outcome == LinearOutcome::solved; ++k) {
    outcome = solver.solve(now, next, tolerance_of_solves);
    normalise(next);
    const bool is_found = distance(now, next) <= direction_tolerance;
    std::swap(now, next);
    if (is_found) break;
  }
  mode.resize(problem.free.equation.size());
  problem.free.extend_by_zero(now, mode);
  return outcome;
}

}  // namespace peristat
