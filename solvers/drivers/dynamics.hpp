#pragma once

#include <memory>
#include <string>
#include <vector>

#include "solvers/drivers/driver.hpp"
#include "solvers/drivers/found_step.hpp"
#include "solvers/motion/motion.hpp"

namespace peristat {

/// Follows the motion in time, by explicit steps (VelocityVerlet) or implicit ones (Newmark), from
/// the initial state to the end of the programme of time. Each call goes to the next state that is
/// told, a number of time steps on; PathState::steps counts time steps. The last step ends at the
/// end.
///
/// Explicit: every so many time steps the stiffness of the present state is bounded. A step that is
/// a share of the stable one follows it; one that is given ends the path where it is no longer
/// stable. Implicit: a step that finds nothing, and one whose state breaks a balance, is halved;
/// the next state that is told doubles it again, up to the given one.
///
/// A state that is told owes the balance of its modified energy, up to what trapezoidal sums of
/// work leave out; that energy may not be far from the printed one, which is how motions show that
/// the step does not resolve; nor may the energy be many times what has been put in, which is how
/// steps that are too long show.
class Dynamics : public Driver {
 public:
  explicit Dynamics(Path& path);

 protected:
  [[nodiscard]] Advance next() override;

 private:
  /// @throws std::logic_error if the path has none
  [[nodiscard]] const MotionSetting& setting() const;
  [[nodiscard]] Advance begin();
  /// Searches the equilibrium of the conditions at t = 0, with integrities held.
  /// @return converged if nothing is damaged there
  [[nodiscard]] Attempt find_equilibrium();
  [[nodiscard]] Advance move();
  [[nodiscard]] bool is_implicit() const { return options_.scheme == MotionScheme::newmark; }
  /// @param acceleration of implicit steps; empty: of the forces
  [[nodiscard]] std::unique_ptr<Motion> make_motion(const State& from, std::vector<double> velocity,
                                                    std::vector<double> acceleration);
  /// Takes the implicit step back towards the given one, after one that has failed.
  void lengthen_step(double time);
  /// @return whether there is a shorter implicit step to try
  [[nodiscard]] bool shorten_step(double time, Outcome outcome, const std::string& reason);
  /// The stiffness at a state; the eigenvalue is found again where the bound has changed.
  [[nodiscard]] Stiffness stiffness_at(const Trial& state);
  /// Where the body's motion has no use of it until it is found again, and it is quickly found.
  void give_back_tangent();
  /// Chooses the step for the present stiffness.
  /// @return why there is none
  [[nodiscard]] std::string choose_step(const Trial& state, double time);
  [[nodiscard]] Advance accept(Motion& motion);
  /// Of what is prescribed, the mean over a time step.
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
  bool repeats_ = false;        // what was found is dropped, for shorter steps from the same state
};

}  // namespace peristat
