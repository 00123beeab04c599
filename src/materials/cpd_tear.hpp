#pragma once

#include <array>
#include <vector>

#include "src/core/types.hpp"
#include "src/materials/bulk_bonds.hpp"
#include "src/materials/cpd_constants.hpp"
#include "src/potentials/any_law.hpp"

namespace peristat {

/// Energy of a plane tear in the lattice of a body of one-, two- and three-neighbour interactions,
/// far from its surfaces: its halves move apart rigidly along the plane's normal n, by u from 0
/// until no bond across is left. A triangle or tetrahedron across the plane takes the work of its
/// force,
///
///   int T dpsi = -int psi dT,   T(u) = the product of the integrities of its bonds,
///
/// which equals the energy that it releases as it loses its bonds: commits of ever smaller steps of
/// u give the same. Per area each kind of triangle or tetrahedron, up to translations, occurs as
/// often as the plane can stand between its points,
///
///   G(n) = C1 A(n) M(s_c) + sum over kinds w/V sum over places (width along n) int T dpsi  [J/m2].
///
/// The mean over all directions of n is exact for bonds (see BulkBonds::crossing). For triangles
/// and tetrahedra it is that of sector_directions.
class CpdTear {
 public:
  CpdTear(const Kernel& kernel, double spacing, const CpdConstants& constants);

  /// G(n) [J/m2]
  [[nodiscard]] double energy(const AnyLaw& law, const Coordinates& normal) const;
  [[nodiscard]] double mean_energy(const AnyLaw& law) const;
  /// The mean, and the least and the most over its directions, the axes and the diagonals.
  [[nodiscard]] DirectionalSpread spread(const AnyLaw& law) const;

  /// Number of quadrature points that one mean takes for a law.
  [[nodiscard]] double quadrature_points(const AnyLaw& law) const;

  /// True if there are no triangles and tetrahedra: G is then C1 A(n) M(s_c).
  [[nodiscard]] bool is_of_bonds_alone() const { return triangles_.empty() && tetrahedra_.empty(); }

  /// Mean A of the bonds [m5].
  [[nodiscard]] double mean_crossing() const;

 private:
  /// Points of a triangle or tetrahedron, and twice the energy that it would hold under a relative
  /// change of 1.
  template <int points>
  struct Simplex {
    std::array<Coordinates, points> at;  // in spacings
    double energy;                       // w |M| C spacing / V [J/m2]
  };
  struct Bond {
    Coordinates arm;           // in spacings
    double length, influence;  // in spacings, and omega
  };

  [[nodiscard]] double of_bonds(const AnyLaw& law, const Coordinates& normal) const;
  [[nodiscard]] double of_simplices(const AnyLaw& law, const Coordinates& normal) const;

  int dimension_;
  std::vector<Bond> bonds_;  // one of each two opposite ones
  double bond_energy_;       // w C1 spacing^2 / V [J/m2]
  double c1_;
  std::vector<Simplex<3>> triangles_;
  std::vector<Simplex<4>> tetrahedra_;
};

/// Limits of the quadrature of a tear of triangles or tetrahedra, above which it takes minutes:
/// most points with which a stretch is found, and largest horizon / spacing.
inline constexpr double most_quadrature_points_of_tear = 1e8;
[[nodiscard]] constexpr double largest_ratio_of_tear(int dimension) {
  return dimension == 2 ? 12.0 : 3.2;
}

}  // namespace peristat
