#pragma once

#include "solvers/motion/motion.hpp"

namespace peristat {

/// Explicit steps by velocity Verlet ([GPMB] eq. 15):
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
/// to the second order of the step. The sums' correction is that of dt^2/8 F.M^-1 F.
class VelocityVerlet : public Motion {
 public:
  using Motion::Motion;

  [[nodiscard]] Outcome step(double dt, double time) override;
  void complete_sums() override;

 private:
  void kick(double half_step);
  void drift(double dt);

  double last_dt_ = 0.0, force_at_change_ = 0.0;
  bool has_moved_ = false;
};

}  // namespace peristat
