#pragma once

#include <vector>

#include "src/core/types.hpp"
#include "src/materials/bond_constants.hpp"

namespace peristat {

/// Mean and extremes of a quantity over all directions.
struct DirectionalSpread {
  double mean = 0.0, least = 0.0, most = 0.0;
};

/// The bonds of a point deep inside a lattice, with the weights of make_bonds, and the properties
/// that they have per micromodulus c.
class BulkBonds {
 public:
  /// @param setting with a lattice
  explicit BulkBonds(const BondSetting& setting);

  /// sum w r^k / V over the bonds of a point of volume V [m^(k+3)].
  [[nodiscard]] double moment(int k) const;

  /// Bond area of a plane of normal n: if each bond across the plane holds the energy density phi,
  /// they hold A phi per area,
  ///
  ///   A(n) = 1/(2 V) sum w r^2 |n_bond . n|  [m^5].
  [[nodiscard]] double crossing(const Coordinates& normal) const;
  /// Bond area over all planes. The mean is exact; least and most are those of many planes, the
  /// lattice's own among them.
  [[nodiscard]] DirectionalSpread crossing() const;

  /// Young's modulus over c in a uniaxial pull along a direction; 0 if nothing resists it.
  [[nodiscard]] double youngs_modulus(const Coordinates& direction) const;

  /// Rotates a direction (not of unit length) from the lattice's axes to those of the body.
  [[nodiscard]] Coordinates turned(const Coordinates& of_lattice) const;

  /// One of each two opposite bonds, with both weights over V.
  struct Bond {
    Coordinates direction;
    double length, weight;
  };
  [[nodiscard]] const std::vector<Bond>& bonds() const { return bonds_; }

 private:
  template <class Quantity>
  [[nodiscard]] DirectionalSpread over_directions(const Quantity& of) const;
  void correct_energy();
  void find_compliance();
  [[nodiscard]] std::vector<double> strain_of_pull(const Coordinates& direction) const;

  BondSetting setting_;
  std::vector<Bond> bonds_;
  std::vector<double> compliance_;  // times c, Kelvin's notation
};

/// Micromodulus for Young's modulus E [Pa]: right in the mean over all directions of the lattice
/// with its corrections.
[[nodiscard]] double bulk_micromodulus(double youngs_modulus, const BondSetting& setting);

/// Mean bond area A over all planes [m^5], see BulkBonds::crossing: of the setting's lattice, or
/// <|n_x|> m_2 / 2 with the m_2 of its cloud or of the continuum. Bonds of a cloud are corrected:
/// by energy m_1 becomes that of the continuum, by volume m_0 that of a lattice.
[[nodiscard]] double mean_crossing(const BondSetting& setting);

}  // namespace peristat
