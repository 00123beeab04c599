#include "solvers/search/bordered_newton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/search/condition_rates.hpp"
#include "solvers/search/convergence.hpp"
#include "solvers/search/foreseen_contacts.hpp"
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
        from_(from),
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
    if (result_.outcome == Outcome::converged &&
        problem_.assembler.has_passed(from_, current_.at(options_.damage))) {
      result_.outcome = Outcome::degenerate;
    }
    result_.state = std::move(current_);
    result_.external_force = std::move(external_force_);
    return {std::move(result_), unknown_};
  }

 private:
  Outcome search() {
    take_loads();
    evaluate(problem_, external_force_, current_, Damage::held);
    old_scale_ = load_norm();
    old_border_size_ = border_sum().size;
    Outcome outcome = begin();
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

  /// Goes to the prediction or, without one or where it closes or opens contacts, to where the
  /// linear problem about the old state leads.
  Outcome begin() {
    if (problem_.assembler.has_contacts()) {
      foreseen_ = !step_.prediction                    ? from_.displacement
                  : step_.prediction->foreseen.empty() ? step_.prediction->displacement
                                                       : step_.prediction->foreseen;
      problem_.assembler.cover_contacts(start());
    }
    if (!step_.prediction || changes_contacts()) return iterate(1, Damage::held);
    current_.displacement = step_.prediction->displacement;
    unknown_ = step_.prediction->unknown;
    stand_at_unknown();
    return interrupts({}) ? Outcome::interrupted : Outcome::converged;
  }

  /// The old state, with the contacts that are foreseen as closed.
  [[nodiscard]] StateView start() const {
    StateView view(from_.displacement, from_.history, Damage::held, current_.environment);
    view.curvature = start_.curvature;
    view.foreseen = foreseen_;
    return view;
  }

  /// True if other contacts are closed in the predicted state than in the old one.
  [[nodiscard]] bool changes_contacts() {
    if (foreseen_.empty()) return false;
    Assembler& assembler = problem_.assembler;
    StateView view = start();
    view.foreseen = from_.displacement;
    const std::vector<Index> before = assembler.closed_contacts(view);
    view.foreseen = foreseen_;
    view.environment = problem_.conditions.environment(step_.loads(step_.prediction->unknown));
    const bool changes = assembler.closed_contacts(view) != before;
    return problem_.sums().largest_of_all(changes ? 1.0 : 0.0) > 0.0;
  }

  /// @param damage in the state about which is linearised
  Outcome iterate(int iteration, Damage damage) {
    IterationRecord row;
    row.iteration = iteration;
    row.step_length = 1.0;
    last_residual_ = current_.residual_norm;
    Prediction next;
    const Outcome outcome = iteration == 1 && !foreseen_.empty()
                                ? correct_at_start(row, next)
                                : correct(current_.at(damage), current_.gradient, row, next);
    if (outcome != Outcome::converged) return outcome;
    // The predictor foresees what closes; if not, its state is judged as it is.
    const bool is_predictor = iteration == 1 && !foreseen_.empty();
    go_towards(next, is_predictor ? 1.0 : share_of(next), row);
    stand_at_unknown();
    result_.iterations = iteration;
    return interrupts(row) ? Outcome::interrupted : Outcome::converged;
  }

  /// Linearises about the old state. The loads are those of the last round, whose obstacles close
  /// the contacts.
  Outcome correct_at_start(IterationRecord& row, Prediction& next) {
    Outcome outcome = Outcome::converged;
    const double before = unknown_;
    if (step_.prediction) unknown_ = step_.prediction->unknown;
    take_loads();
    static_cast<void>(predict_with_contacts(
        problem_, foreseen_, [this] { return start(); },
        [&](std::vector<double>& leads_to) {
          start_.displacement = from_.displacement;
          start_.history = from_.history;
          start_.environment = current_.environment;
          start_.foreseen = foreseen_;
          evaluate(problem_, external_force_, start_, Damage::held);
          outcome = correct(start(), start_.gradient, row, next);
          if (outcome != Outcome::converged) return LinearOutcome::singular;
          leads_to = next.displacement;
          unknown_ = next.unknown;
          take_loads();
          return LinearOutcome::solved;
        }));
    unknown_ = before;
    return outcome;
  }

  /// Share of the way to a state that contacts allow.
  [[nodiscard]] double share_of(const Prediction& next) const {
    std::vector<double> step = next.displacement;
    add_scaled(step, -1.0, current_.displacement);
    return allowed_share(problem_, current_.at(Damage::held), step);
  }

  void go_towards(const Prediction& next, double share, IterationRecord& row) {
    row.step_length = share;
    if (share == 1.0) {
      current_.displacement = next.displacement;
      unknown_ = next.unknown;
      return;
    }
    for (std::size_t dof = 0; dof < current_.displacement.size(); ++dof) {
      current_.displacement[dof] += share * (next.displacement[dof] - current_.displacement[dof]);
    }
    unknown_ += share * (next.unknown - unknown_);
  }

  void take_loads() {
    const LoadPoint at = step_.loads(unknown_);
    problem_.conditions.external_force(at, external_force_);
    current_.environment = problem_.conditions.environment(at);
  }

  /// Moves supports and loads to the present unknown, and evaluates the state.
  void stand_at_unknown() {
    problem_.conditions.prescribe(step_.loads(unknown_), current_.displacement);
    take_loads();
    evaluate(problem_, external_force_, current_, options_.damage);
    result_.scale = options_.scale > 0.0 ? options_.scale : std::max(old_scale_, load_norm());
  }

  /// Linearises about a state, and finds where that leads to.
  Outcome correct(const StateView& at, std::span<const double> gradient, IterationRecord& row,
                  Prediction& next) {
    // If the search begins at the old state, another load parameter may have jumped.
    std::vector<double> after_jump = current_.displacement;
    problem_.conditions.prescribe(step_.loads(unknown_), after_jump);
    const bool jumps = after_jump != current_.displacement;
    std::vector<double> direction;
    LinearOutcome linear = linearisation_.solve(
        at, gradient, 0.0, FactorUse::factorize_now,
        jumps ? std::span<const double>(after_jump) : std::span<const double>(),
        options_.linear_tolerance, direction);
    result_.inertia = solver_.inertia();
    row.negative_pivots = result_.inertia ? result_.inertia->negative : -1;
    result_.has_negative_pivots = row.negative_pivots > 0;
    // In a trial state, points may have lost all their bonds: only the old state shows whether the
    // body has a singular tangent.
    if (linear == LinearOutcome::singular && row.iteration > 1) return Outcome::degenerate;
    if (linear != LinearOutcome::solved) return outcome_of(linear);

    const ConditionRates conditions = rates_of(problem_, at, step_.loads, unknown_);
    std::vector<double> rate;
    linear = linearisation_.solve_again(conditions.force, conditions.displacement,
                                        options_.linear_tolerance, rate);
    if (linear != LinearOutcome::solved) return outcome_of(linear);
    add_scaled(rate, 1.0, conditions.displacement);

    Trial led_to;
    led_to.displacement = std::move(after_jump);
    add_scaled(led_to.displacement, 1.0, direction);
    move_followers(problem_, led_to);
    problem_.conditions.constraints().extend(led_to.displacement, rate);
    const std::optional<double> change = change_of_unknown(led_to.displacement, rate);
    if (!change) return Outcome::no_answer;
    next.displacement = std::move(led_to.displacement);
    for (const Index dof : problem_.free.dof) next.displacement[dof] += *change * rate[dof];
    next.unknown = unknown_ + *change;
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
  std::optional<double> change_of_unknown(std::span<const double> displacement,
                                          std::span<const double> rate) {
    const BorderEquation& border = step_.border;
    const std::optional<double> answer = answer_of(border, rate);
    if (!answer) return std::nullopt;
    double missing = border.value - border.unknown_weight * unknown_;
    for (std::size_t dof = 0; dof < border.weights.size(); ++dof) {
      missing -= border.weights[dof] * displacement[dof];
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
  const State& from_;
  const BorderedStep& step_;
  const NewtonOptions& options_;
  const IterationObserver& observer_;
  double unknown_;
  std::vector<double> external_force_;
  Linearisation linearisation_;
  Trial current_;
  Trial start_;                   // the old state with foreseen contacts
  std::vector<double> foreseen_;  // displacement behind the predictor; empty: no contacts
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
