#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "solvers/problem/consistency.hpp"
#include "solvers/problem/working_force.hpp"

namespace peristat {

/// What a step has turned over, beside what follows from the states before and after it [J].
struct StepEnergies {
  double released = 0.0;  ///< see Evaluation::released
  double heating = 0.0;   ///< see heating_work
  struct Relaxed {
    double work = 0.0;     ///< of supports, loads and heating
    double drained = 0.0;  ///< see RelaxationResult
  };
  std::optional<Relaxed> relaxed;  ///< summed over the iterations of relaxation
  /// On the way to step 0 without damage. A slow way from rest works as much as the body stores,
  /// however nonlinear it is, so that this is the work, not the trapezoidal rule's.
  bool is_elastic_preload = false;
  /// Bonds broke one after the other under a control that stood still: what the work is more than
  /// what is stored and dissipated counts as drained.
  bool is_avalanche = false;
  /// Where the step had come to before its points failed: it has worked, and been heated, up to
  /// there.
  struct Intact {
    std::vector<double> force, displacement;
  };
  std::optional<Intact> intact;
};

/// Energies of the accepted steps of a load path. A value.
///
/// External work is summed with the trapezoidal rule over each step, of the loads on the free and
/// of the reactions on the prescribed degrees of freedom, and of heating. Relaxation sums the work
/// over each of its iterations, too: what that is more is the numerical work. What acts at load 0
/// is put on slowly, see StepEnergies::is_elastic_preload.
struct PathLedger {
  Ledger entries;
  double released = 0.0;      ///< by triangles and tetrahedra whose bonds were damaged [J]
  std::vector<double> force;  ///< that does work, in the last accepted state [N]

  /// Begins in a state: what is stored there counts as work that was done before.
  /// @param working see working_force
  void begin(const Trial& state, std::vector<double> working);

  /// The entries with a step to a state whose damage is committed.
  /// @param dissipated by the bonds on the whole path, see DamageState [J]
  [[nodiscard]] Ledger with_step(const Sums& sums, std::span<const double> displacement_before,
                                 const Trial& state, std::span<const double> working,
                                 double dissipated, const StepEnergies& step) const;

  /// Takes up a step that was accepted, with its entries.
  void accept(const Ledger& with_step, std::vector<double> working, const StepEnergies& step);

  /// Whether an implicit step in which damage grew has released what nobody takes up. A stable path
  /// balances, but for the little that single bonds release as they snap; beyond a limit point the
  /// search lands where its steps happen to lead.
  /// @return a sentence for a person; empty if it has not
  [[nodiscard]] std::string jump_to(const Ledger& with_step) const;
};

}  // namespace peristat
