#include "solvers/search/strength_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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

/// Utilisation after the first step from which a bond may be the most utilised one in the end; the
/// state that is found is checked with all bonds.
constexpr double watched = 0.8;

/// Relative residual of the systems for the rate: its error is one of the state.
constexpr double rate_tolerance = 1e-8;

/// Relative residual below which an empty range is not caused by the iteration.
constexpr double nearly = 1e-6;

/// Accuracy with which a corner is predicted, relative to the stage that it may take.
constexpr double corner_accuracy = 0.01;

/// An iteration that leaves more than this fraction of the residual needs a new tangent: with what
/// is known of earlier corrections a good one leaves a hundredth.
constexpr double slow = 0.05;

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
        from_(from),
        has_contacts_(problem.assembler.has_contacts()),
        start_(step.preloads ? from.preload : from.stage),
        longest_(step.longest),
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
    if (result_.newton.outcome == Outcome::converged &&
        problem_.assembler.has_passed(from_, current_.at(Damage::held))) {
      result_.newton.outcome = Outcome::degenerate;
    }
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
    if (Outcome found = linearise(iteration); found != Outcome::converged) return found;
    last_residual_ = current_.residual_norm;
    const std::vector<double> before = current_.displacement;
    // What a settled state lacks of equilibrium is far less than what the predictor adds.
    const bool is_settled = iteration == 1 && !step_.settles && is_nearly_balanced();
    const Outcome corrected = is_settled ? Outcome::converged : correct();
    if (corrected != Outcome::converged) return corrected;
    double change = 0.0;
    if (!step_.settles) {
      if (Outcome found = find_rate(); found != Outcome::converged) return found;
      change = choose(iteration == 1);
      if (result_.end == StrengthEnd::inadmissible && !is_fresh()) {
        // An old tangent does not predict the path well enough to give it up.
        result_.end = StrengthEnd::at_stop;
        if (Outcome found = refresh(); found != Outcome::converged) return found;
        if (Outcome found = find_rate(); found != Outcome::converged) return found;
        change = choose(iteration == 1);
      }
      if (result_.end == StrengthEnd::inadmissible) return Outcome::converged;
      if (iteration == 1 && ends_at_corner(change)) change = choose(true);
      for (const Index dof : problem_.free.dof) current_.displacement[dof] += change * rate_[dof];
      if (iteration == 1) predicted_ = change;
    }
    // The predictor foresees what closes; if not, its state is judged as it is.
    row.step_length = foreseen_.empty() ? shorten(before) : 1.0;
    is_whole_ = row.step_length == 1.0;
    foreseen_.clear();
    if (!step_.settles) {
      const bool stops = result_.end == StrengthEnd::at_stop && is_whole_;
      result_.stage = stops ? step_.stop : result_.stage + row.step_length * change;
    }
    stand();
    const bool predicts = iteration == 1 && !step_.settles;
    predicts ? correction_.clear() : learn();
    result_.newton.iterations = iteration;
    row.linear_iterations = tangent_.last_iterations();
    if (current_.degenerate) return Outcome::degenerate;
    if (iteration == 1 && misses_by_far()) return Outcome::iteration_limit;
    return interrupts(row) ? Outcome::interrupted : Outcome::converged;
  }

  /// Sees to it that the tangent is good enough for an iteration.
  Outcome linearise(int iteration) {
    if (iteration == 1 && !step_.settles && touches_at(0.0)) return foresee();
    const bool changes = touches();
    const bool is_old = !tangent_.is_there() || is_slow(iteration) || changes;
    return is_old ? refresh() : Outcome::converged;
  }

  Outcome refresh() {
    foreseen_.clear();
    return refresh_at(result_.stage);
  }

  Outcome refresh_at(double stage) {
    refreshed_at_ = tangent_.refreshed() + 1;
    correction_.clear();
    predicted_ = 0.0;
    const LoadPoint at = step_.point(stage);
    const SharedEnvironment environment =
        foreseen_.empty() ? current_.environment : foreseen_under_;
    return outcome_of(tangent_.refresh(
        {current_.displacement, at.stage, current_.history, at.load, environment, at.preload},
        foreseen_));
  }

  /// True if contacts press, now or where the tangent was made: their stiffness changes.
  [[nodiscard]] bool touches() const { return has_contacts_ && (tangent_.touches() || presses()); }

  /// True if contacts press in the present state.
  [[nodiscard]] bool presses() const {
    return !problem_.assembler.closed_contacts(current_.at(Damage::held)).empty();
  }

  /// Contacts that touch after a change of the stage along b.
  [[nodiscard]] std::vector<Index> closed_after(double change) const {
    std::vector<double> there = current_.displacement;
    if (change != 0.0) {
      add_scaled(there, change, rate_);
      move_followers(problem_, there);
    }
    StateView view(current_.displacement, current_.history, Damage::held,
                   problem_.conditions.environment(step_.point(result_.stage + change)));
    view.foreseen = there;
    return problem_.assembler.closed_contacts(view);
  }
  [[nodiscard]] bool touches_at(double change) const {
    return has_contacts_ && !closed_after(change).empty();
  }

  /// Makes the tangent of the predictor, in rounds until the contacts that it counts as springs are
  /// those that it closes first.
  Outcome foresee() {
    constexpr int most_rounds = 6;
    std::vector<Index> closed = closed_after(0.0);
    foreseen_ = current_.displacement;
    foreseen_under_ = current_.environment;
    foreseen_at_ = result_.stage;
    for (int round = 1;; ++round) {
      if (Outcome found = refresh_at(foreseen_at_); found != Outcome::converged) return found;
      if (Outcome found = find_rate(); found != Outcome::converged) return found;
      const double first = first_part_of(choose(true));
      if (result_.end == StrengthEnd::inadmissible || round == most_rounds) break;
      std::vector<Index> now = closed_after(first);
      const bool stays = now == closed;
      closed = std::move(now);
      if (stays) break;
      foreseen_ = current_.displacement;
      add_scaled(foreseen_, first, rate_);
      move_followers(problem_, foreseen_);
      foreseen_at_ = result_.stage + first;
      foreseen_under_ = problem_.conditions.environment(step_.point(foreseen_at_));
    }
    result_.end = StrengthEnd::at_stop;
    // Without springs the tangent is that of any state in which nothing touches.
    return closed.empty() ? refresh() : Outcome::converged;
  }

  [[nodiscard]] double first_part_of(double change) const {
    return std::copysign(std::min(std::abs(change), step_.corner), change);
  }

  /// Shortens the search so that it ends just behind the first corner that b predicts.
  bool ends_at_corner(double change) {
    if (!has_contacts_ || change == 0.0) return false;
    const double first = first_part_of(change);
    const std::vector<Index> closed = closed_after(first);
    if (closed_after(change) == closed) return false;
    constexpr int most_halvings = 60;
    double low = first, high = change;
    for (int k = 0; k < most_halvings && std::abs(high - low) > corner_accuracy * step_.corner;
         ++k) {
      const double middle = 0.5 * (low + high);
      (closed_after(middle) == closed ? low : high) = middle;
    }
    const double corner = std::abs(high) + step_.corner;
    if (corner >= std::min(longest_, std::abs(change))) return false;
    longest_ = corner;
    result_.turns_at_contact = true;
    return true;
  }

  /// Shortens the step of this iteration so that no contact gets too deep. Returns its share.
  double shorten(std::span<const double> before) {
    if (!has_contacts_) return 1.0;
    std::vector<double> step = current_.displacement;
    add_scaled(step, -1.0, before);
    const StateView at(before, current_.history, Damage::held, current_.environment);
    const double share = allowed_share(problem_, at, step);
    if (share < 1.0) {
      current_.displacement.assign(before.begin(), before.end());
      add_scaled(current_.displacement, share, step);
    }
    return share;
  }

  /// True if the tangent was refreshed by this search.
  [[nodiscard]] bool is_fresh() const { return refreshed_at_ == tangent_.refreshed(); }

  /// True if convergence is slow: the present tangent is too far from the state's.
  [[nodiscard]] bool is_slow(int iteration) const {
    return iteration > 2 && current_.residual_norm > slow * last_residual_ &&
           current_.residual_norm > options_.relative_tolerance * scale();
  }

  /// Moves to u + a.
  Outcome correct() {
    if (current_.residual_norm <= options_.relative_tolerance * scale()) return Outcome::converged;
    corrected_ = residual();
    // A tangent of another state leaves more than this, however accurate its solutions are.
    const double tolerance = options_.linear_tolerance;
    const LinearOutcome linear = tangent_.solve(corrected_, tolerance, correction_);
    if (linear != LinearOutcome::solved) return outcome_of(linear);
    correct_rate();
    add_scaled(current_.displacement, 1.0, correction_);
    move_followers(problem_, current_);
    return Outcome::converged;
  }

  [[nodiscard]] std::vector<double> residual() const {
    std::vector<double> residual(external_force_.size());
    for (const Index dof : problem_.free.dof) {
      residual[dof] = external_force_[dof] - current_.gradient[dof];
    }
    return residual;
  }

  /// Learns from the last correction.
  void learn() {
    if (correction_.empty() || touches()) return;
    std::vector<double> change = residual();
    add_scaled(change, -1.0, corrected_);
    tangent_.learn(correction_, change);
    correction_.clear();
  }

  /// The step along b was wrong by the first correction after it.
  void correct_rate() {
    if (predicted_ == 0.0 || touches()) return;
    add_scaled(rate_, 1.0 / std::exchange(predicted_, 0.0), correction_);
  }

  /// Finds b and the rates of the eigenstretches, anew if the tangent is or if there is an
  /// environment. Contacts that are foreseen are those at the stage that they are foreseen at.
  Outcome find_rate() {
    const bool is_known = rate_of_ == tangent_.refreshed() && !current_.environment;
    if (is_known && !rate_.empty()) return Outcome::converged;
    StateView at = current_.at(Damage::held);
    at.foreseen = foreseen_;
    ConditionRates conditions = rates_of(
        problem_, at, [this](double stage) { return step_.point(stage); },
        foreseen_.empty() ? result_.stage : foreseen_at_, step_.range);
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
                         eigenstretch_rate_, share_at_strength, watched_);
    if (is_first) {
      if (range.low > range.high) return refuse();
      result_.goes_up = range.high >= 0.0;
      meets_upper_ = range.low <= 0.0 || range.high < 0.0;
    }
    if (!is_first && is_nearly_balanced() && range.low > range.high) return refuse();
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
    const double end = start_ + (result_.goes_up ? longest_ : -longest_);
    const bool is_long = std::abs(result_.stage + change - start_) > longest_;
    if (is_long) {
      result_.end = StrengthEnd::on_the_way;
      change = end - result_.stage;
    }
    return change;
  }

  [[nodiscard]] bool is_nearly_balanced() const { return last_residual_ <= nearly * scale(); }

  double refuse() {
    result_.end = StrengthEnd::inadmissible;
    return 0.0;
  }

  /// True if the state is the end that the search aims at; called in equilibrium.
  bool ends_well() {
    if (step_.settles) return true;
    if (!is_whole_) return false;
    std::vector<UtilisedBond>& found = result_.utilised;
    found =
        utilised_bonds(problem_.assembler, current_.at(Damage::held), step_.borne, step_.listed);
    const double most = found.empty() ? 0.0 : found.front().utilisation;
    watched_.clear();  // if another bond is the most utilised one, all are looked at again
    if (result_.end == StrengthEnd::at_strength) {
      return std::abs(most - share_at_strength) <= strength_tolerance;
    }
    // Bonds that are overloaded are so until the strength is met.
    if (result_.end == StrengthEnd::on_the_way && is_overloaded()) return true;
    return most <= share_at_strength + strength_tolerance;
  }

  /// True if one step along the tangent ends far from the strength that it aims at.
  [[nodiscard]] bool misses_by_far() {
    if (step_.settles) return false;
    watched_ = utilised_bonds(problem_.assembler, current_.at(Damage::held), step_.borne, watched);
    const double most = watched_.empty() ? 0.0 : watched_.front().utilisation;
    if (result_.end == StrengthEnd::at_strength) return std::abs(most - 1.0) > largest_miss;
    return !is_overloaded() && most > 1.0 + largest_miss;
  }

  /// True if bonds are overloaded where the search begins.
  [[nodiscard]] bool is_overloaded() const { return !result_.goes_up || !meets_upper_; }

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
  const State& from_;
  bool has_contacts_;
  double start_, longest_;
  std::vector<double> external_force_;
  Trial current_;
  std::vector<double> foreseen_;      // displacement behind the predictor; empty: none
  SharedEnvironment foreseen_under_;  // likewise
  double foreseen_at_ = 0.0;          // its stage
  bool is_whole_ = true;              // the last step was not shortened
  std::vector<double> rate_, eigenstretch_rate_;
  std::vector<UtilisedBond> watched_;           // that may be the next; empty: all
  std::vector<double> correction_, corrected_;  // the last one, and the residual before it
  double predicted_ = 0.0;                      // change along b, until b is corrected
  int rate_of_ = 0, refreshed_at_ = 0;          // number of refreshes of the tangent
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
