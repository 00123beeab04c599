#include "solvers/search/linearisation.hpp"

#include <algorithm>

#include "src/core/vector_verbs.hpp"

namespace peristat {

LinearOutcome Linearisation::solve(const StateView& at, std::span<const double> gradient,
                                   double projection, FactorUse use,
                                   std::span<const double> after_jump, double tolerance,
                                   std::vector<double>& direction) {
  direction = std::vector<double>();
  assemble(at, projection);
  std::vector<double> right_hand_side(std::size_t(problem_.free.count()));
  for (std::size_t e = 0; e < right_hand_side.size(); ++e) {
    const Index dof = problem_.free.dof[e];
    right_hand_side[e] = external_force_[dof] - gradient[dof];
  }
  if (!after_jump.empty()) {
    std::vector<double> jump(after_jump.begin(), after_jump.end());
    add_scaled(jump, -1.0, at.displacement);
    take_off_support_force(jump, right_hand_side);
  }
  const LinearOutcome outcome = solver_.factorize(tangent_, use);
  if (outcome == LinearOutcome::solved) return solve_for(right_hand_side, tolerance, direction);
  direction.resize(at.displacement.size());
  return outcome;
}

LinearOutcome Linearisation::solve_again(std::span<const double> force,
                                         std::span<const double> jump, double tolerance,
                                         std::vector<double>& direction) {
  std::vector<double> right_hand_side(std::size_t(problem_.free.count()));
  problem_.free.restrict_to_free(force, right_hand_side);
  if (!jump.empty()) take_off_support_force(jump, right_hand_side);
  return solve_for(right_hand_side, tolerance, direction);
}

void Linearisation::take_off_support_force(std::span<const double> jump,
                                           std::span<double> right_hand_side) const {
  std::vector<double> force(jump.size());
  tangent_.multiply(jump, force);
  for (std::size_t e = 0; e < right_hand_side.size(); ++e) {
    right_hand_side[e] -= force[problem_.free.dof[e]];
  }
}

LinearOutcome Linearisation::solve_for(std::span<const double> right_hand_side, double tolerance,
                                       std::vector<double>& direction) {
  std::vector<double> solution(right_hand_side.size());
  const LinearOutcome outcome = solver_.solve(right_hand_side, solution, tolerance);
  direction.resize(problem_.free.equation.size());
  problem_.free.extend_by_zero(solution, direction);
  return outcome;
}

void Linearisation::assemble(const StateView& at, double projection) {
  Tangent* const stored = tangent_.as_tangent();
  if (projection == 0.0 || !exact_is_known_ || !stored) {
    tangent_.linearise(problem_.assembler, at, projection);
    exact_is_known_ = projection == 0.0;
    to_projected_.reset();
    projection_ = projection;
    return;
  }
  // The tangent is linear in the share, so that the costly projection of interactions is done once.
  if (!to_projected_) {
    to_projected_.emplace(stored->diagonal, stored->off_diagonal);
    auto& [diagonal, off_diagonal] = *to_projected_;
    tangent_.linearise(problem_.assembler, at, 1.0);
    diagonal.swap(stored->diagonal);
    off_diagonal.swap(stored->off_diagonal);
    add_scaled(diagonal, -1.0, stored->diagonal);
    add_scaled(off_diagonal, -1.0, stored->off_diagonal);
  }
  add_scaled(stored->diagonal, projection - projection_, to_projected_->first);
  add_scaled(stored->off_diagonal, projection - projection_, to_projected_->second);
  projection_ = projection;
}

Outcome outcome_of(LinearOutcome linear) {
  switch (linear) {
    case LinearOutcome::solved:
      return Outcome::converged;
    case LinearOutcome::not_positive_definite:
      return Outcome::not_positive_definite;
    case LinearOutcome::singular:
      return Outcome::singular_tangent;
    case LinearOutcome::out_of_memory:
      return Outcome::out_of_memory;
    case LinearOutcome::inaccurate:
      return Outcome::linear_solver_inaccurate;
  }
  return Outcome::singular_tangent;
}

double forcing_term(double residual, double last, double target) {
  constexpr double largest = 1e-3, share_of_target = 0.1;
  const double gain = last > 0.0 ? residual / last : 1.0;
  const double enough = residual > 0.0 ? share_of_target * target / residual : largest;
  return std::min(largest, std::max(gain * gain, enough));
}

}  // namespace peristat
