#include "solvers/study/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/problem/working_force.hpp"
#include "solvers/search/condition_rates.hpp"
#include "solvers/search/linearisation.hpp"
#include "src/core/input_error.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

constexpr int most_corrections = 50;
/// Relative change of w that ends the iterations; and that is enough if they do not come closer,
/// because of round-off.
constexpr double wanted = 1e-8, enough = 1e-6;
constexpr double linear_tolerance = 1e-4;

/// Largest difference between the solved body's history and the mean of the neighbours', relative
/// to half their difference: more means that other bonds have been damaged, or in another order.
constexpr double most_apart = 4.0;

double norm_of_free(const FreeDofs& free, std::span<const double> of) {
  double sum = 0.0;
  for (const Index dof : free.dof) sum += of[std::size_t(dof)] * of[std::size_t(dof)];
  return std::sqrt(sum);
}

/// True if the histories of the neighbours lie about that of the solved body.
bool lies_between(const History& solved, const History& less, const History& more) {
  for (std::size_t term = 0; term < solved.terms(); ++term) {
    const auto main = solved.of(term), low = less.of(term), high = more.of(term);
    double largest = 0.0, half = 0.0, apart = 0.0;
    for (std::size_t k = 0; k < main.size(); ++k) {
      largest = std::max(largest, std::abs(main[k]));
      half = std::max(half, 0.5 * std::abs(high[k] - low[k]));
      apart = std::max(apart, std::abs(0.5 * (high[k] + low[k]) - main[k]));
    }
    constexpr double tolerance_of_search = 1e-8;
    if (half > 1e-3 * largest || apart > most_apart * half + tolerance_of_search * largest) {
      return false;
    }
  }
  return true;
}

LoadPoint load_point_of(const StepRecord& record, bool is_found, double change) {
  if (!is_found) return {record.stage};
  return {record.stage, record.load_factor + change};
}

}  // namespace

std::optional<LoadAnswer> load_answer(const SolvedBody& solved, const Conditions& conditions,
                                      const StepRecord& record, const AcceptedState& accepted) {
  const EquilibriumProblem problem{solved.assembler, conditions, solved.free};
  const auto loads = [&](double load) { return LoadPoint(record.stage, load); };
  const ConditionRates rates = rates_of(problem, accepted.trial.at(), loads, record.load_factor);
  LoadAnswer answer;
  Linearisation linearisation(problem, solved.solver, solved.tangent, accepted.external_force);
  if (linearisation.solve_again(rates.force, rates.displacement, linear_tolerance, answer.rate) !=
      LinearOutcome::solved) {
    return std::nullopt;
  }
  add_scaled(answer.rate, 1.0, rates.displacement);
  answer.control = conditions.control()->value(answer.rate);
  return answer;
}

Neighbours::Neighbour::Neighbour(const Body& of, int threads)
    : body(of),
      assembler(of.points, of.model, threads),
      external_force(of.conditions->prescribed().size()) {
  state.history = assembler.initial_history();
}

Neighbours::Neighbours(const Body& less, const Body& more, const Assembler& solved,
                       const Conditions& conditions, double relative_change, int threads)
    : relative_change_(relative_change),
      of_{Neighbour(less, threads), Neighbour(more, threads)},
      change_(conditions.prescribed().size(), 0.0) {
  for (const Neighbour& neighbour : of_) {
    if (neighbour.body.points.reference != solved.points().reference ||
        !(neighbour.assembler.pattern() == solved.pattern())) {
      throw InputError("", "", "moves points or changes which of them have bonds");
    }
    if (neighbour.body.conditions->prescribed() != conditions.prescribed()) {
      throw InputError("", "", "changes which displacements are prescribed");
    }
  }
}

std::string Neighbours::follow(const SolvedBody& solved, const StepRecord& record,
                               const AcceptedState& accepted, const LoadAnswer* answer) {
  const std::array<Trial, 2> before{less().state, more().state};
  if (!equilibrate(solved, record, accepted, answer)) {
    return "no equilibria have been found beside the state; the step may have damaged bonds one "
           "after another at one load";
  }
  if (record.step == 0 && less().body.conditions->control()) held_ = -control_gap(record);
  for (std::size_t side = 0; side < 2; ++side) add_work(of_[side], record, before[side]);
  if (!solved.assembler.model().has_history()) return {};
  for (Neighbour& of : of_) {
    const Evaluation committed =
        of.assembler.commit(of.state.displacement, of.state.history, {}, of.state.environment);
    of.state.stored_energy = committed.energy;
  }
  if (!lies_between(accepted.trial.history, less().state.history, more().state.history)) {
    return "the step has damaged bonds one after another at one load, or would damage others if "
           "the parameter were any different";
  }
  return {};
}

void Neighbours::place(const FreeDofs& free, const StepRecord& record,
                       std::span<const double> displacement) {
  for (std::size_t side = 0; side < 2; ++side) {
    Neighbour& of = of_[side];
    const double sign = side == 0 ? -1.0 : 1.0;
    const Conditions& conditions = *of.body.conditions;
    of.at = load_point_of(record, conditions.control() != nullptr, sign * load_change_);
    of.state.displacement.assign(displacement.begin(), displacement.end());
    add_scaled(of.state.displacement, sign, change_);
    conditions.prescribe(of.at, of.state.displacement);
    conditions.external_force(of.at, of.external_force);
    const EquilibriumProblem problem{of.assembler, conditions, free};
    of.state.environment = problem.environment(of.at);
    evaluate(problem, of.external_force, of.state);
  }
}

bool Neighbours::equilibrate(const SolvedBody& solved, const StepRecord& record,
                             const AcceptedState& accepted, const LoadAnswer* answer) {
  const FreeDofs& free = solved.free;
  const EquilibriumProblem problem{solved.assembler, *less().body.conditions, free};
  Linearisation linearisation(problem, solved.solver, solved.tangent, accepted.external_force);
  std::vector<double> force(change_.size()), step;
  double size = std::numeric_limits<double>::infinity(), residual = 0.0;
  for (int k = 0; k < most_corrections; ++k, ++corrections_) {
    place(free, record, accepted.trial.displacement);
    if (less().state.degenerate || more().state.degenerate) return false;
    const double last_size = size, last_residual = residual;
    find_half_residual(force);
    residual = norm_of_free(free, force);
    const double gap = answer ? control_gap(record) : 0.0;
    if (residual == 0.0 && gap == 0.0) return true;
    // The next correction would be smaller than the last one as the residual is.
    if (k > 0 && size * residual <= wanted * last_residual) return true;
    if (linearisation.solve_again(force, {}, linear_tolerance, step) != LinearOutcome::solved) {
      return false;
    }
    if (answer) {
      const double change =
          (gap - less().body.conditions->control()->value(step)) / answer->control;
      add_scaled(step, change, answer->rate);
      load_change_ += change;
    }
    add_scaled(change_, 1.0, step);
    // A change far below that of a displacement proportional to the parameter is round-off.
    const double scale = std::max(norm_of_free(free, change_),
                                  relative_change_ * norm_of_free(free, less().state.displacement));
    size = scale > 0.0 ? norm_of_free(free, step) / scale : 0.0;
    if (!std::isfinite(size)) return false;
    if (size <= wanted || (size <= enough && size > 0.3 * last_size)) {
      place(free, record, accepted.trial.displacement);
      return true;
    }
  }
  return false;
}

void Neighbours::find_half_residual(std::span<double> force) {
  for (std::size_t dof = 0; dof < force.size(); ++dof) {
    force[dof] = 0.5 * (more().external_force[dof] - more().state.gradient[dof] -
                        less().external_force[dof] + less().state.gradient[dof]);
  }
}

double Neighbours::control_gap(const StepRecord& record) const {
  const auto excess = [&](const Neighbour& of) {
    const Conditions& conditions = *of.body.conditions;
    return conditions.programme().at(record.stage).front() -
           conditions.control()->value(of.state.displacement);
  };
  return held_ + 0.5 * (excess(of_[1]) - excess(of_[0]));
}

void Neighbours::add_work(Neighbour& of, const StepRecord& record, const Trial& before) const {
  std::vector<double> force = working_force(*of.body.conditions, of.state, of.external_force);
  if (record.step == 0) {
    of.external_work = of.state.stored_energy;
  } else {
    const Sums sums(of.assembler.index_map(), of.assembler.points().dimension);
    of.external_work +=
        heating_work(of.assembler, before.at(), of.state.at()) +
        trapezoidal_work(sums, of.working_force, force, before.displacement, of.state.displacement);
  }
  of.working_force = std::move(force);
}

}  // namespace peristat
