#include "solvers/study/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/problem/working_force.hpp"
#include "solvers/search/condition_rates.hpp"
#include "solvers/search/linearisation.hpp"
#include "src/core/input_error.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

constexpr int most_corrections = 50;
/// Relative change of w that ends the corrections; and that is enough if they do not come closer,
/// because of round-off.
constexpr double wanted = 1e-8, enough = 1e-6;
constexpr double linear_tolerance = 1e-4;

double norm_of_free(const FreeDofs& free, std::span<const double> of) {
  return norm_of(free.dof.size(), [&](std::size_t e) { return of[std::size_t(free.dof[e])]; });
}

/// True if the histories of the neighbours lie about that of the solved body. Where they do not,
/// other bonds have been damaged, or in another order.
bool lie_about(const History& solved, const History& less, const History& more) {
  constexpr double most_apart = 4.0;  // of the mean from the solved one, in half differences
  constexpr double tolerance_of_search = 1e-8, most_change = 1e-3;  // of the largest entry
  for (std::size_t term = 0; term < solved.terms(); ++term) {
    const auto main = solved.of(term), low = less.of(term), high = more.of(term);
    double largest = 0.0, half = 0.0, apart = 0.0;
    for (std::size_t k = 0; k < main.size(); ++k) {
      largest = std::max(largest, std::abs(main[k]));
      half = std::max(half, 0.5 * std::abs(high[k] - low[k]));
      apart = std::max(apart, std::abs(0.5 * (high[k] + low[k]) - main[k]));
    }
    if (half > most_change * largest || apart > most_apart * half + tolerance_of_search * largest) {
      return false;
    }
  }
  return true;
}

const std::string other_damage = "other bonds would be damaged if the parameter were any different";

}  // namespace

std::optional<LoadAnswer> load_answer(const SolvedBody& solved, const Conditions& conditions,
                                      const UncommittedState& at) {
  const EquilibriumProblem problem{solved.assembler, conditions, solved.free};
  const auto loads = [&](double load) { return LoadPoint(at.at.stage, load); };
  const ConditionRates rates = rates_of(problem, at.trial.at(), loads, *at.at.load);
  LoadAnswer answer;
  Linearisation linearisation(problem, solved.solver, solved.tangent, at.external_force);
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
    : relative_change_(relative_change), of_{Neighbour(less, threads), Neighbour(more, threads)} {
  for (std::size_t side = 0; side < 2; ++side) {
    const Neighbour& neighbour = of_[side];
    if (neighbour.body.points.reference != solved.points().reference ||
        !(neighbour.assembler.pattern() == solved.pattern())) {
      throw InputError("", "", "moves points or changes which of them have bonds");
    }
    if (neighbour.body.conditions->prescribed() != conditions.prescribed()) {
      throw InputError("", "", "changes which displacements are prescribed");
    }
    accepted_[side].state.history = neighbour.state.history;
  }
  accepted_change_.displacement.assign(conditions.prescribed().size(), 0.0);
}

void Neighbours::begin() {
  for (std::size_t side = 0; side < 2; ++side) {
    of_[side].state = accepted_[side].state;
    intact_[side].reset();
  }
  change_ = accepted_change_;
}

std::string Neighbours::follow(const SolvedBody& solved, const UncommittedState& to,
                               const LoadAnswer* answer) {
  if (!lie_about(to.trial.history, less().state.history, more().state.history)) {
    return other_damage;
  }
  return equilibrate(solved, to, answer) ? "" : "no equilibria have been found beside the state";
}

void Neighbours::commit() {
  for (std::size_t side = 0; side < 2; ++side) {
    Neighbour& of = of_[side];
    if (!intact_[side]) intact_[side] = worked(of);
    const Evaluation committed =
        of.assembler.commit(of.state.displacement, of.state.history, {}, of.state.environment);
    of.state.stored_energy = committed.energy;
  }
}

std::string Neighbours::accept(const History& history, bool is_preload) {
  if (!lie_about(history, less().state.history, more().state.history)) return other_damage;
  for (std::size_t side = 0; side < 2; ++side) {
    Neighbour& of = of_[side];
    Worked now = worked(of);
    // As the ledger of the path sums it.
    const bool by_way_of_intact = intact_[side] && of.body.model.fails_in_avalanches();
    if (is_preload) {
      of.external_work = of.state.stored_energy;
    } else if (by_way_of_intact) {
      of.external_work +=
          work_between(of, accepted_[side], *intact_[side]) + work_between(of, *intact_[side], now);
    } else {
      of.external_work += work_between(of, accepted_[side], now);
    }
    accepted_[side] = std::move(now);
  }
  accepted_change_ = change_;
  if (is_preload && less().body.conditions->control()) held_ = -control_gap(0.0);
  return {};
}

void Neighbours::place(const FreeDofs& free, const UncommittedState& to) {
  for (std::size_t side = 0; side < 2; ++side) {
    Neighbour& of = of_[side];
    const double sign = side == 0 ? -1.0 : 1.0;
    const Conditions& conditions = *of.body.conditions;
    of.at = to.at;
    if (of.at.load) *of.at.load += sign * change_.load;
    of.state.displacement = to.trial.displacement;
    add_scaled(of.state.displacement, sign, change_.displacement);
    conditions.prescribe(of.at, of.state.displacement);
    conditions.external_force(of.at, of.external_force);
    const EquilibriumProblem problem{of.assembler, conditions, free};
    of.state.environment = problem.environment(of.at);
    evaluate(problem, of.external_force, of.state);
  }
}

bool Neighbours::equilibrate(const SolvedBody& solved, const UncommittedState& to,
                             const LoadAnswer* answer) {
  const FreeDofs& free = solved.free;
  const EquilibriumProblem problem{solved.assembler, *less().body.conditions, free};
  Linearisation linearisation(problem, solved.solver, solved.tangent, to.external_force);
  std::vector<double> force(change_.displacement.size()), step;
  double size = std::numeric_limits<double>::infinity(), residual = 0.0;
  for (int k = 0; k < most_corrections; ++k) {
    place(free, to);
    if (less().state.degenerate || more().state.degenerate) return false;
    const double last_size = size, last_residual = residual;
    find_half_residual(force);
    residual = norm_of_free(free, force);
    const double gap = answer ? control_gap(to.at.stage) : 0.0;
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
      change_.load += change;
    }
    add_scaled(change_.displacement, 1.0, step);
    // A change far below that of a displacement proportional to the parameter is round-off.
    const double scale = std::max(norm_of_free(free, change_.displacement),
                                  relative_change_ * norm_of_free(free, less().state.displacement));
    size = scale > 0.0 ? norm_of_free(free, step) / scale : 0.0;
    if (!std::isfinite(size)) return false;
    if (size <= wanted || (size <= enough && size > 0.3 * last_size)) {
      place(free, to);
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

double Neighbours::control_gap(double stage) const {
  const auto excess = [&](const Neighbour& of) {
    const Conditions& conditions = *of.body.conditions;
    return conditions.programme().at(stage).front() -
           conditions.control()->value(of.state.displacement);
  };
  return held_ + 0.5 * (excess(of_[1]) - excess(of_[0]));
}

Neighbours::Worked Neighbours::worked(const Neighbour& of) const {
  return {of.state, working_force(*of.body.conditions, of.state, of.external_force)};
}

double Neighbours::work_between(Neighbour& of, const Worked& from, const Worked& to) const {
  const Sums sums(of.assembler.index_map(), of.assembler.points().dimension);
  return heating_work(of.assembler, from.state.at(), to.state.at()) +
         trapezoidal_work(sums, from.force, to.force, from.state.displacement,
                          to.state.displacement);
}

}  // namespace peristat
