#pragma once

#include <utility>
#include <vector>

#include "solvers/motion/motion_setting.hpp"

namespace peristat {

/// Exact effect of a drag with the rate eta on a velocity in a step dt, with x = eta dt:
///
///   decay = exp(-x),   phi1 = (1 - exp(-x)) / x,   phi2 = (1 - phi1) / x
///
/// These are the functions of exponential integrators [Cox and Matthews 2002]: under a constant
/// acceleration a, dv/dt = a - eta v has the solution
///
///   v(dt) = decay v + phi1 dt a,   u(dt) = u + phi1 dt v + phi2 dt^2 a
///
/// Without a drag decay = phi1 = 1, phi2 = 1/2.
struct DragFactors {
  double decay = 1.0, phi1 = 1.0, phi2 = 0.5;
  double lost = 0.0;  ///< 1 - decay, to full precision

  DragFactors() = default;
  /// @param x eta dt, not negative
  explicit DragFactors(double x);
};

/// Degrees of freedom in absorbing layers, with the factors of their drag in a step.
class Drag {
 public:
  struct Entry {
    Index dof;
    double rate;  ///< [1/s]
    DragFactors factors{};
  };

  /// @param dofs free degrees of freedom, in their order
  Drag(const MotionSetting& setting, const std::vector<Index>& dofs);

  void set_step(double dt);
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }

  /// Calls visit(dof, factors) for each degree of freedom; factors without drag are the defaults.
  /// @param dofs as in the constructor
  template <class Visit>
  void for_each(const std::vector<Index>& dofs, const Visit& visit) const {
    const DragFactors none;
    auto next = entries_.begin();
    for (const Index dof : dofs) {
      if (next != entries_.end() && next->dof == dof) {
        visit(dof, std::as_const(next->factors));
        ++next;
      } else {
        visit(dof, none);
      }
    }
  }

 private:
  std::vector<Entry> entries_;
  double dt_ = 0.0;
};

}  // namespace peristat
