#include "solvers/search/strength_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "assembly/borne_stretches.hpp"
#include "solvers/search/convergence.hpp"
#include "solvers/search/linearisation.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

/// Relative tolerance of the strength: half of the state's margin below it.
constexpr double strength_tolerance = 0.5 * (1.0 - share_at_strength);

/// By how much the first step along the tangent may miss its strength: beyond, the path is too
/// curved to know which strength is met first.
constexpr double largest_miss = 0.1;

/// Relative residual of the systems for the rate: its error is one of the state.
constexpr double rate_tolerance = 1e-8;

/// Relative residual below which an empty range is not caused by the iteration.
constexpr double nearly = 1e-6;

/// An iteration that leaves more than this fraction of the residual needs a new tangent.
constexpr double slow = 0.1;

class StrengthSearch {
 public:
  StrengthSearch(const EquilibriumProblem& problem, UpdatedTangent& tangent, const State& from,
                 const StrengthStep& step, const NewtonOptions& options,
                 const IterationObserver& observer)
      : problem_(problem),
        tangent_(tangent),
        step_(step),
        options_(options),
        observer_(observer),
        start_(step.preloads ? from.preload : from.stage),
        external_force_(from.displacement.size()) {
    current_.displacement = from.displacement;
    current_.history = from.history;
    result_.stage = start_;
    result_.end = StrengthEnd::at_stop;
  }

  [[nodiscard]] StrengthResult run() {
    stand();
    old_scale_ = present_load();
    result_.newton.outcome = search();
    result_.newton.state = std::move(current_);
    result_.newton.external_force = std::move(external_force_);
    return std::move(result_);
  }

 private:
  Outcome search() {
    for (int iteration = 1; iteration <= options_.max_iterations; ++iteration) {
      const Outcome outcome = iterate(iteration);
      if (outcome != Outcome::converged || result_.end == StrengthEnd::inadmissible) {
        return outcome;
      }
      if (is_balanced() && ends_well()) return Outcome::converged;
    }
    return Outcome::iteration_limit;
  }

  Outcome iterate(int iteration) {
    IterationRecord row;
    row.iteration = iteration;
    row.step_length = 1.0;
    if (!tangent_.is_there() || is_slow(iteration)) {
      if (Outcome found = refresh(); found != Outcome::converged) return found;
    }
    const double earlier = std::exchange(last_residual_, current_.residual_norm);
    if (Outcome found = correct(earlier); found != Outcome::converged) return found;
    if (!step_.settles) {
      if (Outcome found = find_rate(); found != Outcome::converged) return found;
      double change = choose(iteration == 1);
      if (result_.end == StrengthEnd::inadmissible && !is_fresh()) {
        // An old tangent does not predict the path well enough to give it up.
        result_.end = StrengthEnd::at_stop;
        if (Outcome found = refresh(); found != Outcome::converged) return found;
        if (Outcome found = find_rate(); found != Outcome::converged) return found;
        change = choose(iteration == 1);
      }
      if (result_.end == StrengthEnd::inadmissible) return Outcome::converged;
      for (const Index dof : problem_.free.dof) current_.displacement[dof] += change * rate_[dof];
      result_.stage = result_.end == StrengthEnd::at_stop ? step_.stop : result_.stage + change;
    }
    stand();
    result_.newton.iterations = iteration;
    row.linear_iterations = tangent_.last_iterations();
    if (current_.degenerate) return Outcome::degenerate;
    if (iteration == 1 && misses_by_far()) return Outcome::iteration_limit;
    return interrupts(row) ? Outcome::interrupted : Outcome::converged;
  }

  Outcome refresh() {
    refreshed_at_ = tangent_.refreshed() + 1;
    const LoadPoint at = step_.point(result_.stage);
    return outcome_of(tangent_.refresh({current_.displacement, at.stage, current_.history, at.load,
                                        current_.environment, at.preload}));
  }

  /// True if the tangent was refreshed by this search.
  [[nodiscard]] bool is_fresh() const { return refreshed_at_ == tangent_.refreshed(); }

  /// True if convergence is slow: the present tangent is too far from the state's.
  [[nodiscard]] bool is_slow(int iteration) const {
    return iteration > 2 && current_.residual_norm > slow * last_residual_ &&
           current_.residual_norm > options_.relative_tolerance * scale();
  }

  /// Moves to u + a.
  Outcome correct(double earlier) {
    const double target = options_.relative_tolerance * scale();
    if (current_.residual_norm <= target) return Outcome::converged;
    std::vector<double> residual = external_force_, correction;
    add_scaled(residual, -1.0, current_.gradient);
    const double tolerance =
        std::min(options_.linear_tolerance, forcing_term(current_.residual_norm, earlier, target));
    const LinearOutcome linear = tangent_.solve(residual, {}, tolerance, correction);
    if (linear != LinearOutcome::solved) return outcome_of(linear);
    add_scaled(current_.displacement, 1.0, correction);
    move_followers(problem_, current_);
    return Outcome::converged;
  }

  /// Finds b and the rates of the eigenstretches, anew if the tangent is or if there is an
  /// environment.
  Outcome find_rate() {
    const bool is_known = rate_of_ == tangent_.refreshed() && !current_.environment;
    if (is_known && !rate_.empty()) return Outcome::converged;
    ConditionRates conditions = rates_of(
        problem_, current_.at(Damage::held), [this](double stage) { return step_.point(stage); },
        result_.stage, step_.range);
    const LinearOutcome linear =
        tangent_.solve_again(conditions.force, conditions.displacement, rate_tolerance, rate_);
    if (linear != LinearOutcome::solved) return outcome_of(linear);
    rate_of_ = tangent_.refreshed();
    add_scaled(rate_, 1.0, conditions.displacement);
    problem_.conditions.constraints().extend(current_.displacement, rate_);
    eigenstretch_rate_ = std::move(conditions.eigenstretch);
    return Outcome::converged;
  }

  /// Returns the change of the stage, and sets the end that the search aims at.
  double choose(bool is_first) {
    const AdmissibleRange range =
        admissible_range(problem_.assembler, current_.at(Damage::held), step_.borne, rate_,
                         eigenstretch_rate_, share_at_strength);
    if (is_first) {
      if (range.low > range.high) return refuse();
      result_.goes_up = range.high >= 0.0;
      meets_upper_ = range.low <= 0.0 || range.high < 0.0;
    }
    const bool is_nearly_balanced = last_residual_ <= nearly * scale();
    if (!is_first && is_nearly_balanced && range.low > range.high) return refuse();
    double change = meets_upper_ ? range.high : range.low;
    result_.end = StrengthEnd::at_strength;
    // If the present stage is not admissible, the one to stop at need not be.
    const double stop = meets_upper_ ? step_.stop : step_.range.high;
    if (result_.goes_up && result_.stage + change > stop) {
      if (!meets_upper_) return refuse();
      result_.end = StrengthEnd::at_stop;
      change = stop - result_.stage;
    } else if (result_.stage + change < step_.range.low) {
      return refuse();
    }
    const double end = start_ + (result_.goes_up ? step_.longest : -step_.longest);
    const bool is_long = std::abs(result_.stage + change - start_) > step_.longest;
    if (is_long) {
      result_.end = StrengthEnd::on_the_way;
      change = end - result_.stage;
    }
    return change;
  }

  double refuse() {
    result_.end = StrengthEnd::inadmissible;
    return 0.0;
  }

  /// True if the state is the end that the search aims at; called in equilibrium.
  bool ends_well() {
    if (step_.settles) return true;
    const double most = utilisation();
    if (result_.end == StrengthEnd::at_strength) {
      if (std::abs(most - share_at_strength) <= strength_tolerance) return true;
      return false;
    }
    // If the stage decreases, bonds are overloaded until the strength is met.
    if (result_.end == StrengthEnd::on_the_way && !result_.goes_up) return true;
    return most <= share_at_strength + strength_tolerance;
  }

  /// True if one step along the tangent ends far from the strength that it aims at.
  [[nodiscard]] bool misses_by_far() const {
    if (step_.settles) return false;
    const double most = utilisation();
    if (result_.end == StrengthEnd::at_strength) return std::abs(most - 1.0) > largest_miss;
    return result_.goes_up && most > 1.0 + largest_miss;
  }

  [[nodiscard]] double utilisation() const {
    return largest_utilisation(problem_.assembler, current_.at(Damage::held), step_.borne);
  }

  /// Moves supports and loads to the stage, and evaluates the state.
  void stand() {
    const LoadPoint at = step_.point(result_.stage);
    problem_.conditions.prescribe(at, current_.displacement);
    problem_.conditions.external_force(at, external_force_);
    current_.environment = problem_.conditions.environment(at);
    evaluate(problem_, external_force_, current_, Damage::held);
    result_.newton.scale = scale();
  }

  [[nodiscard]] double scale() const {
    return std::max({step_.least_scale, old_scale_, present_load()});
  }
  [[nodiscard]] double present_load() const {
    return load_norm(problem_, external_force_, current_, Damage::held);
  }

  [[nodiscard]] bool is_balanced() {
    return note_convergence(problem_, tangent_.tangent(), current_, last_residual_,
                            options_.relative_tolerance, result_.newton);
  }

  [[nodiscard]] bool interrupts(IterationRecord row) const {
    row.residual = current_.residual_norm;
    row.relative_residual =
        result_.newton.scale > 0.0 ? current_.residual_norm / result_.newton.scale : 0.0;
    row.energy = current_.total_energy;
    return observer_ && observer_(row);
  }

  const EquilibriumProblem& problem_;
  UpdatedTangent& tangent_;
  const StrengthStep& step_;
  const NewtonOptions& options_;
  const IterationObserver& observer_;
  double start_;
  std::vector<double> external_force_;
  Trial current_;
  std::vector<double> rate_, eigenstretch_rate_;
  int rate_of_ = 0, refreshed_at_ = 0;  // number of refreshes of the tangent
  bool meets_upper_ = true;
  double last_residual_ = 0.0, old_scale_ = 0.0;
  StrengthResult result_;
};

}  // namespace

StrengthResult search_strength(const EquilibriumProblem& problem, UpdatedTangent& tangent,
                               const State& from, const StrengthStep& step,
                               const NewtonOptions& options, const IterationObserver& observer) {
  return StrengthSearch(problem, tangent, from, step, options, observer).run();
}

}  // namespace peristat
