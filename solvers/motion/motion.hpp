#pragma once

#include <optional>
#include <span>
#include <vector>

#include "solvers/motion/drag.hpp"
#include "solvers/motion/motion_setting.hpp"
#include "solvers/problem/equilibrium.hpp"
#include "src/core/input_error.hpp"

namespace peristat {

/// What steps have done, summed over them.
struct MotionSums {
  double work = 0.0;  ///< of supports, loads, pressures and heating [J]
  /// What the steps have added to the scheme's energy beside kinetic and stored [J].
  double correction = 0.0;
  double released = 0.0;  ///< see Evaluation::released [J]
  DamageGrowth growth{};
  double absorbed = 0.0;  ///< energy that layers have taken [J]
  int iterations = 0;     ///< of Newton
};

/// The motion M a = F(u, t) = f_ext(t) - dE/dx(u) on the free degrees of freedom, M the lumped
/// mass, step by step in time. Works are trapezoidal sums over the steps. Layers that absorb add a
/// drag, M a = F - eta M v, which the schemes integrate together with F (Drag): what a constant
/// force does is exact for any eta dt.
///
/// Masses and velocities of what is prescribed do not enter: supports do the work of dE/dx alone.
///
/// Of a body that ranks have parts of, each moves the points that it owns, and ghosts follow their
/// owners; energies and sums are those of the whole body, in calls that all ranks make.
class Motion {
 public:
  /// Damages what is stretched too far in the state.
  /// @param from its displacement is that of the supports, and of what follows
  Motion(const EquilibriumProblem& problem, const MotionSetting& setting, const State& from,
         std::vector<double> velocity);
  virtual ~Motion() = default;

  /// What is prescribed goes where it is prescribed at the step's end, and bonds that are stretched
  /// too far there are damaged for good.
  /// @param time at its end
  /// @return converged, or why there is no state: of the implicit scheme then nothing has changed;
  ///         values that are not finite show in find_energy
  /// @throws InputError where supports or loads have no value at that time
  [[nodiscard]] virtual Outcome step(double dt, double time) = 0;
  /// Closes the correction of the steps so far.
  virtual void complete_sums() {}

  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] const Trial& at() const { return at_; }
  [[nodiscard]] Trial take() { return std::move(at_); }
  [[nodiscard]] std::vector<double> take_velocity() { return std::move(velocity_); }
  /// What a scheme has to know of the last step beside the state; empty: nothing [m/s2].
  [[nodiscard]] virtual std::vector<double> take_acceleration() { return {}; }
  [[nodiscard]] const std::vector<double>& external_force() const { return external_force_; }
  /// 0 where it is prescribed [m/s].
  [[nodiscard]] const std::vector<double>& velocity() const { return velocity_; }
  [[nodiscard]] MotionSums sums() const;

  /// Finds the stored energy of the present state.
  /// @return false if that is no state
  [[nodiscard]] bool find_energy();

  /// Of the free degrees of freedom [J].
  [[nodiscard]] double kinetic_energy() const;
  /// F.M^-1 F [J/s2]
  [[nodiscard]] double squared_force() const;
  /// By how much the energy that a scheme conserves is below kinetic and stored energy [J].
  [[nodiscard]] virtual double scheme_energy(double /*dt*/) { return 0.0; }
  /// Energy that the scheme gives to a body at rest for loads that set in within the last step,
  /// before they do any work: dt^2/8 f.M^-1 f with the change f of the loads and pressures [J].
  ///
  /// The last half of the step kicks with the new loads, v = dt/2 M^-1 f, while the body has not
  /// moved yet: kinetic energy is v.Mv/2, and the work is zero. One step later the work is eight
  /// times as much.
  [[nodiscard]] double energy_of_onset(double dt) const;

 protected:
  /// Takes conditions to a time: all ranks, or none where one alone finds no value at its points.
  template <class Take>
  void take_on_all_ranks(const Take& take) {
    const Sharing* const sharing = problem_.assembler.sharing();
    if (!sharing) return take();
    std::optional<InputError> refusal;
    try {
      take();
    } catch (const InputError& error) {
      refusal = error;
    }
    if (sharing->ranks().max(refusal ? 1.0 : 0.0) == 0.0) return;
    throw refusal.value_or(InputError("", "", "a condition has no value on another rank"));
  }
  /// Finds the forces of the present state, and damages it.
  /// @return false if an interaction has collapsed
  [[nodiscard]] bool find_forces();
  /// Before a step: of what its work is summed.
  void note_before();
  /// Takes loads to the present time, and what is prescribed to its place there.
  /// @throws InputError on all ranks alike
  void change_supports_and_loads(std::span<double> displacement);
  void change_loads();
  /// Before a search at a time, in which one rank alone would find a condition without a value.
  void require_conditions_on_all_ranks(double time);
  /// Takes what the energy depends on to a time, with half of the work of that.
  void change_environment();
  /// The other half, in the new place.
  void complete_heating();
  /// Adds the work of a step.
  /// @param travelled(dof) in it, of what is free [m]
  template <class Travelled>
  void add_work(const Travelled& travelled) {
    const std::vector<double>& force = external_force_;
    const std::vector<double>& before = problem_.conditions.loads_change() ? last_force_ : force;
    for (const Index dof : loaded_) {
      sums_.work += 0.5 * (before[dof] + force[dof]) * travelled(dof);
    }
    add_work_of_supports();
  }

  EquilibriumProblem problem_;
  const MotionSetting& setting_;
  std::vector<double> inverse_mass_;  // 0 where there is no equation
  Drag drag_;
  Trial at_;
  std::vector<double> external_force_, velocity_;
  double time_ = 0.0;
  MotionSums sums_;  // work and what is absorbed: of this rank's points

 private:
  void add_half_of_heating();
  [[nodiscard]] double energy_under(const SharedEnvironment& environment);
  void add_work_of_supports();

  std::vector<Index> loaded_, moved_;
  std::vector<double> last_force_;
  std::vector<double> last_reaction_, last_place_;  // of moved_
  std::vector<double> last_displacement_, last_follower_force_;
  SharedEnvironment last_environment_;
};

}  // namespace peristat
