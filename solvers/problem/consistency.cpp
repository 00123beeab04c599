#include "solvers/problem/consistency.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "assembly/assembler.hpp"
#include "src/core/number_text.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

/// Relative error of sums of work over a step in which bonds break.
constexpr double work_error = 0.05;

/// Allowed error of sums over all interactions, in units of round-off times the sum of the absolute
/// terms.
constexpr double safety = 1e3;

/// Energies near the smallest number have lost their digits [J].
constexpr double smallest_energy = 1e-250;

Coordinates centre_of(const Points& points, const Sums& sums) {
  const std::size_t d = std::size_t(points.dimension), own = sums.own(points.reference.size());
  std::vector<double> all(d + 1, 0.0);  // coordinates, and the number of points
  for (std::size_t k = 0; k < own; ++k) all[k % d] += points.reference[k];
  all[d] = double(own / d);
  all = sums.of_all(std::move(all));
  Coordinates centre{};
  for (std::size_t c = 0; c < d; ++c) centre[c] = all[c] / std::max(1.0, all[d]);
  return centre;
}

struct Resultants {
  Coordinates force{}, moment{};
  double reach = 0.0;  ///< largest distance of a point from the centre [m]
};

/// dE/dx of the interactions between points alone, not folded by constraints.
std::vector<double> internal_forces(const EquilibriumProblem& problem, const Trial& trial) {
  std::vector<double> gradient = trial.gradient;
  if (!problem.conditions.constraints().none()) {
    static_cast<void>(problem.assembler.gradient(trial.at(), gradient));
  }
  problem.conditions.foundations().add_force(trial.displacement, trial.environment, 1.0, gradient);
  problem.conditions.obstacles().add_force(trial.displacement, trial.environment,
                                           trial.history.slips(), 1.0, gradient);
  return gradient;
}

Coordinates sum_of(const Sums& sums, const Coordinates& mine) {
  const std::vector<double> all = sums.of_all(std::vector<double>(mine.begin(), mine.end()));
  return {all[0], all[1], all[2]};
}

/// Sums of the internal forces and of their moments about the body's centre.
Resultants resultants_of(const EquilibriumProblem& problem, const Trial& trial) {
  const Points& points = problem.assembler.points();
  const std::vector<double> gradient = internal_forces(problem, trial);
  const Sums of_body = problem.sums();
  const Coordinates centre = centre_of(points, of_body);
  const std::size_t d = std::size_t(points.dimension);
  Resultants sums;
  for (Index i = 0; i < points.count(); ++i) {
    if (!points.owns(i)) continue;
    Coordinates arm{}, force{};
    for (std::size_t c = 0; c < d; ++c) {
      const std::size_t dof = std::size_t(i) * d + c;
      arm[c] = points.reference[dof] - centre[c] + trial.displacement[dof];
      force[c] = gradient[dof];
      if (!trial.follower_force.empty()) force[c] += trial.follower_force[dof];
    }
    const Coordinates moment{arm[1] * force[2] - arm[2] * force[1],
                             arm[2] * force[0] - arm[0] * force[2],
                             arm[0] * force[1] - arm[1] * force[0]};
    for (std::size_t c = 0; c < 3; ++c) {
      sums.force[c] += force[c];
      sums.moment[c] += moment[c];
    }
    sums.reach = std::max(sums.reach, std::hypot(arm[0], arm[1], arm[2]));
  }
  sums.force = sum_of(of_body, sums.force);
  sums.moment = sum_of(of_body, sums.moment);
  sums.reach = of_body.largest_of_all(sums.reach);
  return sums;
}

std::string check_equilibrium(const EquilibriumProblem& problem, const FoundState& found) {
  if (found.largest_residual < 0.0) return {};
  Trial again;
  again.displacement = found.trial.displacement;
  again.history = found.trial.history;
  again.environment = found.trial.environment;
  evaluate(problem, found.external_force, again);
  // The committed histories may change the last digits of forces that were summed before.
  const double allowed = 2.0 * found.largest_residual;
  if (!again.degenerate && again.residual_norm <= allowed) return {};
  return "evaluated again, the residual is " + number_text(again.residual_norm) +
         " N; the accepted one was " + number_text(found.largest_residual) + " N";
}

std::string check_strength(Assembler& damaged, const FoundState& found) {
  const DamageGrowth growth = damaged.growth(found.trial.at());
  if (growth.degrading == 0) return {};
  return std::to_string(growth.degrading) +
         " unbroken bonds are stretched beyond their limit, to " + number_text(growth.utilisation) +
         " of it";
}

std::string check_resultants(const EquilibriumProblem& problem, const TangentOperator& tangent,
                             const FoundState& found) {
  const Balances owed = problem.assembler.model().balances();
  const std::size_t d = std::size_t(tangent.dimension);
  double trace = 0.0;
  problem.sums().for_each_entry(tangent.diagonal.size() / d, [&](std::size_t dof) {
    trace += std::abs(tangent.diagonal[dof / d * d * d + dof % d * (d + 1)]);
  });
  trace = problem.sums().of_all(trace);
  // Where all has come apart forces may vanish, and the energy, which is quadratic in them, first.
  const double energy = std::max(std::abs(found.after.stored), std::numeric_limits<double>::min());
  double forces = std::sqrt(2.0 * energy * trace);
  if (!tangent.has_rows()) {
    forces += differenced_forces(tangent, found.trial.displacement);
  }
  const double round_off = safety * std::numeric_limits<double>::epsilon() * forces;
  const Resultants sums = resultants_of(problem, found.trial);
  const double force = std::hypot(sums.force[0], sums.force[1], sums.force[2]);
  const double moment = std::hypot(sums.moment[0], sums.moment[1], sums.moment[2]);
  if (owed.force_sum && !(force <= round_off)) {
    return "the internal forces add up to " + number_text(force) +
           " N, but round-off explains only " + number_text(round_off) + " N";
  }
  if (owed.moment_sum && !(moment <= round_off * sums.reach)) {
    return "the moments of the internal forces add up to " + number_text(moment) +
           " N m, but round-off explains only " + number_text(round_off * sums.reach) + " N m";
  }
  return {};
}

std::string check_energies(const EquilibriumProblem& problem, const TangentOperator& tangent,
                           const FoundState& found) {
  constexpr double round_off = 1e-12;
  const Balances owed = problem.assembler.model().balances();
  const auto& [before, after] = std::pair(found.before, found.after);
  if (!owed.potential) return {};  // work is not stored
  double least = round_off * after.dissipated + found.trial.energy_round_off;
  if (!tangent.has_rows()) {
    least += safety * std::numeric_limits<double>::epsilon() *
             differenced_forces(tangent, found.trial.displacement) * norm(found.trial.displacement);
  }
  if (owed.positive_energy && after.stored < -least) {
    return "the stored energy is negative, " + number_text(after.stored) + " J";
  }
  const double dissipated = after.dissipated - before.dissipated;
  if (dissipated < -round_off * std::abs(before.dissipated)) {
    return "the dissipated energy falls by " + number_text(-dissipated) + " J";
  }
  // Where contacts open or close within a step, the mean of the forces at its ends is not their
  // work, and friction dissipates in such steps.
  const bool is_bent = problem.assembler.has_contacts() && !found.sums_all_work;
  const bool is_elastic = (dissipated == 0.0 && !found.sums_all_work) || is_bent;
  const bool may_move = found.largest_residual < 0.0;  // and then holds energy of the step before
  if (is_elastic || may_move) return {};
  const double stored = after.stored - before.stored;
  const double work =
      after.external_work + after.numerical_work - before.external_work - before.numerical_work;
  const double drained =
      found.sums_all_work ? after.drained - before.drained : work - stored - dissipated;
  const double turned_over = std::abs(stored) + dissipated + std::abs(work);
  // Where all has come apart nothing is turned over but the rounding of the sums.
  const double rounding = round_off * (std::abs(after.external_work) + after.dissipated);
  if (drained >= -work_error * turned_over - rounding) return {};
  return number_text(-drained) + " J of energy appear without a source: " + number_text(work) +
         " J of work for " + number_text(stored) + " J stored and " + number_text(dissipated) +
         " J dissipated";
}

std::string check_magnitude(const Sums& sums, const FoundState& found) {
  const double forces = sums.norm(found.trial.gradient),
               moved = sums.norm(found.trial.displacement);
  // A body that has come apart may be left without forces.
  const bool has_worked = std::abs(found.after.external_work) >= smallest_energy;
  if (has_worked || forces == 0.0 || moved == 0.0 || forces * moved >= smallest_energy) return {};
  return "forces and displacements are so small that their products vanish in double precision; "
         "use units that fit the size of the body";
}

}  // namespace

double sum_of_internal_forces(const EquilibriumProblem& problem, const Trial& trial) {
  const Coordinates sum = resultants_of(problem, trial).force;
  return std::hypot(sum[0], sum[1], sum[2]);
}

std::string find_inconsistency(const EquilibriumProblem& problem, Assembler& damaged,
                               const TangentOperator& tangent, const FoundState& found) {
  std::string fault = check_magnitude(problem.sums(), found);
  if (fault.empty()) fault = check_equilibrium(problem, found);
  if (fault.empty()) fault = check_strength(damaged, found);
  if (fault.empty()) fault = check_resultants(problem, tangent, found);
  if (fault.empty()) fault = check_energies(problem, tangent, found);
  return fault;
}

}  // namespace peristat
