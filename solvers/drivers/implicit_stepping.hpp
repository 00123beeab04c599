#pragma once

#include <string>

#include "solvers/drivers/driver.hpp"
#include "solvers/drivers/found_step.hpp"
#include "solvers/drivers/increment.hpp"

namespace peristat {

/// An implicit step in progress.
struct ImplicitStep {
  LoadPoint target = 0.0;
  double attempted = 0.0;  ///< see Increment::length
  Attempt attempt;
  DamageGrowth growth;  ///< that a commit of the first search's state would bring
  FoundStep found;
  std::string fault;        ///< details of a failure beside its outcome
  std::string avalanche;    ///< description of one; empty if there was none
  bool has_pinned = false;  ///< further degrees of freedom than before
  int hardest = 0;          ///< most iterations of one of its searches
};

/// Implicit steps. A step that fails is cut and tried again; after an easy one the next may grow.
class ImplicitStepping : public Driver {
 public:
  explicit ImplicitStepping(Path& path);

  /// Follows an avalanche under a control, if no equilibrium is found along with the damage. At the
  /// next value of the control equilibria are found with held integrities, and overstretched bonds
  /// are damaged, until there is none.
  void run_avalanche(ImplicitStep& step);
  /// Searches the equilibrium of the next step.
  /// @param damage whether it may grow in the step
  [[nodiscard]] ImplicitStep search(Damage damage);
  /// Commits the damage of a converged state, and checks it: the step may still fail.
  void establish(ImplicitStep& step);
  [[nodiscard]] Advance accept(ImplicitStep step);
  /// Cuts the step, or ends the path.
  [[nodiscard]] Advance fail(ImplicitStep step);

  [[nodiscard]] Increment& increment() { return increment_; }

 protected:
  [[nodiscard]] Advance next() override;

 private:
  /// Cuts a step of the preload that damages the body, so that its work is summed in steps.
  [[nodiscard]] bool refines_preload(const ImplicitStep& step);
  /// Cuts a step beyond the load that points bear: all overloaded points fail together, so that a
  /// coarse step would break points that fine ones never overload. Likewise for bonds that break at
  /// once by release. Bonds that soften are at what they bear in every step.
  [[nodiscard]] bool approach_failure(const ImplicitStep& step);
  [[nodiscard]] bool is_limit_point(const Attempt& attempt) const;
  /// Pins what failing points leave loose, before the equilibrium is searched again.
  [[nodiscard]] Outcome pin_loose(const State& at, ImplicitStep& step);
  [[nodiscard]] bool may_be_avalanche(const ImplicitStep& step) const;
  static void name_snap_back(ImplicitStep& step);

  Increment increment_;
};

/// Describes why a step has failed, with its negative pivots.
[[nodiscard]] std::string reason_of(const ImplicitStep& step);

/// "1 bond", "2 bonds"
[[nodiscard]] std::string bonds_text(Index count);

}  // namespace peristat
