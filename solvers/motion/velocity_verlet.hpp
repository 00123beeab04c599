#pragma once

#include <span>
#include <vector>

#include "solvers/motion/motion_setting.hpp"
#include "solvers/problem/equilibrium.hpp"

namespace peristat {

/// What steps have done, summed over them.
struct MotionSums {
  double work = 0.0;  ///< of supports, loads, pressures and heating [J]
  /// Sum of (dt^2/8) (F.M^-1 F at the end - at the beginning) over the steps [J]: what the scheme
  /// adds to the kinetic energy, see VelocityVerlet.
  double correction = 0.0;
  double released = 0.0;  ///< see Evaluation::released [J]
  DamageGrowth growth{};
};

/// The motion M a = F(u, t) = f_ext(t) - dE/dx(u) on the free degrees of freedom by velocity Verlet
/// ([GPMB] eq. 15), M the lumped mass:
///
///   v^(n+1/2) = v^n + dt/2 M^-1 F^n,   u^(n+1) = u^n + dt v^(n+1/2),
///   v^(n+1) = v^(n+1/2) + dt/2 M^-1 F^(n+1)
///
/// What is prescribed goes where it is prescribed at t^(n+1), and bonds that are stretched too far
/// there are damaged for good before F^(n+1) is found ([GPMB] algorithm 3).
///
/// With T = v.Mv/2 a step changes T - dt^2/8 F.M^-1 F by just the trapezoidal work of F,
/// (F^n + F^(n+1))/2 . (u^(n+1) - u^n). Where forces are linear in u that is the change of the
/// energy: T + E - dt^2/8 F.M^-1 F, the modified energy, is then conserved to round-off, and T + E
/// to the second order of the step.
///
/// Masses and velocities of what is prescribed do not enter: supports do the work of dE/dx alone.
class VelocityVerlet {
 public:
  /// Damages what is stretched too far in the state.
  /// @param from its displacement is that of the supports, and of what follows
  VelocityVerlet(const EquilibriumProblem& problem, const MotionSetting& setting, const State& from,
                 std::vector<double> velocity);

  /// @param time at its end
  /// @return false if an interaction has collapsed there; values that are not finite show in
  ///         find_energy
  /// @throws InputError where supports or loads have no value at that time
  [[nodiscard]] bool step(double dt, double time);

  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] const Trial& at() const { return at_; }
  [[nodiscard]] Trial take() { return std::move(at_); }
  [[nodiscard]] std::vector<double> take_velocity() { return std::move(velocity_); }
  [[nodiscard]] const std::vector<double>& external_force() const { return external_force_; }
  /// v^n; 0 where it is prescribed [m/s].
  [[nodiscard]] const std::vector<double>& velocity() const { return velocity_; }
  [[nodiscard]] const MotionSums& sums() const { return sums_; }

  /// Finds the stored energy of the present state.
  /// @return false if that is no state
  [[nodiscard]] bool find_energy();

  /// Of the free degrees of freedom [J].
  [[nodiscard]] double kinetic_energy() const;
  /// F.M^-1 F [J/s2]
  [[nodiscard]] double squared_force() const;
  /// Closes the correction of the steps so far.
  void complete_sums();

 private:
  [[nodiscard]] bool find_forces();
  void kick(double half_step);
  void drift(double dt);
  void go_where_prescribed();
  void change_loads();
  /// Takes what the energy depends on to the present time, with half of the work of that.
  void change_environment();
  void complete_heating();
  void add_half_of_heating();
  [[nodiscard]] double energy_under(const SharedEnvironment& environment);
  void note_before();
  void add_work_after(double dt);

  EquilibriumProblem problem_;
  const MotionSetting& setting_;
  std::vector<double> inverse_mass_;  // 0 where there is no equation
  std::vector<Index> loaded_, moved_;
  Trial at_;
  std::vector<double> external_force_, last_force_, velocity_;
  std::vector<double> last_reaction_, last_place_;  // of moved_
  std::vector<double> last_displacement_, last_follower_force_;
  SharedEnvironment last_environment_;
  double time_ = 0.0, last_dt_ = 0.0, force_at_change_ = 0.0;
  bool has_moved_ = false;
  MotionSums sums_;
};

}  // namespace peristat
