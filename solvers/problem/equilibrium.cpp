#include "solvers/problem/equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "src/core/vector_verbs.hpp"

namespace peristat {

std::string name(Outcome outcome) {
  switch (outcome) {
    case Outcome::converged:
      return "converged";
    case Outcome::iteration_limit:
      return "iteration_limit";
    case Outcome::not_positive_definite:
      return "not_positive_definite";
    case Outcome::singular_tangent:
      return "singular_tangent";
    case Outcome::no_descent:
      return "no_descent";
    case Outcome::line_search_failed:
      return "line_search_failed";
    case Outcome::degenerate:
      return "degenerate";
    case Outcome::out_of_memory:
      return "out_of_memory";
    case Outcome::linear_solver_inaccurate:
      return "linear_solver_inaccurate";
    case Outcome::limit_point:
      return "limit_point";
    case Outcome::damage_limit:
      return "damage_limit";
    case Outcome::fragmented:
      return "fragmented";
    case Outcome::undefined_condition:
      return "undefined_condition";
    case Outcome::no_answer:
      return "no_answer";
    case Outcome::sharp_turn:
      return "sharp_turn";
    case Outcome::step_limit:
      return "step_limit";
    case Outcome::damage_begins:
      return "damage_begins";
    case Outcome::inconsistent:
      return "inconsistent";
    case Outcome::unstable_step:
      return "unstable_step";
    case Outcome::interrupted:
      return "interrupted";
  }
  return "";
}

std::string explanation(Outcome outcome) {
  switch (outcome) {
    case Outcome::converged:
      return "equilibrium found";
    case Outcome::iteration_limit:
      return "the residual is still above the tolerance after the largest number of iterations "
             "(solver.max_iterations, relaxation.max_iterations)";
    case Outcome::not_positive_definite:
      return "the tangent has negative pivots: the body buckles, or has passed another limit point";
    case Outcome::singular_tangent:
      return "the tangent is singular: some points can move without resistance (too few bonds, "
             "bonds in one line only, or too few supports)";
    case Outcome::no_descent:
      return "the Newton direction does not lower the energy";
    case Outcome::line_search_failed:
      return "no step along the Newton direction lowers the energy";
    case Outcome::degenerate:
      return "bonds collapse to zero length, points go too deep into what they touch or through "
             "it, or near to images or points of other ranks that are not modelled (reach of a "
             "contact), no place of an obstacle bears its force, or values are not finite";
    case Outcome::out_of_memory:
      return "the factorisation does not fit in memory";
    case Outcome::linear_solver_inaccurate:
      return "the linear solution is inaccurate: the tangent is close to singular";
    case Outcome::limit_point:
      return "a limit point: softening bonds give the tangent negative pivots, and no equilibrium "
             "near the last one is found, however small the load step";
    case Outcome::damage_limit:
      return "more bonds break at one load than loading.max_broken_bonds allows, however small the "
             "step: a limit point, beyond which the crack runs by itself";
    case Outcome::fragmented:
      return "a piece has come off (solver.fragments = \"stop\")";
    case Outcome::undefined_condition:
      return "supports or loads have no value at this load factor, or contradict each other";
    case Outcome::no_answer:
      return "the controlled displacement does not respond to the load: the path turns back here, "
             "or no load moves it";
    case Outcome::sharp_turn:
      return "the path turns too sharply for the length of the step";
    case Outcome::step_limit:
      return "the load has not reached its end after the largest number of steps; with "
             "arc_length.steps the path ends after that many steps";
    case Outcome::damage_begins:
      return "bonds would be damaged in a search that must not change their integrities";
    case Outcome::inconsistent:
      return "the state that was found violates a balance that it must satisfy";
    case Outcome::unstable_step:
      return "the time step is longer than the stable one for the present stiffness";
    case Outcome::interrupted:
      return "interrupted";
  }
  return "";
}

SharedEnvironment EquilibriumProblem::environment(const LoadPoint& at) const {
  SharedEnvironment environment = conditions.environment(at);
  if (!inertia) return environment;
  auto with =
      environment ? std::make_shared<Environment>(*environment) : std::make_shared<Environment>();
  with->inertia = *inertia;
  return with;
}

void share_out_jump(const EquilibriumProblem& problem, std::span<const double> from,
                    std::span<double> displacement) {
  const Constraints& constraints = problem.conditions.constraints();
  if (constraints.none()) return;
  std::vector<char> stays(displacement.size());
  for (std::size_t dof = 0; dof < stays.size(); ++dof) {
    stays[dof] = problem.free.equation[dof] == FreeDofs::none;
  }
  constraints.share_out_jump(from, stays, displacement);
}

void move_followers(const EquilibriumProblem& problem, std::span<double> displacement) {
  const Constraints& constraints = problem.conditions.constraints();
  problem.assembler.index_map().update_ghosts(displacement);
  if (!constraints.none()) constraints.move(displacement);
}

void fold_followers(const EquilibriumProblem& problem, std::span<const double> external_force,
                    Trial& trial) {
  const Constraints& constraints = problem.conditions.constraints();
  if (constraints.none()) return;
  const Sums sums = problem.sums();
  constraints.fold(trial.displacement, external_force, trial.gradient);
  const std::size_t points = problem.assembler.points().reference.size();
  sums.add_up(std::span(trial.gradient).subspan(points));  // each rank has a share of handles
  trial.curvature = constraints.curvature(trial.displacement, external_force, trial.gradient);
  for (Tensor& block : trial.curvature) {
    for (auto& row : block) sums.add_up(row);
  }
}

double allowed_share(const EquilibriumProblem& problem, const StateView& at,
                     std::span<const double> step) {
  if (!problem.assembler.has_contacts()) return 1.0;
  std::vector<double> of_all(step.begin(), step.end());
  problem.assembler.index_map().update_ghosts(of_all);
  const Constraints& constraints = problem.conditions.constraints();
  if (!constraints.none()) constraints.extend(at.displacement, of_all);
  return problem.assembler.longest_step(at, of_all);
}

void add_contact_stiffness(const EquilibriumProblem& problem, const StateView& at,
                           double most_depth, std::span<double> stiffness) {
  const Points& points = problem.assembler.points();
  const Constraints& constraints = problem.conditions.constraints();
  const auto d = std::size_t(points.dimension);
  std::vector<double> of_contacts(stiffness.size(), 0.0);
  problem.assembler.add_contact_stiffness(at, most_depth, of_contacts);
  for (Index image = points.own(); image < points.count(); ++image) {
    for (int axis = 0; axis < points.dimension; ++axis) {
      const double periods = std::abs(points.image_kind(image).periods[std::size_t(axis)]);
      if (periods == 0.0) continue;
      // The row of the jump J in the energy of p J + u_j - u_i; p^2 + 2 p of a row's half.
      const auto handle = std::size_t(constraints.period_handle(axis));
      for (std::size_t c = 0; c < d; ++c) {
        of_contacts[handle * d + c] +=
            0.5 * periods * (periods + 2.0) * of_contacts[std::size_t(image) * d + c];
      }
    }
  }
  add_scaled(stiffness, 1.0, of_contacts);
}

double heating_work(Assembler& assembler, const StateView& from, const StateView& to) {
  const auto [before, after] = std::pair(from.environment, to.environment);
  const bool is_same = before == after || (before && after && *before == *after);
  // Points of this rank may see no change where those of other ranks do.
  const Sums sums(assembler.index_map(), assembler.points().dimension);
  // Obstacles that a force drives move under a constant one, too.
  const double of_obstacles = assembler.work_of_obstacles(from, to);
  if (sums.largest_of_all(is_same ? 0.0 : 1.0) == 0.0) return of_obstacles;
  const auto added_at = [&](const StateView& at) {
    const auto energy_under = [&](const SharedEnvironment& environment) {
      StateView view(at.displacement, at.history, Damage::held, environment);
      view.has_contacts = false;
      return assembler.energy(view).energy;
    };
    return energy_under(after) - energy_under(before);
  };
  return 0.5 * (added_at(from) + added_at(to)) + of_obstacles;
}

double environment_norm(const EquilibriumProblem& problem, const StateView& at,
                        std::span<const double> gradient) {
  if (!at.environment && !problem.assembler.has_contacts()) return 0.0;
  std::vector<double> with(gradient.begin(), gradient.end()), without(gradient.size());
  if (!problem.conditions.constraints().none()) {  // the gradient is folded
    std::fill(with.begin(), with.end(), 0.0);
    static_cast<void>(problem.assembler.gradient(at, with));
  }
  StateView bare(at.displacement, at.history, at.damage);
  bare.has_contacts = false;
  static_cast<void>(problem.assembler.gradient(bare, without));
  const Sums sums = problem.sums();
  return sums.norm_of_entries(with.size(),
                              [&](std::size_t dof) { return with[dof] - without[dof]; });
}

void evaluate(const EquilibriumProblem& problem, std::span<const double> external_force,
              Trial& trial, Damage damage) {
  move_followers(problem, trial);
  trial.gradient.resize(trial.displacement.size());
  const Evaluation found = problem.assembler.gradient(trial.at(damage), trial.gradient);
  if (trial.environment && trial.environment->has_follower_force()) {
    trial.follower_force.resize(trial.displacement.size());
    problem.assembler.follower_force(trial.at(damage), trial.follower_force);
  }
  fold_followers(problem, external_force, trial);
  trial.stored_energy = found.energy;
  trial.energy_round_off = found.round_off;
  const Obstacles& obstacles = problem.conditions.obstacles();
  trial.total_energy = found.energy + obstacles.potential(trial.displacement, trial.environment) -
                       problem.sums().dot(external_force, trial.displacement);
  trial.residual_norm = problem.sums().norm_of(problem.free.dof.size(), [&](std::size_t e) {
    const Index dof = problem.free.dof[e];
    return external_force[dof] - trial.gradient[dof];
  });
  trial.degenerate = found.degenerate || !std::isfinite(trial.residual_norm);
}

double residual_scale(const EquilibriumProblem& problem, std::span<const double> external_force,
                      std::span<const double> old_gradient, const Trial& after_jump) {
  const Sums sums = problem.sums();
  const double reactions = sums.norm_of_entries(external_force.size(), [&](std::size_t dof) {
    const bool is_free = problem.free.equation[dof] != FreeDofs::none;
    return is_free ? 0.0 : old_gradient[dof] - external_force[dof];
  });
  return std::max({sums.norm(external_force), reactions, after_jump.residual_norm});
}

double load_norm(const EquilibriumProblem& problem, std::span<const double> external_force,
                 const Trial& state, Damage damage) {
  const Sums sums = problem.sums();
  const double reactions = sums.norm_of_entries(external_force.size(), [&](std::size_t dof) {
    const bool is_free = problem.free.equation[dof] != FreeDofs::none;
    return is_free ? 0.0 : state.gradient[dof] - external_force[dof];
  });
  return std::max({sums.norm(external_force), reactions,
                   environment_norm(problem, state.at(damage), state.gradient)});
}

double differenced_forces(const TangentOperator& tangent, std::span<const double> displacement) {
  const auto d = std::size_t(tangent.dimension);
  Coordinates mean{};
  for (std::size_t k = 0; k < displacement.size(); ++k) {
    mean[k % d] += displacement[k] * double(d) / double(displacement.size());
  }
  return norm_of(displacement.size(), [&](std::size_t k) {
    return tangent.diagonal[k * d + k % d] * (displacement[k] - mean[k % d]);
  });
}

double residual_round_off(const Sums& sums, const FreeDofs& free, const TangentOperator& tangent,
                          std::span<const double> displacement) {
  std::vector<double> row_sums(displacement.size());
  tangent.absolute_row_sums(row_sums);
  const std::size_t d = std::size_t(free.dimension);
  constexpr double unit_round_off = 0.5 * std::numeric_limits<double>::epsilon();
  const double of_sums = sums.norm_of(free.dof.size(), [&](std::size_t e) {
    const std::size_t dof = std::size_t(free.dof[e]), first = dof - dof % d;
    double largest = 0.0;
    for (std::size_t c = 0; c < d; ++c) {
      largest = std::max(largest, std::abs(displacement[first + c]));
    }
    return row_sums[dof] * largest;
  });
  return unit_round_off *
         (of_sums + (tangent.has_rows() ? 0.0 : differenced_forces(tangent, displacement)));
}

}  // namespace peristat
