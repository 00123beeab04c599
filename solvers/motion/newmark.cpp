#include "solvers/motion/newmark.hpp"

#include <utility>

namespace peristat {
namespace {

/// Largest number of equilibria of a step in which bonds go on breaking.
constexpr int most_passes = 1000;

}  // namespace

NewmarkCoefficients::NewmarkCoefficients(double spectral_radius)
    : of_inertia((2.0 * spectral_radius - 1.0) / (spectral_radius + 1.0)),
      of_force(spectral_radius / (spectral_radius + 1.0)),
      gamma(0.5 - of_inertia + of_force),
      beta(0.25 * (1.0 - of_inertia + of_force) * (1.0 - of_inertia + of_force)) {}

Newmark::Newmark(const EquilibriumProblem& problem, const MotionSetting& setting, const State& from,
                 std::vector<double> velocity, std::vector<double> acceleration,
                 double spectral_radius, Search search)
    : Motion(problem, setting, from, std::move(velocity)),
      coefficients_(spectral_radius),
      acceleration_(std::move(acceleration)),
      search_(std::move(search)) {
  if (!acceleration_.empty()) return;
  acceleration_.resize(velocity_.size());
  for (const Index dof : problem_.free.dof) {
    acceleration_[dof] = inverse_mass_[dof] * (external_force_[dof] - at_.gradient[dof]);
  }
}

Outcome Newmark::step(double dt, double time) {
  require_conditions_on_all_ranks(time);
  drag_.set_step(dt);
  NewtonResult found = find(time, inertia_of_step(dt));
  if (found.outcome != Outcome::converged) return found.outcome;
  note_before();
  std::vector<double> force_before(velocity_.size());
  for (const Index dof : problem_.free.dof) {
    force_before[dof] = external_force_[dof] - at_.gradient[dof];
  }
  time_ = time;
  change_environment();
  const std::vector<double> before = std::exchange(at_.displacement, found.state.displacement);
  at_.history = std::move(found.state.history);
  complete_heating();
  change_loads();
  if (!find_forces()) return Outcome::degenerate;
  add_work([&](Index dof) { return at_.displacement[dof] - before[dof]; });
  accelerate(dt, force_before);
  return Outcome::converged;
}

InertialSprings Newmark::inertia_of_step(double dt) const {
  const auto [of_inertia, of_force, gamma, beta] = coefficients_;
  InertialSprings inertia{std::vector<double>(velocity_.size(), 0.0),
                          std::vector<double>(velocity_.size(), 0.0)};
  drag_.for_each(problem_.free.dof, [&](Index dof, const DragFactors& drag) {
    const double mass = setting_.mass[dof], force = external_force_[dof] - at_.gradient[dof];
    const double stiffness = coefficients_.stiffness_per_mass(dt) / (2.0 * drag.phi2) * mass;
    const double known =
        (of_inertia * mass * acceleration_[dof] - of_force * force) / (1.0 - of_force);
    inertia.stiffness[dof] = stiffness;
    inertia.place[dof] = at_.displacement[dof] + dt * drag.phi1 * velocity_[dof] +
                         dt * dt * drag.phi2 * (1.0 - 2.0 * beta) * acceleration_[dof] -
                         known / stiffness;
  });
  return inertia;
}

NewtonResult Newmark::find(double time, const InertialSprings& inertia) {
  EquilibriumProblem problem = problem_;
  problem.inertia = &inertia;
  NewtonOptions growing = search_.options, held = growing;
  held.damage = Damage::held;
  State from{at_.displacement, time_, at_.history, {}, at_.environment};
  const auto search = [&](const NewtonOptions& options) {
    NewtonResult found = newton(
        problem, search_.solver, search_.tangent, from, time, options,
        [&](const IterationRecord&) { return search_.interrupted && search_.interrupted(); });
    sums_.iterations += found.iterations;
    return found;
  };
  DamageGrowth growth;
  double released = 0.0;
  for (int pass = 0;; ++pass) {
    NewtonResult found = search(growing);
    const bool may_damage = problem.assembler.model().has_history();
    if (found.outcome != Outcome::converged && found.outcome != Outcome::interrupted && may_damage)
      found = search(held);
    if (found.outcome != Outcome::converged) return found;
    const Evaluation committed = problem.assembler.commit(
        found.state.displacement, found.state.history, {}, found.state.environment);
    growth += committed.growth;
    released += committed.released;
    if (committed.growth.degrading == 0) {
      sums_.growth += growth;
      sums_.released += released;
      return found;
    }
    if (pass == most_passes) {
      found.outcome = Outcome::iteration_limit;
      return found;
    }
    from = {found.state.displacement, time, found.state.history, {}, found.state.environment};
    growing.scale = held.scale = found.scale;
  }
}

/// Uses the forces at both ends: differences of positions would have the round-off of 1 / dt^2.
void Newmark::accelerate(double dt, const std::vector<double>& force_before) {
  const auto [of_inertia, of_force, gamma, beta] = coefficients_;
  drag_.for_each(problem_.free.dof, [&](Index dof, const DragFactors& drag) {
    const double force = external_force_[dof] - at_.gradient[dof];
    const double mean = (1.0 - of_force) * force + of_force * force_before[dof];
    const double before = acceleration_[dof];
    acceleration_[dof] = (inverse_mass_[dof] * mean - of_inertia * before) / (1.0 - of_inertia);
    const double kick = dt * ((1.0 - gamma) * before + gamma * acceleration_[dof]);
    const double v = velocity_[dof];
    velocity_[dof] = drag.decay * v + drag.phi1 * kick;
    if (drag.lost == 0.0) return;
    sums_.absorbed +=
        setting_.mass[dof] *
        (0.5 * drag.lost * (1.0 + drag.decay) * v * v + drag.phi1 * drag.lost * v * kick +
         (drag.phi2 - 0.5 * drag.phi1 * drag.phi1) * kick * kick);
  });
}

}  // namespace peristat
