#include "solvers/search/newton.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "solvers/search/convergence.hpp"
#include "solvers/search/foreseen_contacts.hpp"
#include "solvers/search/linearisation.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

/// Negative pivots for the history: -1 if there are some that were not counted.
std::int64_t told_negative_pivots(LinearOutcome linear, const std::optional<Inertia>& inertia) {
  if (inertia) return inertia->negative;
  return linear == LinearOutcome::not_positive_definite ? -1 : 0;
}

/// True if the direction of a projected tangent may succeed where the exact one's failed.
bool projection_may_help(Outcome outcome) {
  return outcome == Outcome::not_positive_definite || outcome == Outcome::no_descent ||
         outcome == Outcome::line_search_failed || outcome == Outcome::degenerate ||
         outcome == Outcome::singular_tangent;
}

/// Rounds in which the normal forces of friction are taken anew.
constexpr int most_rounds_of_friction = 60;

/// One search, from the jump of supports and loads on.
class NewtonSearch {
 public:
  NewtonSearch(const EquilibriumProblem& problem, LinearSolver& solver, TangentOperator& tangent,
               const State& from, const LoadPoint& at, const NewtonOptions& options,
               const IterationObserver& observer)
      : problem_(problem),
        solver_(solver),
        tangent_(tangent),
        from_(from),
        options_(options),
        observer_(observer),
        damage_(at == load_point(from) ? options.damage : Damage::held),
        external_force_(from.displacement.size()),
        history_(from.history),
        linearisation_(problem, solver, tangent, external_force_) {
    problem.conditions.external_force(at, external_force_);
    problem.assembler.stick(StateView(from), history_);
    current_.displacement = from.displacement;
    current_.history = history_;
    current_.environment = from.environment;
    evaluate(problem, external_force_, current_, options.damage);
    start_gradient_ = current_.gradient;
    start_curvature_ = current_.curvature;
    current_.environment = problem.environment(at);
    // Right after the jump, bonds beside the supports are stretched as in no equilibrium. If they
    // could break, nothing would be left to measure the residual against, and the search would
    // begin in a torn body. Damage is therefore held until the predictor has spread the jump.
    problem.conditions.prescribe(at, current_.displacement);
    share_out_jump(problem, from.displacement, current_.displacement);
    evaluate(problem, external_force_, current_, damage_);
    result_.scale = options.scale > 0.0 ? options.scale : scale_after_jump();
    if (problem.assembler.has_contacts()) foreseen_ = from.displacement;
    if (current_.environment || problem.assembler.has_contacts()) {
      find_start_gradient();
      if (options.scale <= 0.0) {
        result_.scale =
            std::max(result_.scale, environment_norm(problem, start(), start_gradient_));
      }
    }
    scale_at_start_ = result_.scale;
  }

  [[nodiscard]] NewtonResult run() {
    result_.outcome = search();
    for (int round = 1; result_.outcome == Outcome::converged && lags_friction(); ++round) {
      result_.outcome = round < most_rounds_of_friction ? search() : Outcome::iteration_limit;
    }
    if (result_.outcome == Outcome::converged &&
        problem_.assembler.has_passed(from_, current_.at(damage_))) {
      result_.outcome = Outcome::degenerate;
    }
    if (result_.unstable_start && result_.outcome != Outcome::converged &&
        result_.outcome != Outcome::interrupted) {
      result_.outcome = Outcome::not_positive_definite;
      result_.inertia = start_inertia_;
    }
    result_.state = std::move(current_);
    result_.external_force = std::move(external_force_);
    return std::move(result_);
  }

 private:
  /// State about which the predictor linearises: old displacement, environment of the new load.
  [[nodiscard]] StateView start() const {
    StateView view(from_.displacement, history_, damage_, current_.environment);
    view.curvature = start_curvature_;
    view.foreseen = foreseen_;
    return view;
  }

  /// Scale of residuals. The law of contacts means nothing where a jump drives them together, so
  /// they count as springs.
  [[nodiscard]] double scale_after_jump() {
    if (!problem_.assembler.has_contacts()) {
      return residual_scale(problem_, external_force_, start_gradient_, current_);
    }
    Trial jumped = current_;
    jumped.foreseen = from_.displacement;
    evaluate(problem_, external_force_, jumped, damage_);
    return residual_scale(problem_, external_force_, start_gradient_, jumped);
  }

  /// Takes the normal forces of friction from the present state, unless they are those of the
  /// search already.
  [[nodiscard]] bool lags_friction() {
    constexpr double same = 1e-6;
    Assembler& assembler = problem_.assembler;
    if (!assembler.has_friction()) return false;
    History history = current_.history;
    const double change = assembler.lag_friction(current_.at(damage_), from_, history);
    if (!(change > same)) return false;
    current_.history = std::move(history);
    evaluate(problem_, external_force_, current_, damage_);
    return true;
  }

  void find_start_gradient() {
    Trial there;
    there.displacement = from_.displacement;
    there.history = history_;
    there.environment = current_.environment;
    there.foreseen = foreseen_;
    evaluate(problem_, external_force_, there, damage_);
    start_gradient_ = std::move(there.gradient);
    start_curvature_ = std::move(there.curvature);
  }

  Outcome search() {
    // The state right after the jump may be degenerate (a support driven onto a neighbour). The
    // predictor moves the neighbours away, so only its result is judged.
    if (!current_.degenerate && interrupts({})) return Outcome::interrupted;
    if (has_converged()) {  // everything that moves is prescribed
      release_damage();
      if (has_converged()) return Outcome::converged;
    }
    const int first = result_.iterations + 1;
    for (int iteration = first; iteration < first + options_.max_iterations; ++iteration) {
      IterationRecord row;
      row.iteration = iteration;
      const Outcome outcome = advance(row);
      if (outcome != Outcome::converged) return outcome;
      result_.iterations = iteration;
      if (interrupts(row)) return Outcome::interrupted;
      if (has_converged()) return Outcome::converged;
    }
    return Outcome::iteration_limit;
  }

  /// Moves to the next state, along the direction of the exact tangent or, if that fails, of the
  /// least projected tangent that succeeds.
  Outcome advance(IterationRecord& row) {
    const double target = options_.relative_tolerance * result_.scale;
    const double tolerance = std::min(forcing_term(current_.residual_norm, last_residual_, target),
                                      options_.linear_tolerance);
    last_residual_ = current_.residual_norm;
    // The pivots of the old state show whether it is stable; later, counting would cost more than
    // solving.
    solver_.count_pivots(options_.counts_pivots && row.iteration == 1);
    row.projection = options_.projection == Projection::always ? 1.0 : 0.0;
    Outcome outcome = try_direction(row, tolerance);
    while (options_.projection != Projection::never && row.projection < 1.0 &&
           projection_may_help(outcome)) {
      row.projection = row.projection == 0.0
                           ? std::max(last_projection_ / 4.0, options_.least_projection)
                           : std::min(4.0 * row.projection, 1.0);
      outcome = try_direction(row, tolerance);
    }
    if (outcome != Outcome::converged) return outcome;
    current_ = std::exchange(next_, {});
    release_damage();
    if (row.projection > 0.0) last_projection_ = row.projection;
    return outcome;
  }

  /// Stores the state that the direction leads to in next_.
  Outcome try_direction(IterationRecord& row, double tolerance) {
    const bool is_predictor = row.iteration == 1 && options_.predictor == Predictor::consistent;
    const LinearOutcome linear = find_direction(row, is_predictor, tolerance);
    if (linear != LinearOutcome::solved) return outcome_of(linear);
    const LineSearchResult found = line_search(problem_, external_force_, current_, direction_,
                                               options_.line_search, next_, damage_);
    row.rejected_trials += found.rejected;
    row.degenerate_trials += found.degenerate;
    row.step_length = found.step_length;
    if (!is_predictor || found.outcome == Outcome::converged) return found.outcome;
    // After the jump the energy may be meaningless (collapsed or overstretched bonds beside the
    // supports): the predictor is then taken in full, and the next iteration judges it.
    next_.displacement = current_.displacement;
    next_.history = current_.history;
    next_.environment = current_.environment;
    add_scaled(next_.displacement, 1.0, direction_);
    evaluate(problem_, external_force_, next_, damage_);
    row.step_length = 1.0;
    return next_.degenerate ? Outcome::degenerate : Outcome::converged;
  }

  LinearOutcome find_direction(IterationRecord& row, bool is_predictor, double tolerance) {
    const bool is_exact = row.projection == 0.0;
    const FactorUse use = (row.iteration == 1 && options_.factorizes_first) || !is_exact
                              ? FactorUse::factorize_now
                              : FactorUse::may_reuse;
    const LinearOutcome linear =
        is_predictor ? predict(row.projection, use, tolerance)
                     : linearisation_.solve(current_.at(damage_), current_.gradient, row.projection,
                                            use, {}, tolerance, direction_);
    row.linear_iterations = solver_.last_iterations();
    row.linear_tolerance = row.linear_iterations > 0 ? tolerance : 0.0;
    if (!is_exact) return linear;
    result_.inertia = solver_.inertia();
    row.negative_pivots = told_negative_pivots(linear, result_.inertia);
    result_.has_negative_pivots = row.negative_pivots != 0;
    if (is_predictor) {
      result_.unstable_start = linear == LinearOutcome::not_positive_definite;
      start_inertia_ = result_.inertia;
    }
    return linear;
  }

  /// Finds the direction of the predictor.
  LinearOutcome predict(double projection, FactorUse use, double tolerance) {
    // A projected tangent is that of the last exact one.
    if (!problem_.assembler.has_contacts() || has_predicted_) {
      return solve_at_start(projection, use, tolerance);
    }
    has_predicted_ = true;
    return predict_with_contacts(
        problem_, foreseen_, [this] { return start(); },
        [&](std::vector<double>& next) {
          find_start_gradient();
          const LinearOutcome linear = solve_at_start(projection, use, tolerance);
          next = current_.displacement;
          if (linear == LinearOutcome::solved) add_scaled(next, 1.0, direction_);
          return linear;
        });
  }

  LinearOutcome solve_at_start(double projection, FactorUse use, double tolerance) {
    return linearisation_.solve(start(), start_gradient_, projection, use, current_.displacement,
                                tolerance, direction_);
  }

  void release_damage() {
    if (damage_ == options_.damage) return;
    damage_ = options_.damage;
    evaluate(problem_, external_force_, current_, damage_);
  }

  /// Contacts that close in the step may bear the only forces of the body.
  [[nodiscard]] bool has_converged() {
    if (problem_.assembler.has_contacts() && options_.scale <= 0.0) {
      result_.scale = std::max(scale_at_start_,
                               environment_norm(problem_, current_.at(damage_), current_.gradient));
    }
    return note_convergence(problem_, tangent_, current_, last_residual_,
                            options_.relative_tolerance, result_);
  }

  /// Reports the state of the search to the observer.
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
  const NewtonOptions& options_;
  const IterationObserver& observer_;
  Damage damage_;
  std::vector<double> external_force_;
  History history_;  // before the search, with contacts that stick
  Linearisation linearisation_;
  Trial current_, next_;
  std::vector<Tensor> start_curvature_;
  std::vector<double> start_gradient_;  // dE/dx at start()
  std::vector<double> foreseen_;        // displacement behind the predictor; empty: no contacts
  bool has_predicted_ = false;          // foreseen_ is the predictor's
  std::vector<double> direction_;
  std::optional<Inertia> start_inertia_;
  double last_residual_ = 0.0, last_projection_ = 0.0, scale_at_start_ = 0.0;
  NewtonResult result_;
};

}  // namespace

NewtonResult newton(const EquilibriumProblem& problem, LinearSolver& solver,
                    TangentOperator& tangent, const State& from, const LoadPoint& at,
                    const NewtonOptions& options, const IterationObserver& observer) {
  return NewtonSearch(problem, solver, tangent, from, at, options, observer).run();
}

}  // namespace peristat
