#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "solvers/problem/consistency.hpp"
#include "solvers/problem/working_force.hpp"

namespace peristat {

/// Energies of a step that do not follow from the states before and after it [J].
struct StepEnergies {
  double released = 0.0;  ///< see Evaluation::released
  double heating = 0.0;   ///< see heating_work
  struct Relaxed {
    double work = 0.0;     ///< of supports, loads and heating
    double drained = 0.0;  ///< see RelaxationResult
  };
  std::optional<Relaxed> relaxed;  ///< summed over the iterations of relaxation
  /// On the way to step 0 without damage. Slow loading from rest does as much work as the body
  /// stores, however nonlinear it is; this is used in place of the trapezoidal rule.
  bool is_elastic_preload = false;
  /// Bonds broke one after the other under a fixed control: work in excess of the stored and
  /// dissipated energy counts as drained.
  bool is_avalanche = false;
  /// Stored in struts that were cut, part of what is dissipated. What the body then releases on its
  /// way to an equilibrium without them counts as in an avalanche.
  double struts = 0.0;
  /// State of the step before its points failed: the work is summed by way of this state, and
  /// heating up to it.
  struct Intact {
    std::vector<double> force, displacement;
  };
  std::optional<Intact> intact;
};

/// Energies of the accepted steps of a load path. A value.
///
/// External work is summed with the trapezoidal rule over each step, of the loads on the free and
/// of the reactions on the prescribed degrees of freedom, and of heating. Relaxation sums the work
/// over each of its iterations, too; the excess is the numerical work. The preload, which acts at
/// load 0, is applied slowly, see StepEnergies::is_elastic_preload.
struct PathLedger {
  Ledger entries;
  double released = 0.0;      ///< see Evaluation::released [J]
  double struts = 0.0;        ///< stored in struts when they were cut [J]
  std::vector<double> force;  ///< working force in the last accepted state [N]

  /// Begins in a state: the energy stored there counts as work that was done before.
  /// @param working see working_force
  void begin(const Trial& state, std::vector<double> working);

  /// Returns the entries after a step to a state whose damage is committed.
  /// @param dissipated by the bonds on the whole path, see DamageState [J]
  [[nodiscard]] Ledger with_step(const Sums& sums, std::span<const double> displacement_before,
                                 const Trial& state, std::span<const double> working,
                                 double dissipated, const StepEnergies& step) const;

  /// Accepts a step with its entries.
  void accept(const Ledger& with_step, std::vector<double> working, const StepEnergies& step);

  /// Checks whether an implicit step with growing damage has released energy that nothing takes up.
  /// A stable path balances, except for the little that single bonds release as they snap; beyond a
  /// limit point the search ends wherever its steps lead.
  /// @return a message; empty if it has not
  [[nodiscard]] std::string jump_to(const Ledger& with_step) const;
};

}  // namespace peristat
