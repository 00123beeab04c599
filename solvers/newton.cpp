#include "solvers/newton.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "solvers/vector_verbs.hpp"

namespace peristat {
namespace {

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

/// Linear systems of the iterations. Of a large body the vectors count: none lives while a system
/// is solved that isn't needed then.
class Linearisation {
 public:
  Linearisation(const EquilibriumProblem& problem, LinearSolver& solver, TangentOperator& tangent,
                std::span<const double> external_force)
      : problem_(problem), solver_(solver), tangent_(tangent), external_force_(external_force) {}

  /// Finds the direction du with K_ff du_f = f_ext - dE/dx_f - K_fp jump_p at a state.
  /// @param projection of the interactions; after the exact tangent (0) of a state any other share
  ///        may follow at the same state
  /// @param after_jump displacement whose difference from the state's is the jump of the prescribed
  ///        ones; empty for none
  /// @param tolerance of the linear system's relative residual
  [[nodiscard]] LinearOutcome solve(const StateView& at, std::span<const double> gradient,
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
      std::vector<double> jump(after_jump.begin(), after_jump.end()), force(jump.size());
      add_scaled(jump, -1.0, at.displacement);
      tangent_.multiply(jump, force);
      for (std::size_t e = 0; e < right_hand_side.size(); ++e) {
        right_hand_side[e] -= force[problem_.free.dof[e]];
      }
    }
    LinearOutcome outcome = solver_.factorize(tangent_, use);
    std::vector<double> solution(right_hand_side.size());
    if (outcome == LinearOutcome::solved) {
      outcome = solver_.solve(right_hand_side, solution, tolerance);
    }
    direction.resize(at.displacement.size());
    problem_.free.extend_by_zero(solution, direction);
    return outcome;
  }

 private:
  void assemble(const StateView& at, double projection) {
    Tangent* const stored = tangent_.stored();
    if (projection == 0.0 || !exact_is_known_ || !stored) {
      tangent_.linearise(problem_.assembler, at, projection);
      exact_is_known_ = projection == 0.0;
      to_projected_.reset();
      projection_ = projection;
      return;
    }
    // Linear in the share: the projection of every interaction, which is what costs, is done once.
    if (!to_projected_) {
      to_projected_.emplace(stored->pattern, stored->dimension, stored->threads(), stored->blocks);
      problem_.assembler.tangent(at, *to_projected_, 1.0);
      add_scaled(to_projected_->diagonal, -1.0, stored->diagonal);
      add_scaled(to_projected_->off_diagonal, -1.0, stored->off_diagonal);
    }
    add_scaled(stored->diagonal, projection - projection_, to_projected_->diagonal);
    add_scaled(stored->off_diagonal, projection - projection_, to_projected_->off_diagonal);
    projection_ = projection;
  }

  const EquilibriumProblem& problem_;
  LinearSolver& solver_;
  TangentOperator& tangent_;
  std::optional<Tangent> to_projected_;  // projected minus exact, of the present state
  double projection_ = 0.0;
  bool exact_is_known_ = false;
  std::span<const double> external_force_;
};

/// Relative residual to which a linear system is solved (choice 2 of Eisenstat and Walker, SIAM J.
/// Sci. Comput. 17, 1996, with exponent 2, for which Newton stays quadratic): the square of the
/// last iteration's gain, but no more digits than the target needs.
/// @param last that of the iteration before, 0 in the first one
double forcing_term(double residual, double last, double target) {
  constexpr double largest = 1e-3, share_of_target = 0.1;
  const double gain = last > 0.0 ? residual / last : 1.0;
  const double enough = residual > 0.0 ? share_of_target * target / residual : largest;
  return std::min(largest, std::max(gain * gain, enough));
}

/// An iteration that leaves more than this share of the residual has stagnated.
constexpr double stagnation = 0.5;

/// Largest relative residual that counts as converged because round-off leaves no less.
constexpr double coarsest_round_off = 1e-6;

/// Negative pivots for the history.
std::int64_t told_negative_pivots(LinearOutcome linear, const std::optional<Inertia>& inertia) {
  if (inertia) return inertia->negative;
  return linear == LinearOutcome::not_positive_definite ? -1 : 0;
}

/// Whether a search along a projected tangent's direction may succeed where the exact one's failed.
bool projection_may_help(Outcome outcome) {
  return outcome == Outcome::not_positive_definite || outcome == Outcome::no_descent ||
         outcome == Outcome::line_search_failed || outcome == Outcome::degenerate;
}

}  // namespace

NewtonResult newton(const EquilibriumProblem& problem, LinearSolver& solver,
                    TangentOperator& tangent, const State& from, double load_factor,
                    const NewtonOptions& options, const IterationObserver& observer) {
  const std::size_t dofs = from.displacement.size();
  NewtonResult result;
  result.external_force.resize(dofs);
  problem.conditions.external_force(load_factor, result.external_force);
  const std::vector<double>& external_force = result.external_force;
  double last_residual = 0.0;

  Trial& current = result.state;
  current.displacement = from.displacement;
  current.history = from.history;
  evaluate(problem, external_force, current, options.damage);
  const std::vector<double> old_gradient = current.gradient;

  // Right after the jump bonds beside the supports are stretched as no equilibrium will ask for.
  // Where they may break, nothing would be left to measure the residual against, and the search
  // would begin in a torn body: damage is held until the predictor has spread the jump.
  Damage damage = load_factor == from.load_factor ? options.damage : Damage::held;
  const auto release = [&] {
    if (damage == options.damage) return;
    damage = options.damage;
    evaluate(problem, external_force, current, damage);
  };
  problem.conditions.prescribe(load_factor, current.displacement);
  evaluate(problem, external_force, current, damage);
  const double scale = options.scale > 0.0
                           ? options.scale
                           : residual_scale(problem, external_force, old_gradient, current);

  result.scale = scale;

  const auto record = [&](IterationRecord row) {
    row.residual = current.residual_norm;
    row.relative_residual = scale > 0.0 ? current.residual_norm / scale : 0.0;
    row.energy = current.total_energy;
    return observer && observer(row);
  };
  const auto converged = [&] {
    if (current.degenerate) return false;
    result.largest_residual = options.relative_tolerance * scale;
    if (current.residual_norm <= result.largest_residual) return true;
    if (result.iterations < 2 || current.residual_norm < stagnation * last_residual ||
        current.residual_norm > coarsest_round_off * scale) {
      return false;
    }
    const double round_off = residual_round_off(problem.free, tangent, current.displacement);
    result.is_at_round_off = current.residual_norm <= round_off;
    if (result.is_at_round_off) result.largest_residual = round_off;
    return result.is_at_round_off;
  };
  // A state right after the jump may be degenerate (a support driven onto a neighbour); the
  // predictor is what moves the neighbours away, so only its result is judged.
  if (!current.degenerate && record({})) {
    result.outcome = Outcome::interrupted;
    return result;
  }
  if (converged()) {  // all that moves is prescribed
    release();
    if (converged()) return result;
  }

  Trial next;
  Linearisation linearisation(problem, solver, tangent, external_force);
  std::vector<double> direction;
  std::optional<Inertia> start_inertia;
  double last_projection = 0.0;
  for (int iteration = 1; iteration <= options.max_iterations; ++iteration) {
    const bool is_predictor = iteration == 1 && options.predictor == Predictor::consistent;
    const double forcing = std::min(
        forcing_term(current.residual_norm, last_residual, options.relative_tolerance * scale),
        options.linear_tolerance);
    last_residual = current.residual_norm;
    IterationRecord row;
    row.iteration = iteration;
    // Those of the old state tell whether it is stable; on the way counting would cost more than
    // solving.
    solver.count_pivots(options.counts_pivots && iteration == 1);
    LineSearchResult search;
    for (double projection = options.projection == Projection::always ? 1.0 : 0.0;;) {
      const bool exact = projection == 0.0;
      const FactorUse use = (iteration == 1 && options.factorizes_first) || !exact
                                ? FactorUse::factorize_now
                                : FactorUse::may_reuse;
      const LinearOutcome linear =
          is_predictor ? linearisation.solve({from, damage}, old_gradient, projection, use,
                                             current.displacement, forcing, direction)
                       : linearisation.solve(current.at(damage), current.gradient, projection, use,
                                             {}, forcing, direction);
      if (exact) {
        result.inertia = solver.inertia();
        row.negative_pivots = told_negative_pivots(linear, result.inertia);
        result.has_negative_pivots = row.negative_pivots != 0;
        if (is_predictor) {
          result.unstable_start = linear == LinearOutcome::not_positive_definite;
          start_inertia = result.inertia;
        }
      }
      row.projection = projection;
      row.linear_iterations = solver.last_iterations();
      row.linear_tolerance = row.linear_iterations > 0 ? forcing : 0.0;
      result.outcome = outcome_of(linear);
      if (result.outcome == Outcome::converged) {
        search = line_search(problem, external_force, current, direction, options.line_search, next,
                             damage);
        result.outcome = search.outcome;
      }
      row.rejected_trials += search.rejected;
      row.degenerate_trials += search.degenerate;
      if (is_predictor && linear == LinearOutcome::solved && search.outcome != Outcome::converged) {
        // The jump can leave a state in which the energy tells nothing (collapsed or overstretched
        // bonds beside the supports): the predictor is then taken in full, and the next iteration
        // judges it.
        next.displacement = current.displacement;
        next.history = current.history;
        add_scaled(next.displacement, 1.0, direction);
        evaluate(problem, external_force, next, damage);
        search.step_length = 1.0;
        result.outcome = next.degenerate ? Outcome::degenerate : Outcome::converged;
      }
      const bool may_project = options.projection != Projection::never && projection < 1.0;
      if (!may_project || !projection_may_help(result.outcome)) break;
      projection = exact ? std::max(last_projection / 4.0, options.least_projection)
                         : std::min(4.0 * projection, 1.0);
    }
    if (result.outcome != Outcome::converged) break;
    current = std::exchange(next, {});
    release();
    if (row.projection > 0.0) last_projection = row.projection;
    result.iterations = iteration;
    row.step_length = search.step_length;
    if (record(row)) {
      result.outcome = Outcome::interrupted;
      return result;
    }
    if (converged()) return result;
    result.outcome = Outcome::iteration_limit;
  }
  if (result.unstable_start) {
    result.outcome = Outcome::not_positive_definite;
    result.inertia = start_inertia;
  }
  return result;
}

}  // namespace peristat
