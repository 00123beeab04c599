#include "solvers/drivers/dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "assembly/operators/convolved_tangent.hpp"
#include "solvers/motion/newmark.hpp"
#include "solvers/motion/stable_step.hpp"
#include "solvers/motion/velocity_verlet.hpp"
#include "src/core/number_text.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

/// Time steps between two checks of the stiffness: more of them while it does not change.
constexpr int fewest_between_looks = 4, most_between_looks = 64;
constexpr int steps_between_interruptions = 20;

/// Relative change of the bound up to which the eigenvalue is assumed to change in proportion.
constexpr double same_stiffness = 0.02;

/// A step grows only by at least this factor: with each change the scheme begins anew.
constexpr double least_growth = 1.25;

/// Largest error of trapezoidal sums of work, relative to the energy turned over. In explicit steps
/// all that bonds dissipate is allowed in addition, since those that break within a step lose the
/// energy of its beginning or its end.
constexpr double work_error = 0.05;

/// Energy of an unstable motion, relative to the energy put in. A stable step gives the highest
/// frequencies a multiple of the modified energy, 1 / (1 - (step / stable step)^2).
constexpr double growth_of_instability = 100.0;

/// The same where forces have no potential, whose energy does not balance: kinetic and stored
/// energy of torn bodies reached 1.17 of the energy put in, of an unstable one 4 and more.
constexpr double growth_without_potential = 1.3;

/// Largest allowed gap between conserved and printed energy, relative to the energy put in. The gap
/// is (step / stable step)^2 of the energy at the highest frequency. Well-resolved motions have
/// some hundredths of it at most; beyond a half the printed energies mean nothing.
constexpr double unresolved = 0.5;
/// Steps before which a load that sets in at once has done too little work to be a scale.
constexpr int steps_of_onset = 10;

/// Largest share of the gap to its largest depth that a contact closes in an explicit step. A layer
/// of two rows that was hit at up to 0.6 of the wave speed stopped before the largest depth so.
constexpr double most_closing = 0.2;

/// Weight of the stiffness of contacts in the bound of an explicit step. 1 is stable; contacts that
/// set in and end within a step then change the energy by some per cent, with 3 by some tenths.
constexpr double weight_of_contacts = 3.0;

/// Smallest implicit step, relative to the given one.
constexpr double least_step = 1.0 / 1024.0;

/// A remaining time below this fraction of a step is round-off.
constexpr double remainder = 1e-9;

}  // namespace

Dynamics::Dynamics(Path& path) : Driver(path), options_(path.options().dynamics) {}

const MotionSetting& Dynamics::setting() const {
  if (!path_.setting().motion) throw std::logic_error("mode dynamics needs masses");
  return *path_.setting().motion;
}

Advance Dynamics::next() {
  PathState& state = path_.state();
  if (state.dynamics.has_begun && !path_.goes_on()) return Advance::ended;
  // Velocities and accelerations change in accepted steps alone; they are long, so not copied.
  std::vector<double> velocity = std::exchange(state.dynamics.velocity, {}),
                      acceleration = std::exchange(state.dynamics.acceleration, {});
  const PathState::Dynamics dynamics = state.dynamics;
  state.dynamics.velocity = std::move(velocity);
  state.dynamics.acceleration = std::move(acceleration);
  const int steps = state.steps;
  const Advance advance = dynamics.has_begun ? move() : begin();
  if (path_.outcome() != Outcome::converged || repeats_) {
    const double step = repeats_ ? state.dynamics.step : dynamics.step;
    velocity = std::exchange(state.dynamics.velocity, {});
    acceleration = std::exchange(state.dynamics.acceleration, {});
    state.dynamics = dynamics;
    state.dynamics.velocity = std::move(velocity);
    state.dynamics.acceleration = std::move(acceleration);
    state.dynamics.step = step;
    state.steps = steps;
    repeats_ = false;
  }
  return advance;
}

Advance Dynamics::begin() {
  PathState& state = path_.state();
  const Conditions& conditions = path_.setting().conditions;
  State start{setting().displacement, 0.0, state.accepted.history, {}, state.accepted.environment};
  if (options_.start == MotionStart::equilibrium) {
    Attempt found = find_equilibrium();
    if (!found.has_converged()) {
      const std::string reason =
          "no equilibrium found at the start: " + reason_of(found, found.note);
      return path_.stop(std::move(found), 0.0, reason);
    }
    start.displacement = std::move(found.state.displacement);
  }
  start.displacement.resize(setting().mass.size());
  conditions.prescribe(0.0, start.displacement);
  std::vector<double> velocity = setting().velocity;
  velocity.resize(setting().mass.size());
  for (std::size_t dof = 0; dof < velocity.size(); ++dof) {
    if (path_.free().equation[dof] == FreeDofs::none) velocity[dof] = 0.0;
  }
  const auto motion = make_motion(start, std::move(velocity), {});
  if (motion->at().degenerate || !motion->find_energy())
    return fail(Outcome::degenerate, 0.0, "the initial state");
  if (is_implicit()) {
    state.dynamics.step = options_.time_step;
  } else {
    if (setting().at_start) state.dynamics.stiffness = *setting().at_start;
    const std::string refusal = choose_step(motion->at(), 0.0);
    if (!refusal.empty()) return fail(Outcome::unstable_step, 0.0, refusal);
    const double step = state.dynamics.step;
    state.dynamics.correction_at_start = motion->scheme_energy(step);
  }
  // The initial energy of the body counts as work that was done before.
  Ledger& entries = state.ledger.entries;
  entries = {};
  std::vector<double> damage(std::size_t(path_.damaged().points().count()));
  const DamageState damaged = path_.damaged().assess(motion->at().history, {}, damage);
  entries.external_work = motion->at().stored_energy + motion->kinetic_energy() +
                          damaged.dissipated_energy + motion->sums().released;
  state.dynamics.has_begun = true;
  return accept(*motion);
}

Attempt Dynamics::find_equilibrium() {
  const State& rest = path_.state().accepted;
  if (const auto refusal = path_.refusal_of_conditions(0.0)) {
    Attempt undefined = undefined_attempt(rest, 0.0);
    undefined.note = *refusal;
    return undefined;
  }
  NewtonOptions newton = path_.setting().newton_options;
  newton.damage = Damage::held;
  Attempt found = path_.search(rest, 0.0, newton);
  is_linearised_ = false;
  if (!found.has_converged()) return found;
  const DamageGrowth growth = path_.damaged().growth(found.state.at());
  if (growth.degrading > 0) {
    found.outcome = Outcome::damage_begins;
    found.note = std::to_string(growth.degrading) + " bonds or points at " +
                 number_text(growth.utilisation) + " of their strength";
  }
  return found;
}

std::unique_ptr<Motion> Dynamics::make_motion(const State& from, std::vector<double> velocity,
                                              std::vector<double> acceleration) {
  if (!is_implicit()) {
    return std::make_unique<VelocityVerlet>(path_.problem(), setting(), from, std::move(velocity));
  }
  const SolvedBody& body = path_.body();
  NewtonOptions newton = path_.setting().newton_options;
  newton.counts_pivots = false;
  return std::make_unique<Newmark>(
      path_.problem(), setting(), from, std::move(velocity), std::move(acceleration),
      options_.spectral_radius,
      Newmark::Search{body.solver, body.tangent, newton, path_.setting().observer.interrupted});
}

void Dynamics::lengthen_step(double time) {
  double& step = path_.state().dynamics.step;
  if (step >= options_.time_step) return;
  const double before = std::exchange(step, std::min(2.0 * step, options_.time_step));
  path_.tell(time, {.increment = before,
                    .outcome = name(Outcome::converged),
                    .action = Decision::change_time_step,
                    .next_increment = step,
                    .reason = "the shorter steps have succeeded"});
}

bool Dynamics::shorten_step(double time, Outcome outcome, const std::string& reason) {
  double& step = path_.state().dynamics.step;
  const bool may_help = outcome != Outcome::interrupted && outcome != Outcome::out_of_memory;
  if (!is_implicit() || !may_help || 0.5 * step < least_step * options_.time_step) return false;
  const double before = std::exchange(step, 0.5 * step);
  path_.tell(time, {.increment = before,
                    .outcome = name(outcome),
                    .action = Decision::change_time_step,
                    .next_increment = step,
                    .reason = reason});
  return true;
}

Stiffness Dynamics::stiffness_at(const Trial& state) {
  const auto& [assembler, solver, tangent, free] = path_.body();
  const BondFailure* const bonds = path_.damaged().model().failing_bonds();
  // Bonds that close are as stiff as whole ones, and may do so before the next look.
  const History history = bonds && bonds->closes() ? assembler.initial_history() : state.history;
  StateView view(state.displacement, history, Damage::grows, state.environment);
  view.curvature = state.curvature;
  view.has_contacts = false;  // those of the present and of the near future: see step_with_contacts
  tangent.linearise(assembler, view, projection_for_stiffness(assembler));
  is_linearised_ = true;
  const Stiffness now =
      bound_stiffness(tangent, free, setting().mass, setting().most_points, assembler.index_map());
  const Stiffness& known = path_.state().dynamics.stiffness;
  const bool is_enough = options_.time_step > 0.0 && now.stable_step() >= options_.time_step;
  if (is_enough) return now;
  if (known.bound > 0.0 && std::abs(now.bound - known.bound) <= same_stiffness * known.bound) {
    return {now.bound, known.eigenvalue * std::max(1.0, now.bound / known.bound)};
  }
  path_.state().dynamics.stiffness =
      find_stiffness(tangent, free, setting().mass, setting().most_points, assembler.index_map());
  return path_.state().dynamics.stiffness;
}

void Dynamics::give_back_tangent() {
  if (is_implicit() || !forget_if_convolved(path_.body().tangent)) return;
  is_linearised_ = false;
}

std::string Dynamics::choose_step(const Trial& state, double time) {
  PathState::Dynamics& dynamics = path_.state().dynamics;
  const Stiffness now = stiffness_at(state);
  give_back_tangent();
  const bool has_changed =
      std::abs(now.bound - dynamics.last_bound) > same_stiffness / 2 * now.bound;
  dynamics.last_bound = now.bound;
  dynamics.look_interval =
      std::clamp(has_changed ? dynamics.look_interval / 2 : 2 * dynamics.look_interval,
                 fewest_between_looks, most_between_looks);
  dynamics.next_look += dynamics.look_interval;
  const double stable = now.stable_step();
  if (options_.time_step > 0.0) {
    dynamics.step = options_.time_step;
    if (dynamics.step <= stable) return {};
    return "the time step is " + number_text(dynamics.step) + " s, longer than the stable one, " +
           number_text(stable) + " s";
  }
  const double before = dynamics.step, wanted = options_.step_share * stable;
  if (!std::isfinite(stable)) {  // any step is stable: all that moves has come apart
    if (before > 0.0) return {};
    return "no moving point has a stiffness, so there is no stable step; give dynamics.time_step";
  }
  if (before > 0.0 && wanted >= before && wanted < least_growth * before) return {};
  dynamics.step = wanted;
  if (before == 0.0) return {};
  path_.tell(time, {.increment = before,
                    .outcome = name(Outcome::converged),
                    .action = Decision::change_time_step,
                    .next_increment = wanted,
                    .reason = "the stable time step is " + number_text(stable) + " s"});
  return {};
}

double Dynamics::step_with_contacts(const Motion& motion, double dt) {
  Assembler& assembler = path_.damaged();
  if (is_implicit() || !assembler.has_contacts()) return dt;
  const std::vector<double>& mass = setting().mass;
  const Trial& at = motion.at();
  std::vector<double> stiffness(mass.size(), 0.0);
  add_contact_stiffness(path_.problem(), at.at(), 1.0, stiffness);
  double largest = 0.0;
  for (const Index dof : path_.free().dof) {
    largest = std::max(largest, stiffness[dof] / mass[dof]);
  }
  largest = path_.problem().sums().largest_of_all(largest);
  // omega^2 <= omega_bonds^2 + omega_contacts^2, and dt = share * 2 / omega_bonds.
  const double of_bonds = 2.0 * options_.step_share / dt;
  dt = 2.0 * options_.step_share / std::sqrt(of_bonds * of_bonds + weight_of_contacts * largest);
  const double end = path_.setting().conditions.programme().end();
  std::vector<double> next = at.displacement;
  add_scaled(next, dt, motion.velocity());
  move_followers(path_.problem(), next);
  const StateView there(next, at.history, Damage::held,
                        path_.problem().environment(std::min(motion.time() + dt, end)));
  const double closed = assembler.largest_closing(at.at(), there);
  return closed > most_closing ? dt * most_closing / closed : dt;
}

Advance Dynamics::move() {
  PathState& state = path_.state();
  const double end = path_.setting().conditions.programme().end();
  const auto& interrupted = path_.setting().observer.interrupted;
  const auto motion =
      make_motion(state.accepted, state.dynamics.velocity, state.dynamics.acceleration);
  int step = state.steps;
  bool is_last = false;
  do {
    const double time = motion->time();
    const bool asks = (step - state.steps) % steps_between_interruptions == 0;
    if (interrupted && asks && interrupted()) {
      return fail(Outcome::interrupted, time, "");
    }
    if (!is_implicit() && step >= state.dynamics.next_look) {
      state.dynamics.next_look = step;
      const std::string refusal = choose_step(motion->at(), time);
      if (!refusal.empty()) return fail(Outcome::unstable_step, time, refusal);
    }
    double dt = 0.0, next = 0.0;
    try {
      dt = step_with_contacts(*motion, state.dynamics.step);
      next = time + dt;
    } catch (const InputError& error) {
      return fail(Outcome::undefined_condition, time,
                  path_.refusal_of_conditions(time).value_or(error.what()));
    }
    is_last = end - time <= dt * (1.0 + remainder);
    if (is_last) dt = end - time, next = end;
    if (!(next > time))
      return fail(Outcome::unstable_step, time,
                  "the time step is lost in the round-off of the time");
    Outcome outcome = Outcome::converged;
    try {
      outcome = motion->step(dt, next);
    } catch (const InputError& error) {
      return fail(Outcome::undefined_condition, next,
                  path_.refusal_of_conditions(next).value_or(error.what()));
    }
    if (outcome != Outcome::converged) {
      is_last = false;
      if (shorten_step(time, outcome, explanation(outcome))) continue;
      return fail(outcome, next, "");
    }
    ++step;
  } while (!is_last && (step == state.steps || step % options_.steps_per_row != 0));
  state.steps = step;
  if (!motion->find_energy()) return fail(Outcome::degenerate, motion->time(), "");
  motion->complete_sums();
  state.dynamics.correction += motion->sums().correction;
  return accept(*motion);
}

MotionRecord Dynamics::motion_record(const Motion& motion) const {
  const PathState::Dynamics& dynamics = path_.state().dynamics;
  MotionRecord record;
  record.time = motion.time();
  record.time_step = dynamics.step;
  record.kinetic_energy = motion.kinetic_energy();
  record.modified_energy = record.kinetic_energy + motion.at().stored_energy -
                           dynamics.correction_at_start - dynamics.correction;
  const FreeDofs& free = path_.free();
  std::vector<double> momentum(record.momentum.size(), 0.0);
  for (const Index dof : free.dof) {
    momentum[std::size_t(dof % free.dimension)] += setting().mass[dof] * motion.velocity()[dof];
  }
  momentum = path_.problem().sums().of_all(std::move(momentum));
  std::copy(momentum.begin(), momentum.end(), record.momentum.begin());
  return record;
}

Ledger Dynamics::ledger_with(const Motion& motion, const MotionSums& sums,
                             double dissipated) const {
  const PathLedger& ledger = path_.state().ledger;
  Ledger after = ledger.entries;
  after.stored = motion.at().stored_energy;
  after.dissipated = dissipated + ledger.released + sums.released;
  after.external_work += sums.work;
  after.drained += sums.absorbed;
  after.kinetic = motion.kinetic_energy();
  return after;
}

Advance Dynamics::accept(Motion& motion) {
  PathState& state = path_.state();
  const double time = motion.time();
  Assembler& assembler = path_.damaged();
  std::vector<double> damage(std::size_t(assembler.points().count()));
  const DamageState damaged = assembler.assess(motion.at().history, {}, damage);
  FoundStep found;
  found.record.mode = Mode::dynamics.name;
  found.record.settled = true;
  const MotionSums sums = motion.sums();
  found.record.newton_iterations = sums.iterations;
  found.record.motion = motion_record(motion);
  found.record.broken_bonds = damaged.broken_bonds;
  found.growth = sums.growth;
  found.energies.released = sums.released;
  found.ledger = ledger_with(motion, sums, damaged.dissipated_energy);
  const double energy_of_onset = motion.energy_of_onset(state.dynamics.step);
  std::vector<double> velocity = motion.take_velocity(), acceleration = motion.take_acceleration();
  Attempt attempt;
  attempt.at = time;
  attempt.largest_residual = -1.0;
  attempt.external_force = motion.external_force();
  attempt.state = motion.take();
  const std::string fault = fault_of(attempt, found, energy_of_onset);
  if (!fault.empty()) {
    repeats_ = time > state.accepted.stage && shorten_step(time, Outcome::inconsistent, fault);
    return repeats_ ? Advance::goes_on : fail(Outcome::inconsistent, time, fault);
  }
  state.accepted = state_of(attempt);
  add_velocity_of_supports(time, velocity);
  state.dynamics.velocity = std::move(velocity);
  state.dynamics.acceleration = std::move(acceleration);
  state.ledger.accept(found.ledger, path_.working_force(attempt.state, attempt.external_force),
                      found.energies);
  complete_record(path_, attempt, found);
  path_.tell(time, {.increment = state.dynamics.step,
                    .outcome = name(Outcome::converged),
                    .action = Decision::accept,
                    .next_increment = state.dynamics.step,
                    .reason = "time step " + std::to_string(state.steps)});
  if (const auto& tell = path_.setting().observer.accepted) {
    tell(found.record,
         {attempt.state, attempt.external_force, state.pins.found.piece, state.dynamics.velocity});
  }
  if (is_implicit()) lengthen_step(time);
  return Advance::goes_on;
}

void Dynamics::add_velocity_of_supports(double time, std::vector<double>& velocity) const {
  const Conditions& conditions = path_.setting().conditions;
  if (!conditions.supports_move()) return;
  const double half = 0.5 * path_.state().dynamics.step;
  const double before = std::max(0.0, time - half);
  const double after = std::min(conditions.programme().end(), time + half);
  std::vector<double> there(velocity.size()), here(velocity.size());
  conditions.prescribe(before, here);
  conditions.prescribe(after, there);
  const std::vector<char>& dependent = conditions.constraints().dependent();
  for (std::size_t dof = 0; dof < velocity.size(); ++dof) {
    if (conditions.prescribed()[dof] && !dependent[dof]) {
      velocity[dof] = (there[dof] - here[dof]) / (after - before);
    }
  }
}

std::string Dynamics::fault_of(const Attempt& attempt, const FoundStep& found,
                               double energy_of_onset) {
  const auto& [assembler, solver, tangent, free] = path_.body();
  if (!is_linearised_) {
    tangent.linearise(assembler, attempt.state.at(), projection_for_stiffness(assembler));
  }
  is_linearised_ = true;
  const PathState& state = path_.state();
  const std::string fault =
      find_inconsistency(path_.problem(), path_.damaged(), tangent,
                         {attempt.state, attempt.external_force, attempt.largest_residual, true,
                          state.ledger.entries, found.ledger});
  give_back_tangent();
  if (!fault.empty()) return fault;
  return fault_of_balance(found.ledger, energy_of_onset);
}

std::string Dynamics::fault_of_balance(const Ledger& after, double energy_of_onset) {
  PathState::Dynamics& dynamics = path_.state().dynamics;
  const double energy = after.kinetic + after.stored;
  dynamics.largest_energy =
      std::max({dynamics.largest_energy, std::abs(after.external_work), after.dissipated});
  const double error = after.balance_error() + dynamics.correction;
  // Loads that set in give the body their energy before they do any work. Since (a + b)^2 <= 2 a^2
  // + 2 b^2, a motion that has forces or velocities a already has at most twice both energies then.
  // `unresolved`, a half, of four times the energy of onset allows for it.
  const double put_in = std::max(dynamics.largest_energy, 4.0 * energy_of_onset);
  // Explicit steps are short, so that the energy missing of a bond that breaks in one is a part of
  // what it dissipates; implicit steps could gain any amount by this allowance.
  const double allowed =
      work_error * std::max(dynamics.largest_energy, is_implicit() ? 0.0 : energy) +
      (is_implicit() ? energy_of_onset : after.dissipated);
  const bool is_damped = is_implicit() && options_.spectral_radius < 1.0;  // damping loses energy
  const bool balances = path_.damaged().has_potential();
  if (balances && (!(-error <= allowed) || !(is_damped || error <= allowed))) {
    return "the modified energy is " + number_text(error) + " J below the supplied energy, " +
           number_text(dynamics.largest_energy) + " J";
  }
  if (!(after.drained >= -allowed)) {
    return "absorbing layers have given " + number_text(-after.drained) + " J to the motion";
  }
  const double scheme = std::abs(dynamics.correction_at_start + dynamics.correction);
  if (balances && path_.state().steps >= steps_of_onset &&
      !(scheme <= unresolved * std::max(put_in, energy))) {
    return "the time step does not resolve the motion: " + number_text(scheme) +
           " J of its energy depend on the step, while " + number_text(dynamics.largest_energy) +
           " J have been supplied; take a shorter step, or start from fields that are smooth over "
           "a horizon";
  }
  const double growth = balances ? growth_of_instability : growth_without_potential;
  if (!(energy <= growth * put_in)) {
    return "the energy of the motion is " + number_text(energy) + " J, but only " +
           number_text(dynamics.largest_energy) + " J have been supplied";
  }
  return {};
}

Advance Dynamics::fail(Outcome outcome, double time, const std::string& what) {
  Attempt attempt = undefined_attempt(path_.state().accepted, time);
  attempt.outcome = outcome;
  const std::string reason = reason_of(attempt, what);
  return path_.stop(std::move(attempt), path_.state().dynamics.step, reason);
}

}  // namespace peristat
