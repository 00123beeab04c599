#pragma once

#include <memory>
#include <string>
#include <vector>

#include "solvers/drivers/driver.hpp"
#include "solvers/drivers/found_step.hpp"
#include "solvers/motion/motion.hpp"

namespace peristat {

/// Follows the motion in time, by explicit steps (VelocityVerlet) or implicit ones (Newmark), from
/// the initial state to the end of the programme of time. Each call goes to the next reported
/// state, a number of time steps later; PathState::steps counts time steps. The last step ends at
/// the end.
///
/// Explicit: after every so many time steps the stiffness of the present state is bounded. A step
/// that is a fraction of the stable one is adapted to it; a given step ends the path once it is no
/// longer stable. Implicit: a step that finds no solution, or whose state violates a balance, is
/// halved; at the next reported state it is doubled again, up to the given one.
///
/// A reported state must balance its modified energy, up to the error of trapezoidal sums of work.
/// That energy must be near the printed one: a difference shows that the step does not resolve the
/// motion. The energy must not be many times the energy put in: this shows that the step is too
/// long.
class Dynamics : public Driver {
 public:
  explicit Dynamics(Path& path);

 protected:
  [[nodiscard]] Advance next() override;

 private:
  /// @throws std::logic_error if the path has no motion
  [[nodiscard]] const MotionSetting& setting() const;
  [[nodiscard]] Advance begin();
  /// Searches the equilibrium of the conditions at t = 0, with integrities held.
  /// @return converged if nothing is damaged there
  [[nodiscard]] Attempt find_equilibrium();
  [[nodiscard]] Advance move();
  [[nodiscard]] bool is_implicit() const { return options_.scheme == MotionScheme::newmark; }
  /// @param acceleration of implicit steps; empty: that of the forces
  [[nodiscard]] std::unique_ptr<Motion> make_motion(const State& from, std::vector<double> velocity,
                                                    std::vector<double> acceleration);
  /// Lengthens the implicit step towards the given one, after it was shortened.
  void lengthen_step(double time);
  /// @return true if there is a shorter implicit step to try
  [[nodiscard]] bool shorten_step(double time, Outcome outcome, const std::string& reason);
  /// Bounds the stiffness at a state; the eigenvalue is computed anew if the bound has changed.
  [[nodiscard]] Stiffness stiffness_at(const Trial& state);
  /// Frees the tangent if the motion does not use it and it is quickly computed anew.
  void give_back_tangent();
  /// Returns the explicit time step that contacts allow, not longer than that of the bonds.
  [[nodiscard]] double step_with_contacts(const Motion& motion, double dt);
  /// Chooses the time step for the present stiffness.
  /// @return why there is none; empty if there is
  [[nodiscard]] std::string choose_step(const Trial& state, double time);
  [[nodiscard]] Advance accept(Motion& motion);
  /// Sets the velocities of prescribed degrees of freedom, means over a time step.
  void add_velocity_of_supports(double time, std::vector<double>& velocity) const;
  [[nodiscard]] MotionRecord motion_record(const Motion& motion) const;
  [[nodiscard]] Ledger ledger_with(const Motion& motion, const MotionSums& sums,
                                   double dissipated) const;
  /// @param energy_of_onset see Motion
  [[nodiscard]] std::string fault_of(const Attempt& attempt, const FoundStep& found,
                                     double energy_of_onset);
  [[nodiscard]] std::string fault_of_balance(const Ledger& after, double energy_of_onset);
  [[nodiscard]] Advance fail(Outcome outcome, double time, const std::string& what);

  const DynamicsOptions& options_;
  bool is_linearised_ = false;  // the tangent, near the present state
  bool repeats_ = false;        // the state found is dropped, for shorter steps from the last one
};

}  // namespace peristat
