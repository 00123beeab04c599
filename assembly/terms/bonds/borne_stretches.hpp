#pragma once

#include <limits>
#include <span>
#include <vector>

#include "assembly/energy/state.hpp"
#include "assembly/terms/model.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Stretch that each bond bears before it is damaged (further) after a history; infinite for bonds
/// that are broken, never fail or have no weight. Empty for a model without damage.
[[nodiscard]] std::vector<double> borne_stretches(const Model& model, const History& history);

/// Whether all bonds that fail do so by drops of their stiffness, elastic in between.
[[nodiscard]] bool fails_by_steps(const Model& model);

/// A bond and its stretch over what it bears.
struct UtilisedBond {
  Offset bond = 0;
  Index first_point = 0;
  double utilisation = 0.0, stretch = 0.0;
};

/// Stiffness along its direction that a bond has lost.
struct LostStiffness {
  Offset bond = 0;
  Index first = 0, second = 0;  ///< its points
  Coordinates direction{};      ///< from the one to the other, now
  double stiffness = 0.0;       ///< [N/m]
};

/// Drops of stiffness of some bonds at a state: each leaves what it bears, for good.
struct BondDrops {
  std::vector<double> histories{};  ///< of all bonds, after the drops
  std::vector<double> borne{};      ///< likewise, see borne_stretches
  Index breaking = 0;               ///< of the bonds, those that lose all
  double energy_lost = 0.0;         ///< that the bonds stored at the state and no longer do [J]
  double dissipated = 0.0;          ///< by the laws [J]
  std::vector<LostStiffness> stiffness{};
};

/// @param borne after the history
/// @param bonds that drop
[[nodiscard]] BondDrops drop(const Points& points, const Model& model, const StateView& at,
                             std::span<const double> borne, std::span<const UtilisedBond> bonds);

/// Bonds that are utilised by at least so much, most utilised first, then by their numbers.
/// @param borne see borne_stretches
[[nodiscard]] std::vector<UtilisedBond> utilised_bonds(const Points& points, const Model& model,
                                                       const StateView& at,
                                                       std::span<const double> borne, double least,
                                                       int threads);

/// How far a state may move along a direction until bonds reach a share of what they bear, by the
/// rates of their stretches: every bond is within it from `low` to `high`. Where low > high there
/// is no such place.
struct AdmissibleRange {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  double utilisation = 0.0;  ///< the largest at the state itself
};

/// @param rate of the displacement, per unit of the way
/// @param eigenstretch_rate per point, or empty
/// @param share of what they bear
[[nodiscard]] AdmissibleRange admissible_range(const Points& points, const Model& model,
                                               const StateView& at, std::span<const double> borne,
                                               std::span<const double> rate,
                                               std::span<const double> eigenstretch_rate,
                                               double share, int threads);

/// Largest utilisation of any bond.
[[nodiscard]] double largest_utilisation(const Points& points, const Model& model,
                                         const StateView& at, std::span<const double> borne,
                                         int threads);

}  // namespace peristat
