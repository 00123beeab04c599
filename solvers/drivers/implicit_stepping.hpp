#pragma once

#include <string>

#include "solvers/drivers/driver.hpp"
#include "solvers/drivers/found_step.hpp"
#include "solvers/drivers/increment.hpp"

namespace peristat {

/// An implicit step on its way.
struct ImplicitStep {
  LoadPoint target = 0.0;
  double attempted = 0.0;  ///< see Increment::length
  Attempt attempt;
  DamageGrowth growth;  ///< that committing what the first search has found would bring
  FoundStep found;
  std::string fault;        ///< what is known of a failure beside its outcome
  std::string avalanche;    ///< what is told of one; empty if there was none
  bool has_pinned = false;  ///< more than was pinned before
};

/// Implicit steps. One that fails is cut and tried again; an easy one lets the next grow.
class ImplicitStepping : public Driver {
 public:
  explicit ImplicitStepping(Path& path);

  /// Under a control, where no equilibrium is found along with the damage: at the next value of the
  /// control equilibria are found with the integrities held, and damaged where they are
  /// overstretched, until none is.
  void run_avalanche(ImplicitStep& step);
  /// Searches the equilibrium of the next step.
  /// @param damage whether it may grow in it
  [[nodiscard]] ImplicitStep search(Damage damage);
  /// Commits the damage of a state that was found, and checks it: it may still fail.
  void establish(ImplicitStep& step);
  [[nodiscard]] Advance accept(ImplicitStep step);
  /// Cuts, or stops.
  [[nodiscard]] Advance fail(ImplicitStep step);

  [[nodiscard]] Increment& increment() { return increment_; }

 protected:
  [[nodiscard]] Advance next() override;

 private:
  /// Cuts a step of the preload that damages the body: its work is found in steps.
  [[nodiscard]] bool refines_preload(const ImplicitStep& step);
  /// Cuts a step beyond the load that points bear: all that are overloaded fail together, so that
  /// coarse steps would take down what fine ones never load.
  [[nodiscard]] bool approach_failure(const ImplicitStep& step);
  [[nodiscard]] bool is_limit_point(const Attempt& attempt) const;
  /// Pins what failing points leave loose before its equilibrium is searched for again.
  [[nodiscard]] Outcome pin_loose(const State& at, ImplicitStep& step);
  [[nodiscard]] bool may_be_avalanche(const ImplicitStep& step) const;
  static void name_snap_back(ImplicitStep& step);

  Increment increment_;
};

/// Why a step has failed, with its pivots.
[[nodiscard]] std::string reason_of(const ImplicitStep& step);

/// "1 bond", "2 bonds"
[[nodiscard]] std::string bonds_text(Index count);

}  // namespace peristat
