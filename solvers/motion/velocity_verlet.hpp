#pragma once

#include "solvers/motion/motion.hpp"

namespace peristat {

/// Explicit steps by velocity Verlet ([GPMB] eq. 15):
///
///   v^(n+1/2) = v^n + dt/2 M^-1 F^n,   u^(n+1) = u^n + dt v^(n+1/2),
///   v^(n+1) = v^(n+1/2) + dt/2 M^-1 F^(n+1)
///
/// Prescribed degrees of freedom move to their values at t^(n+1), and bonds that are stretched too
/// far there are damaged irreversibly before F^(n+1) is found ([GPMB] algorithm 3).
///
/// With T = v.Mv/2 a step changes T - dt^2/8 F.M^-1 F by exactly the trapezoidal work of F,
/// (F^n + F^(n+1))/2 . (u^(n+1) - u^n). Where forces are linear in u that is the change of the
/// energy: the modified energy T + E - dt^2/8 F.M^-1 F is then conserved to round-off, and T + E to
/// the second order of the step. The sums' correction is the change of dt^2/8 F.M^-1 F.
///
/// With a drag (Drag) the step is that of van Gunsteren and Berendsen [1982] without their random
/// force, which is Verlet's where x = eta dt is 0, and exact under a constant force:
///
///   u^(n+1) = u^n + phi1 dt v^n + phi2 dt^2 M^-1 F^n,
///   v^(n+1) = exp(-x) v^n + dt M^-1 ((phi1 - phi2) F^n + phi2 F^(n+1))
///
/// It is stable wherever Verlet's is. The energy of the scheme beside T is then
/// phi2^2 dt^2/2 F.M^-1 F; the drag has absorbed the work of F less the change of
/// T - phi2^2 dt^2/2 F.M^-1 F.
class VelocityVerlet : public Motion {
 public:
  using Motion::Motion;

  [[nodiscard]] Outcome step(double dt, double time) override;
  void complete_sums() override;
  /// dt^2/8 F.M^-1 F, or its counterpart with a drag.
  [[nodiscard]] double scheme_energy(double dt) override;

 private:
  void kick(double half_step);
  void drift(double dt);

  void note_dragged();
  /// Where there is a drag, replaces the velocities after a kick without drag by the step's mean
  /// ones.
  void begin_drag(double dt);
  /// Likewise sets the velocities at its end, and adds the energy that the drag has absorbed.
  void end_drag(double dt);
  [[nodiscard]] double acceleration(Index dof) const {
    return inverse_mass_[dof] * (external_force_[dof] - at_.gradient[dof]);
  }

  double last_dt_ = 0.0, energy_at_change_ = 0.0;
  bool has_moved_ = false;
  std::vector<double> dragged_velocity_,
      dragged_acceleration_;  // before a step, of the drag's dofs
};

}  // namespace peristat
