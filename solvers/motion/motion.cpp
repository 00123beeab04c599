#include "solvers/motion/motion.hpp"

#include <cmath>
#include <utility>

namespace peristat {

Motion::Motion(const EquilibriumProblem& problem, const MotionSetting& setting, const State& from,
               std::vector<double> velocity)
    : problem_(problem),
      setting_(setting),
      inverse_mass_(from.displacement.size(), 0.0),
      drag_(setting, problem.free.dof),
      external_force_(from.displacement.size()),
      velocity_(std::move(velocity)),
      time_(from.stage) {
  at_.displacement = from.displacement;
  at_.history = from.history;
  at_.environment = from.environment;
  at_.gradient.resize(from.displacement.size());
  for (const Index dof : problem.free.dof) inverse_mass_[dof] = 1.0 / setting.mass[dof];
  const Conditions& conditions = problem.conditions;
  conditions.external_force(time_, external_force_);
  for (const Index dof : problem.free.dof) {
    if (conditions.loads_change() || external_force_[dof] != 0.0) loaded_.push_back(dof);
  }
  if (conditions.supports_move()) {
    const auto &prescribed = conditions.prescribed(),
               &dependent = conditions.constraints().dependent();
    problem.sums().for_each_entry(prescribed.size(), [&](std::size_t dof) {
      if (prescribed[dof] && !dependent[dof]) moved_.push_back(Index(dof));
    });
  }
  move_followers(problem, at_);
  if (!find_forces()) at_.degenerate = true;
}

bool Motion::find_forces() {
  if (problem_.assembler.has_friction()) {  // by the normal forces of this place
    static_cast<void>(problem_.assembler.lag_friction(at_.at(), at_.at(), at_.history));
  }
  const Evaluation found = problem_.assembler.commit_forces(at_.displacement, at_.history,
                                                            at_.gradient, at_.environment);
  if (at_.environment && at_.environment->has_follower_force()) {
    at_.follower_force.resize(at_.displacement.size());
    problem_.assembler.follower_force(at_.at(), at_.follower_force);
  }
  fold_followers(problem_, external_force_, at_);
  sums_.growth += found.growth;
  sums_.released += found.released;
  return !found.degenerate;
}

void Motion::note_before() {
  last_place_.resize(moved_.size());
  last_reaction_.resize(moved_.size());
  for (std::size_t k = 0; k < moved_.size(); ++k) {
    last_place_[k] = at_.displacement[moved_[k]];
    last_reaction_[k] = at_.gradient[moved_[k]];
  }
  if (!at_.follower_force.empty()) {
    last_displacement_ = at_.displacement;
    last_follower_force_ = at_.follower_force;
  }
}

void Motion::change_supports_and_loads(std::span<double> displacement) {
  const Conditions& conditions = problem_.conditions;
  if (!conditions.supports_move() && !conditions.loads_change()) return;
  take_on_all_ranks([&] {
    if (conditions.supports_move()) conditions.prescribe(time_, displacement);
    change_loads();
  });
}

void Motion::require_conditions_on_all_ranks(double time) {
  if (problem_.assembler.index_map().is_whole()) return;
  take_on_all_ranks([&] {
    std::vector<double> values(at_.displacement.size());
    problem_.conditions.prescribe(time, values);
    problem_.conditions.external_force(time, values);
    static_cast<void>(problem_.conditions.environment(time));
  });
}

void Motion::change_loads() {
  if (!problem_.conditions.loads_change()) return;
  last_force_.swap(external_force_);
  external_force_.resize(last_force_.size());
  problem_.conditions.external_force(time_, external_force_);
}

void Motion::change_environment() {
  if (!problem_.conditions.environment_changes()) return;
  last_environment_ = at_.environment;
  if (problem_.conditions.obstacles().move()) {
    before_obstacles_move_ = at_.displacement;
    slips_before_.replace_slips(at_.history.slips());
  }
  take_on_all_ranks([&] { at_.environment = problem_.conditions.environment(time_); });
  add_half_of_heating();
}

void Motion::complete_heating() {
  if (!problem_.conditions.environment_changes()) return;
  add_half_of_heating();
  if (before_obstacles_move_.empty()) return;
  const StateView before(before_obstacles_move_, slips_before_, Damage::held, last_environment_);
  const double work = problem_.assembler.work_of_obstacles(before, at_.at());
  if (problem_.assembler.index_map().is_first_rank()) sums_.work += work;  // of the whole body
}

void Motion::add_half_of_heating() {
  const Environment& now = *at_.environment;
  const bool has_energy = !now.eigenstretch.empty() || !now.ground.empty();  // pressures have none
  if (problem_.sums().largest_of_all(has_energy ? 1.0 : 0.0) == 0.0) return;
  const double heating = 0.5 * (energy_under(at_.environment) - energy_under(last_environment_));
  if (problem_.assembler.index_map().is_first_rank()) sums_.work += heating;  // of the whole body
}

double Motion::energy_under(const SharedEnvironment& environment) {
  StateView view(at_.displacement, at_.history, Damage::held, environment);
  view.has_contacts = false;
  return problem_.assembler.energy(view).energy;
}

void Motion::add_work_of_supports() {
  for (std::size_t k = 0; k < moved_.size(); ++k) {
    sums_.work += 0.5 * (last_reaction_[k] + at_.gradient[moved_[k]]) *
                  (at_.displacement[moved_[k]] - last_place_[k]);
  }
  problem_.sums().for_each_entry(at_.follower_force.size(), [&](std::size_t k) {
    sums_.work += 0.5 * (last_follower_force_[k] + at_.follower_force[k]) *
                  (at_.displacement[k] - last_displacement_[k]);
  });
}

bool Motion::find_energy() {
  const Evaluation found = problem_.assembler.energy(at_.at());
  at_.stored_energy = found.energy;
  at_.energy_round_off = found.round_off;
  at_.degenerate |= found.degenerate || !std::isfinite(squared_force());
  return !at_.degenerate;
}

MotionSums Motion::sums() const {
  MotionSums all = sums_;
  const std::vector<double> of_all = problem_.sums().of_all({sums_.work, sums_.absorbed});
  all.work = of_all[0];
  all.absorbed = of_all[1];
  return all;
}

double Motion::kinetic_energy() const {
  double twice = 0.0;
  for (const Index dof : problem_.free.dof) {
    twice += setting_.mass[dof] * velocity_[dof] * velocity_[dof];
  }
  return 0.5 * problem_.sums().of_all(twice);
}

double Motion::squared_force() const {
  double sum = 0.0;
  for (const Index dof : problem_.free.dof) {
    const double force = external_force_[dof] - at_.gradient[dof];
    sum += force * force * inverse_mass_[dof];
  }
  return problem_.sums().of_all(sum);
}

double Motion::energy_of_onset(double dt) const {
  const bool has_follower_force = !last_follower_force_.empty() && !at_.follower_force.empty();
  double sum = 0.0;
  for (const Index dof : problem_.free.dof) {
    double change = last_force_.empty() ? 0.0 : external_force_[dof] - last_force_[dof];
    if (has_follower_force) change += at_.follower_force[dof] - last_follower_force_[dof];
    sum += change * change * inverse_mass_[dof];
  }
  return dt * dt / 8.0 * problem_.sums().of_all(sum);
}

}  // namespace peristat
