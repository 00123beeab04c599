#pragma once

#include <string>

#include "solvers/drivers/implicit_stepping.hpp"
#include "solvers/drivers/relaxed_stepping.hpp"

namespace peristat {

/// Takes implicit steps until one would damage a bond (further). That step is cut to the load at
/// which damage begins, interpolated in the utilisation of the bonds; then relaxation takes over,
/// from the last accepted state. Relaxation goes on in steps of its own while damage grows. In each
/// of them Newton's method does the last iterations as soon as no further bond breaks and the
/// residual is small. After a relaxed step without damage implicit steps go on.
///
/// If the peak is searched, a relaxed step in which the force begins to fall is not accepted: the
/// steps halve the interval between the last state with a rising force and the first with a falling
/// one. This force is conjugate to the increment of the displacements: it consists of reactions and
/// loads.
class HandOver : public Driver {
 public:
  explicit HandOver(Path& path)
      : Driver(path), implicit_(path), relaxed_(path, RelaxedStepping::Finish::newton) {}

 protected:
  [[nodiscard]] Advance next() override;

 private:
  [[nodiscard]] Advance implicit_step();
  [[nodiscard]] Advance relaxed_step();
  /// Drops a step in which the force begins to fall, and goes on with half of it.
  [[nodiscard]] bool cuts_to_peak(const RelaxedStepping::Found& found, bool falls);
  /// Handles an implicit step that has converged to a state that would damage bonds.
  [[nodiscard]] Advance approach_damage(const ImplicitStep& step);
  [[nodiscard]] Advance hand_over(const ImplicitStep& step, std::string reason);
  void hand_back();
  /// Searches the equilibrium of the body itself at the load that its stand-in (surrogate model)
  /// has reached.
  /// @param jump change of the reactions, as a fraction of the largest
  [[nodiscard]] Advance take_up_body(double& jump);

  ImplicitStepping implicit_;
  RelaxedStepping relaxed_;
};

}  // namespace peristat
