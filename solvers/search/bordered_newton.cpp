#include "solvers/search/bordered_newton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/search/condition_rates.hpp"
#include "solvers/search/convergence.hpp"
#include "solvers/search/linearisation.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

/// Iterations that may pass without halving the smallest residual so far.
constexpr int most_without_gain = 10;

/// The border does not depend on the unknown if its derivative is below this fraction of its terms.
constexpr double no_answer = 1e-9;

class BorderedSearch {
 public:
  BorderedSearch(const EquilibriumProblem& problem, LinearSolver& solver, TangentOperator& tangent,
                 const State& from, const BorderedStep& step, const NewtonOptions& options,
                 const IterationObserver& observer)
      : problem_(problem),
        solver_(solver),
        tangent_(tangent),
        step_(step),
        options_(options),
        observer_(observer),
        unknown_(step.unknown),
        external_force_(from.displacement.size()),
        linearisation_(problem, solver, tangent, external_force_) {
    current_.displacement = from.displacement;
    current_.history = from.history;
  }

  [[nodiscard]] BorderedResult run() {
    result_.outcome = search();
    result_.state = std::move(current_);
    result_.external_force = std::move(external_force_);
    return {std::move(result_), unknown_};
  }

 private:
  Outcome search() {
    problem_.conditions.external_force(step_.loads(unknown_), external_force_);
    current_.environment = problem_.conditions.environment(step_.loads(unknown_));
    evaluate(problem_, external_force_, current_, Damage::held);
    old_scale_ = load_norm();
    old_border_size_ = border_sum().size;
    Outcome outcome = step_.prediction ? predict() : iterate(1, Damage::held);
    while (outcome == Outcome::converged && !has_converged()) {
      if (current_.degenerate) return Outcome::degenerate;
      if (result_.iterations >= options_.max_iterations || has_stalled()) {
        return Outcome::iteration_limit;
      }
      outcome = iterate(result_.iterations + 1, options_.damage);
    }
    return outcome;
  }

  /// True if the residual no longer falls: where bonds damage and heal from one iteration to the
  /// next, more iterations do not help.
  bool has_stalled() {
    if (current_.residual_norm < 0.5 * least_residual_ || result_.iterations == 0) {
      least_residual_ = current_.residual_norm;
      least_iteration_ = result_.iterations;
    }
    return result_.iterations - least_iteration_ >= most_without_gain;
  }

  Outcome predict() {
    current_.displacement = step_.prediction->displacement;
    unknown_ = step_.prediction->unknown;
    stand_at_unknown();
    return interrupts({}) ? Outcome::interrupted : Outcome::converged;
  }

  /// @param damage in the state about which is linearised
  Outcome iterate(int iteration, Damage damage) {
    IterationRecord row;
    row.iteration = iteration;
    row.step_length = 1.0;
    last_residual_ = current_.residual_norm;
    const Outcome outcome = correct(damage, row);
    if (outcome != Outcome::converged) return outcome;
    stand_at_unknown();
    result_.iterations = iteration;
    return interrupts(row) ? Outcome::interrupted : Outcome::converged;
  }

  /// Moves supports and loads to the present unknown, and evaluates the state.
  void stand_at_unknown() {
    const LoadPoint at = step_.loads(unknown_);
    problem_.conditions.prescribe(at, current_.displacement);
    problem_.conditions.external_force(at, external_force_);
    current_.environment = problem_.conditions.environment(at);
    evaluate(problem_, external_force_, current_, options_.damage);
    result_.scale = options_.scale > 0.0 ? options_.scale : std::max(old_scale_, load_norm());
  }

  Outcome correct(Damage damage, IterationRecord& row) {
    // If the search begins at the old state, another load parameter may have jumped.
    std::vector<double> after_jump = current_.displacement;
    problem_.conditions.prescribe(step_.loads(unknown_), after_jump);
    const bool jumps = after_jump != current_.displacement;
    std::vector<double> direction;
    LinearOutcome linear = linearisation_.solve(
        current_.at(damage), current_.gradient, 0.0, FactorUse::factorize_now,
        jumps ? std::span<const double>(after_jump) : std::span<const double>(),
        options_.linear_tolerance, direction);
    result_.inertia = solver_.inertia();
    row.negative_pivots = result_.inertia ? result_.inertia->negative : -1;
    result_.has_negative_pivots = row.negative_pivots > 0;
    // In a trial state, points may have lost all their bonds: only the old state shows whether the
    // body has a singular tangent.
    if (linear == LinearOutcome::singular && row.iteration > 1) return Outcome::degenerate;
    if (linear != LinearOutcome::solved) return outcome_of(linear);

    const ConditionRates conditions =
        rates_of(problem_, current_.at(damage), step_.loads, unknown_);
    std::vector<double> rate;
    linear = linearisation_.solve_again(conditions.force, conditions.displacement,
                                        options_.linear_tolerance, rate);
    if (linear != LinearOutcome::solved) return outcome_of(linear);
    add_scaled(rate, 1.0, conditions.displacement);

    current_.displacement = std::move(after_jump);
    add_scaled(current_.displacement, 1.0, direction);
    move_followers(problem_, current_);
    problem_.conditions.constraints().extend(current_.displacement, rate);
    const std::optional<double> change = change_of_unknown(rate);
    if (!change) return Outcome::no_answer;
    for (const Index dof : problem_.free.dof) current_.displacement[dof] += *change * rate[dof];
    unknown_ += *change;
    return Outcome::converged;
  }

  /// Left side of the border, and the sum of the sizes of all its terms.
  struct BorderSum {
    double value, size;
  };
  [[nodiscard]] BorderSum border_sum() const {
    const BorderEquation& border = step_.border;
    const double own = border.unknown_weight * unknown_;
    BorderSum sum{own, std::abs(own) + std::abs(border.value)};
    for (std::size_t dof = 0; dof < border.weights.size(); ++dof) {
      const double part = border.weights[dof] * current_.displacement[dof];
      sum.value += part;
      sum.size += std::abs(part);
    }
    return sum;
  }

  /// Measured against the terms in the old state, too: where all of them vanish there is no other
  /// scale.
  [[nodiscard]] bool fulfils_border() const {
    const BorderSum sum = border_sum();
    const double size = std::max(sum.size, old_border_size_);
    return std::abs(step_.border.value - sum.value) <= options_.relative_tolerance * size;
  }

  /// Change that fulfils the border; nothing if the border does not depend on the unknown.
  std::optional<double> change_of_unknown(std::span<const double> rate) {
    const BorderEquation& border = step_.border;
    const std::optional<double> answer = answer_of(border, rate);
    if (!answer) return std::nullopt;
    double missing = border.value - border.unknown_weight * unknown_;
    for (std::size_t dof = 0; dof < border.weights.size(); ++dof) {
      missing -= border.weights[dof] * current_.displacement[dof];
    }
    return missing / *answer;
  }

  [[nodiscard]] double load_norm() const {
    return peristat::load_norm(problem_, external_force_, current_, Damage::grows);
  }

  [[nodiscard]] bool has_converged() {
    return fulfils_border() && note_convergence(problem_, tangent_, current_, last_residual_,
                                                options_.relative_tolerance, result_);
  }

  [[nodiscard]] bool interrupts(IterationRecord row) const {
    row.residual = current_.residual_norm;
    row.relative_residual = result_.scale > 0.0 ? current_.residual_norm / result_.scale : 0.0;
    row.energy = current_.total_energy;
    return observer_ && observer_(row);
  }

  const EquilibriumProblem& problem_;
  LinearSolver& solver_;
  TangentOperator& tangent_;
  const BorderedStep& step_;
  const NewtonOptions& options_;
  const IterationObserver& observer_;
  double unknown_;
  std::vector<double> external_force_;
  Linearisation linearisation_;
  Trial current_;
  double last_residual_ = 0.0, old_scale_ = 0.0, old_border_size_ = 0.0;
  double least_residual_ = std::numeric_limits<double>::infinity();
  int least_iteration_ = 0;
  NewtonResult result_;
};

}  // namespace

std::optional<double> answer_of(const BorderEquation& border, std::span<const double> rate) {
  double answer = border.unknown_weight, weight = 0.0, largest = 0.0;
  for (std::size_t dof = 0; dof < border.weights.size(); ++dof) {
    answer += border.weights[dof] * rate[dof];
    weight += std::abs(border.weights[dof]);
    largest = std::max(largest, std::abs(rate[dof]));
  }
  const double of_all = weight * largest + std::abs(border.unknown_weight);
  return std::abs(answer) > no_answer * of_all ? std::optional(answer) : std::nullopt;
}

BorderedResult bordered_newton(const EquilibriumProblem& problem, LinearSolver& solver,
                               TangentOperator& tangent, const State& from,
                               const BorderedStep& step, const NewtonOptions& options,
                               const IterationObserver& observer) {
  return BorderedSearch(problem, solver, tangent, from, step, options, observer).run();
}

LinearOutcome find_rate(const EquilibriumProblem& problem, LinearSolver& solver,
                        TangentOperator& tangent, const StateView& at, const LoadPath& loads,
                        double unknown, std::vector<double>& rate) {
  tangent.linearise(problem.assembler, at, 0.0);
  LinearOutcome outcome = solver.factorize(tangent, FactorUse::factorize_now);
  if (outcome != LinearOutcome::solved) return outcome;
  const ConditionRates conditions = rates_of(problem, at, loads, unknown);
  constexpr double tolerance = 1e-12;
  outcome = Linearisation(problem, solver, tangent, {})
                .solve_again(conditions.force, conditions.displacement, tolerance, rate);
  add_scaled(rate, 1.0, conditions.displacement);
  problem.conditions.constraints().extend(at.displacement, rate);
  return outcome;
}

}  // namespace peristat
