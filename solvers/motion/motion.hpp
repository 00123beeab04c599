#pragma once

#include <optional>
#include <span>
#include <vector>

#include "solvers/motion/drag.hpp"
#include "solvers/motion/motion_setting.hpp"
#include "solvers/problem/equilibrium.hpp"
#include "src/core/input_error.hpp"
#include "src/parallel/collectives.hpp"

namespace peristat {

/// Sums over the steps.
struct MotionSums {
  double work = 0.0;  ///< of supports, loads, pressures and heating [J]
  /// Sum of the changes of scheme_energy within steps [J].
  double correction = 0.0;
  double released = 0.0;  ///< see Evaluation::released [J]
  DamageGrowth growth{};
  double absorbed = 0.0;  ///< energy absorbed by layers [J]
  int iterations = 0;     ///< of Newton
};

/// The motion M a = F(u, t) = f_ext(t) - dE/dx(u) on the free degrees of freedom, M the lumped
/// mass, step by step in time. Works are trapezoidal sums over the steps. Absorbing layers add a
/// drag, M a = F - eta M v, which the schemes integrate together with F (Drag): exact under a
/// constant force for any eta dt.
///
/// Masses and velocities of prescribed degrees of freedom do not enter: supports do the work of
/// dE/dx alone.
///
/// On a distributed body each rank moves the points that it owns, and ghosts follow their owners;
/// energies and sums are those of the whole body. All calls are collective.
class Motion {
 public:
  /// Commits the damage of the initial state.
  /// @param from initial state, with supports in place
  Motion(const EquilibriumProblem& problem, const MotionSetting& setting, const State& from,
         std::vector<double> velocity);
  virtual ~Motion() = default;

  /// Makes a step: moves prescribed degrees of freedom to their values at its end, and damages
  /// bonds that are stretched too far there, irreversibly.
  /// @param time at the end of the step
  /// @return converged, or why there is no state: the implicit scheme has then changed nothing;
  ///         values that are not finite show in find_energy
  /// @throws InputError where supports or loads have no value at that time
  [[nodiscard]] virtual Outcome step(double dt, double time) = 0;
  /// Adds the correction of the steps so far to the sums.
  virtual void complete_sums() {}

  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] const Trial& at() const { return at_; }
  [[nodiscard]] Trial take() { return std::move(at_); }
  [[nodiscard]] std::vector<double> take_velocity() { return std::move(velocity_); }
  /// Data of the last step that a scheme needs beside the state; empty: none [m/s2].
  [[nodiscard]] virtual std::vector<double> take_acceleration() { return {}; }
  [[nodiscard]] const std::vector<double>& external_force() const { return external_force_; }
  /// Velocities, 0 where prescribed [m/s].
  [[nodiscard]] const std::vector<double>& velocity() const { return velocity_; }
  [[nodiscard]] MotionSums sums() const;

  /// Finds the stored energy of the present state.
  /// @return false if the state is degenerate
  [[nodiscard]] bool find_energy();

  /// Kinetic energy of the free degrees of freedom [J].
  [[nodiscard]] double kinetic_energy() const;
  /// F.M^-1 F [J/s2]
  [[nodiscard]] double squared_force() const;
  /// Kinetic and stored energy less the energy that the scheme conserves [J].
  [[nodiscard]] virtual double scheme_energy(double /*dt*/) { return 0.0; }
  /// Energy that the scheme gives to a body at rest if loads set in within the last step, before
  /// they do any work: dt^2/8 f.M^-1 f with the change f of the loads and pressures [J].
  ///
  /// The last half of the step accelerates with the new loads, v = dt/2 M^-1 f, while the body has
  /// not moved yet: the kinetic energy is v.Mv/2, and the work is zero. One step later the work is
  /// eight times as much.
  [[nodiscard]] double energy_of_onset(double dt) const;

 protected:
  /// Evaluates conditions at a time; throws on all ranks if they have no value on one of them.
  template <class Take>
  void take_on_all_ranks(const Take& take) {
    std::optional<InputError> refusal;
    try {
      take();
    } catch (const InputError& error) {
      refusal = error;
    }
    if (!any_of_all(problem_.assembler.index_map().ranks(), refusal.has_value())) return;
    throw refusal.value_or(InputError("", "", "a condition has no value on another rank"));
  }
  /// Finds the forces of the present state, and commits its damage.
  /// @return false if an interaction has collapsed
  [[nodiscard]] bool find_forces();
  /// Stores the data before a step that its work is summed from.
  void note_before();
  /// Updates loads to the present time, and moves prescribed degrees of freedom.
  /// @throws InputError on all ranks alike
  void change_supports_and_loads(std::span<double> displacement);
  void change_loads();
  /// Throws on all ranks if a condition has no value at a time on one of them; called before a
  /// search.
  void require_conditions_on_all_ranks(double time);
  /// Updates the environment to the present time, and adds half of the work of its change.
  void change_environment();
  /// Adds the other half, at the new displacement.
  void complete_heating();
  /// Adds the work of a step.
  /// @param travelled(dof) displacement of a free degree of freedom in the step [m]
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
  MotionSums sums_;  // work and absorbed energy: of this rank's points

 private:
  void add_half_of_heating();
  [[nodiscard]] double energy_under(const SharedEnvironment& environment);
  void add_work_of_supports();

  std::vector<Index> loaded_, moved_;
  std::vector<double> last_force_;
  std::vector<double> last_reaction_, last_place_;  // of moved_
  std::vector<double> last_displacement_, last_follower_force_;
  SharedEnvironment last_environment_;
  std::vector<double> before_obstacles_move_;  // displacement; empty: none moves
  History slips_before_;                       // with these alone
};

}  // namespace peristat
