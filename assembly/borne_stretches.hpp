#pragma once

#include <limits>
#include <span>
#include <vector>

#include "assembly/assembler.hpp"
#include "assembly/energy/state.hpp"
#include "assembly/terms/bond_drive.hpp"
#include "assembly/terms/model.hpp"

namespace peristat {

/// Stretch beyond which each bond is damaged (further) after a history: its current strength, for
/// bonds that fail by release as an equivalent stretch. Infinite for bonds that are broken, never
/// fail or have no weight. Empty for a model without damage.
[[nodiscard]] std::vector<double> borne_stretches(const Model& model, const History& history);

/// True if all bonds that fail do so by drops of their stiffness and are elastic in between.
[[nodiscard]] bool fails_by_steps(const Model& model);

/// A bond with its (equivalent) stretch and its utilisation, the stretch over the borne one.
struct UtilisedBond {
  Offset bond = 0;
  Index first_point = 0;
  double utilisation = 0.0, stretch = 0.0;
};

/// Stiffness and force that a bond has lost along its direction.
struct LostStiffness {
  Offset bond = 0;
  Index first = 0, second = 0;  ///< its points
  Coordinates direction{};      ///< from first to second, current unit vector
  double stiffness = 0.0;       ///< [N/m]
  double force = 0.0;           ///< tension [N]
};

/// Irreversible drops of stiffness of some bonds at a state.
struct BondDrops {
  std::vector<double> histories{};  ///< of all bonds, after the drops
  std::vector<double> borne{};      ///< likewise, see borne_stretches
  Index breaking = 0;               ///< bonds among them that break completely
  double energy_lost = 0.0;         ///< stored energy that the bonds lose at the state, and by
                                    ///< release all that hangs on them [J]
  double dissipated = 0.0;          ///< by the laws [J]
  std::vector<LostStiffness> stiffness{};  ///< empty by release, where others lose stiffness, too
};

/// @param borne borne stretches after the history
/// @param bonds that drop, all at once
[[nodiscard]] BondDrops drop(Assembler& body, const StateView& at, std::span<const double> borne,
                             std::span<const UtilisedBond> bonds);

/// Bonds with at least this utilisation, most utilised first, then by their numbers.
/// @param borne see borne_stretches
[[nodiscard]] std::vector<UtilisedBond> utilised_bonds(Assembler& body, const StateView& at,
                                                       std::span<const double> borne, double least);

/// Range of steps along a direction, [low, high], in which no bond exceeds a share of its borne
/// stretch by the rate of its stretch. Empty where low > high.
struct AdmissibleRange {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  double utilisation = 0.0;  ///< the largest at the state itself
};

/// Steps in which a bond by release is driven by no more than a limit. If it is driven by more at
/// the state itself, the nearest such steps on the side on which the drive falls.
/// @param limit equivalent stretch, positive
[[nodiscard]] AdmissibleRange admissible_range(const BondDrive& drive, double limit);

/// @param rate of the displacement, per unit of the step
/// @param eigenstretch_rate per point, or empty
/// @param share of the borne stretches
/// @param among these bonds; empty for all
[[nodiscard]] AdmissibleRange admissible_range(Assembler& body, const StateView& at,
                                               std::span<const double> borne,
                                               std::span<const double> rate,
                                               std::span<const double> eigenstretch_rate,
                                               double share,
                                               std::span<const UtilisedBond> among = {});

/// Largest utilisation of any bond.
[[nodiscard]] double largest_utilisation(Assembler& body, const StateView& at,
                                         std::span<const double> borne);

}  // namespace peristat
