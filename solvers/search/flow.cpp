#include "solvers/search/flow.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "solvers/problem/working_force.hpp"
#include "solvers/search/linearisation.hpp"
#include "solvers/search/way_of_load.hpp"
#include "src/core/vector_verbs.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// Relative residual of the linear systems: far below the error that a step may have.
constexpr double linear_tolerance = 1e-6;

/// Shortest step: a bond that snaps changes the direction at once, however short the step.
constexpr double shortest_step = 1.0 / 32.0;

/// Longest step: Newton's method finishes the softest motion.
constexpr double longest_step = 256.0;

/// Fraction of the predicted decrease of the energy that is required, as in line_search.
constexpr double sufficient_decrease = 1e-4;

/// A predictor of the load is too long if the direction after it is more than this fraction of it.
constexpr double largest_correction = 0.5;
constexpr double smallest_share = 1.0 / 64.0;

/// Relative size of the imperfection of every direction. It decides which way a symmetric state
/// moves that is unstable against an unsymmetric motion; round-off would not always decide in the
/// same way. It is far above any round-off and far below the path's tolerance.
constexpr double imperfection = 1e-6;

/// A number from -1 to 1 for every degree of freedom of the whole body, the same in every run.
double imperfection_of(GlobalIndex dof) {
  auto bits = std::uint64_t(dof) * 0x9e3779b97f4a7c15u;
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
  return 2.0 * double(bits >> 11) * 0x1p-53 - 1.0;
}

/// Coefficient c of the error that the exponential rule neglects, see flow.hpp.
double neglected_share(double theta) {
  if (theta >= 1.0) return 1.0;
  const double h = -std::log1p(-theta);
  return (h - theta) / h;
}

/// Theta of a time step that is longer by a factor.
double lengthened(double theta, double factor) {
  constexpr double as_good_as_one = 0.999;
  if (theta > 1.0) return theta * factor;
  if (theta == 1.0) return factor > 1.0 ? factor : 0.8;
  const double longer = -std::expm1(factor * std::log1p(-theta));
  return longer > as_good_as_one ? 1.0 : longer;
}

class Flow {
 public:
  Flow(const EquilibriumProblem& problem, LinearSolver& solver, TangentOperator& tangent,
       const State& from, const LoadPoint& to, const RelaxationOptions& options,
       const RelaxationObserver& observer)
      : problem_(problem),
        solver_(solver),
        options_(options),
        observer_(observer),
        sums_(problem.sums()),
        points_of_body_(GlobalIndex(sums_.of_all(double(own_points())))),
        way_(problem, from, to),
        force_(from.displacement.size()),
        linearisation_(problem, solver, tangent, force_) {
    way_.load(0.0, force_);
    current_.displacement = from.displacement;
    current_.history = from.history;
    current_.environment = from.environment;
    evaluate(problem, force_, current_);
    result_.scale =
        options.scale > 0.0 ? options.scale : relaxation_scale(problem, current_, to, true);
    result_.largest_residual = options.relative_tolerance * result_.scale;
    share_ = to == load_point(from) ? 1.0 : 0.0;
    way_.load(share_, force_);
  }

  [[nodiscard]] RelaxationResult run() {
    const double before = taken_up(problem_, options_.breaking, current_);
    result_.outcome = search();
    result_.drained_energy = result_.external_work - result_.released_energy -
                             (taken_up(problem_, options_.breaking, current_) - before);
    current_.total_energy = current_.stored_energy - sums_.dot(force_, current_.displacement);
    result_.state = std::move(current_);
    result_.external_force = std::move(force_);
    return std::move(result_);
  }

 private:
  Outcome search() {
    if (share_ == 1.0) {
      if (is_in_equilibrium()) return Outcome::converged;
      const Outcome outcome = find_metric();
      if (outcome != Outcome::converged) return outcome;
    }
    while (share_ < 1.0) {
      const Outcome outcome = follow_load();
      if (outcome != Outcome::converged) return outcome;
      if (tells(1.0)) return Outcome::interrupted;
    }
    while (!is_in_equilibrium()) {
      if (result_.iterations >= options_.max_iterations) return Outcome::iteration_limit;
      const Outcome outcome = advance();
      if (outcome != Outcome::converged) return outcome;
    }
    return Outcome::converged;
  }

  [[nodiscard]] bool is_in_equilibrium() const {
    return current_.residual_norm <= result_.largest_residual;
  }

  [[nodiscard]] Outcome find_metric() {
    ++result_.iterations;
    return outcome_of(linearisation_.solve(current_.at(Damage::held), current_.gradient, 1.0,
                                           FactorUse::factorize_now, {}, linear_tolerance,
                                           direction_));
  }

  [[nodiscard]] Outcome find_direction(const Trial& at, std::vector<double>& direction) {
    ++result_.iterations;
    const LinearOutcome linear =
        linearisation_.solve_again(residual_of(at), {}, linear_tolerance, direction);
    for (const Index dof : problem_.free.dof) {
      direction[dof] *= 1.0 + imperfection * imperfection_of(dof_of_body(dof));
    }
    return outcome_of(linear);
  }

  /// Number of points that this rank owns, without images.
  [[nodiscard]] Index own_points() const {
    const Points& points = problem_.assembler.points();
    return points.owned.value_or(points.own());
  }

  /// Number in the whole body of a degree of freedom of this rank: those of points come first, then
  /// those of handles (generalised degrees of freedom).
  [[nodiscard]] GlobalIndex dof_of_body(Index dof) const {
    const IndexMap& index_map = problem_.assembler.index_map();
    const Points& points = problem_.assembler.points();
    const Index d = points.dimension, point = dof / d;
    if (point >= points.count()) return (points_of_body_ + point - points.count()) * d + dof % d;
    return index_map.number_of(point) * d + dof % d;
  }

  /// Residual, zero on degrees of freedom that are not free.
  [[nodiscard]] std::vector<double> residual_of(const Trial& at) const {
    std::vector<double> residual(force_.size());
    for (const Index dof : problem_.free.dof) residual[dof] = force_[dof] - at.gradient[dof];
    return residual;
  }

  /// Moves supports and loads by the remaining fraction, or by as much of it as the body can
  /// follow.
  Outcome follow_load() {
    const std::vector<double> before = working_force(problem_.conditions, current_, force_);
    for (double part = (1.0 - share_);; part *= 0.5) {
      const double share = std::min(share_ + part, 1.0);
      const Outcome outcome = predict(share);
      if (outcome != Outcome::converged) return outcome;
      const bool can_shorten = part > smallest_share;
      if (next_.degenerate) {
        if (can_shorten) continue;
        return Outcome::degenerate;
      }
      std::vector<double> move = next_.displacement;
      add_scaled(move, -1.0, current_.displacement);
      const Outcome found = find_direction(next_, next_direction_);
      if (found != Outcome::converged) return found;
      if (can_shorten && sums_.norm(next_direction_) > largest_correction * sums_.norm(move))
        continue;
      share_ = share;
      result_.external_work +=
          heating_work(problem_.assembler, current_.at(Damage::held), next_.at(Damage::held));
      return accept(before);
    }
  }

  /// Moves to a fraction of the load's path by the tangent K0, which is factorised the first time.
  Outcome predict(double share) {
    way_.load(share, force_);
    Trial start = current_;
    start.environment = way_.environment(share);
    if (start.environment) evaluate(problem_, force_, start);
    next_.displacement = current_.displacement;
    for (const Index dof : way_.prescribed()) {
      next_.displacement[dof] = way_.displacement(dof, share);
    }
    share_out_jump(problem_, current_.displacement, next_.displacement);
    std::vector<double> step;
    ++result_.iterations;
    LinearOutcome linear;
    if (!has_metric_) {
      linear = linearisation_.solve(start.at(Damage::held), start.gradient, 1.0,
                                    FactorUse::factorize_now, next_.displacement, linear_tolerance,
                                    step);
      has_metric_ = linear == LinearOutcome::solved;
    } else {
      std::vector<double> jump = next_.displacement;
      add_scaled(jump, -1.0, current_.displacement);
      linear = linearisation_.solve_again(residual_of(start), jump, linear_tolerance, step);
    }
    if (linear != LinearOutcome::solved) return outcome_of(linear);
    add_scaled(next_.displacement, 1.0, step);
    next_.history = current_.history;
    next_.environment = start.environment;
    evaluate(problem_, force_, next_);
    return Outcome::converged;
  }

  /// Takes a step of the flow under constant loads.
  Outcome advance() {
    const std::vector<double> force = residual_of(current_);
    const double decay = sums_.dot(direction_, force);  // |d|^2 in the norm of K0
    if (!(decay > 0.0)) return Outcome::no_descent;
    const std::vector<double> working = working_force(problem_.conditions, current_, force_);
    const double round_off = 64.0 * std::numeric_limits<double>::epsilon() *
                                 std::max(std::abs(current_.stored_energy),
                                          std::abs(sums_.dot(force_, current_.displacement))) +
                             current_.energy_round_off;
    if (has_stalled(decay <= round_off)) return Outcome::iteration_limit;
    int rejected = 0;
    for (;;) {
      if (result_.iterations >= options_.max_iterations) return Outcome::iteration_limit;
      attempt(theta_);
      const double along = sums_.dot(direction_, residual_of(next_));
      const double gain =
          next_.stored_energy - current_.stored_energy -
          trapezoidal_work(sums_, working, working_force(problem_.conditions, next_, force_),
                           current_.displacement, next_.displacement);
      const bool falls = gain <= -sufficient_decrease * theta_ * decay ||
                         (std::abs(gain) <= round_off && std::abs(along) <= decay);
      const bool has_turned = theta_ > 1.0 && along < 0.0;
      if (next_.degenerate || !falls || has_turned) {
        if (++rejected > most_rejections) return Outcome::line_search_failed;
        theta_ = theta_ > 1.0 ? std::max(1.0, 0.5 * theta_) : 0.5 * theta_;
        continue;
      }
      const Outcome found = find_direction(next_, next_direction_);
      if (found != Outcome::converged) return found;
      const double across2 = sums_.dot(next_direction_, residual_of(next_)) - along * along / decay;
      const double error =
          neglected_share(theta_) * std::sqrt(std::max(across2, 0.0) / decay) / theta_;
      const double taken = theta_;
      const double factor =
          std::clamp(0.9 * options_.flow_tolerance / std::max(error, 1e-12), 0.25, 2.0);
      const bool is_good = error <= options_.flow_tolerance || theta_ <= shortest_step;
      const double rate = std::abs(1.0 - along / decay) / theta_;
      theta_ = std::max(lengthened(theta_, factor), shortest_step);
      theta_ = std::min({theta_, std::max(1.0, 0.5 / rate), longest_step});
      if (!is_good) {
        ++rejected;
        continue;
      }
      const Outcome outcome = accept(working);
      if (outcome != Outcome::converged) return outcome;
      return tells(taken, rejected) ? Outcome::interrupted : Outcome::converged;
    }
  }

  /// True if round-off leaves nothing to gain: many steps have not lowered the residual.
  [[nodiscard]] bool has_stalled(bool energy_is_round_off) {
    if (current_.residual_norm < least_residual_ || !energy_is_round_off) {
      least_residual_ = current_.residual_norm;
      steps_since_ = 0;
    }
    return ++steps_since_ > most_steps_without_gain;
  }

  void attempt(double theta) {
    next_.displacement = current_.displacement;
    add_scaled(next_.displacement, theta, direction_);
    next_.history = current_.history;
    next_.environment = current_.environment;
    evaluate(problem_, force_, next_);
  }

  /// Accepts the next state with its direction.
  /// @param working force in the state before
  Outcome accept(std::span<const double> working) {
    result_.external_work +=
        trapezoidal_work(sums_, working, working_force(problem_.conditions, next_, force_),
                         current_.displacement, next_.displacement);
    std::swap(current_, next_);
    std::swap(direction_, next_direction_);
    if (options_.breaking == Breaking::at_equilibrium) return Outcome::converged;
    const Evaluation found = problem_.assembler.commit(current_.displacement, current_.history, {},
                                                       current_.environment);
    result_.growth += found.growth;
    result_.released_energy += found.released;
    current_.stored_energy = found.energy;
    current_.energy_round_off = found.round_off;
    if (!found.moves_equilibrium) return Outcome::converged;
    evaluate(problem_, force_, current_);
    return find_direction(current_, direction_);
  }

  [[nodiscard]] bool tells(double step_length, int rejected = 0) const {
    IterationRecord row;
    row.iteration = result_.iterations;
    row.residual = current_.residual_norm;
    row.relative_residual = result_.scale > 0.0 ? row.residual / result_.scale : 0.0;
    row.energy = current_.stored_energy - sums_.dot(force_, current_.displacement);
    row.step_length = step_length;
    row.linear_iterations = solver_.last_iterations();
    row.linear_tolerance = row.linear_iterations > 0 ? linear_tolerance : 0.0;
    row.changed_bonds = result_.growth.degrading;
    row.projection = 1.0;
    row.rejected_trials = rejected;
    return observer_ && observer_(row);
  }

  static constexpr int most_rejections = 40, most_steps_without_gain = 50;

  const EquilibriumProblem& problem_;
  LinearSolver& solver_;
  const RelaxationOptions& options_;
  const RelaxationObserver& observer_;
  const Sums sums_;
  const GlobalIndex points_of_body_;
  WayOfLoad way_;
  double share_ = 0.0;  // of the path of supports and loads
  std::vector<double> force_;
  Linearisation linearisation_;
  bool has_metric_ = false;
  Trial current_, next_;
  std::vector<double> direction_, next_direction_;
  double theta_ = 1.0;
  double least_residual_ = std::numeric_limits<double>::infinity();
  int steps_since_ = 0;  // since the least residual
  RelaxationResult result_;
};

}  // namespace

RelaxationResult flow(const EquilibriumProblem& problem, LinearSolver& solver,
                      TangentOperator& tangent, const State& from, const LoadPoint& to,
                      const RelaxationOptions& options, const RelaxationObserver& observer) {
  return Flow(problem, solver, tangent, from, to, options, observer).run();
}

}  // namespace peristat
