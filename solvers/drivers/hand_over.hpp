#pragma once

#include <string>

#include "solvers/drivers/implicit_stepping.hpp"
#include "solvers/drivers/relaxed_stepping.hpp"

namespace peristat {

/// Implicit steps go on until one would damage a bond (further). It is cut to the load at which
/// damage begins, interpolated in the utilisation of the bonds; what is left is taken over by
/// relaxation, from the last accepted state. Relaxation goes on in steps of its own while damage
/// grows. In each of them Newton's method does the last iterations as soon as no further bond
/// breaks and the residual is small. A relaxed step in which nothing was damaged hands back.
///
/// Where the peak is searched, a relaxed step in which the force begins to fall is not accepted:
/// the steps halve what is left between the last state with a rising force and the first with a
/// falling one. The force is what does the work of the load's increment: that of the supports and
/// loads along their way.
class HandOver : public Driver {
 public:
  explicit HandOver(Path& path)
      : Driver(path), implicit_(path), relaxed_(path, RelaxedStepping::Finish::newton) {}

 protected:
  [[nodiscard]] Advance next() override;

 private:
  [[nodiscard]] Advance implicit_step();
  [[nodiscard]] Advance relaxed_step();
  /// Leaves a step in which the force begins to fall, and goes on with half of it.
  [[nodiscard]] bool cuts_to_peak(const RelaxedStepping::Found& found, bool falls);
  /// An implicit step has converged to a state that would damage bonds.
  [[nodiscard]] Advance approach_damage(const ImplicitStep& step);
  [[nodiscard]] Advance hand_over(const ImplicitStep& step, std::string reason);
  void hand_back();
  /// Equilibrium of the body itself at the load that its stand-in has reached.
  /// @param jump of the reactions, as a share of the largest
  [[nodiscard]] Advance take_up_body(double& jump);

  ImplicitStepping implicit_;
  RelaxedStepping relaxed_;
};

}  // namespace peristat
