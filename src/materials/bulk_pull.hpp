#pragma once

#include <array>
#include <functional>
#include <vector>

#include "src/core/types.hpp"
#include "src/materials/bulk_bonds.hpp"
#include "src/materials/cpd_constants.hpp"
#include "src/materials/lattice_directions.hpp"
#include "src/potentials/any_law.hpp"

namespace peristat {

/// The stress that a body is under.
enum class Loading {
  tension,  ///< along one direction n, all others free
  biaxial,  ///< equal in all directions normal to n (in 2D in both)
  shear,    ///< equal tension and compression along two directions
  compression,
};

/// Onsets that follow the strain until a bond starts, as a strength surface moves them. With the
/// largest (equivalent) stretch m of unbroken bonds a bond starts at m / rho, once another one has
/// started at no more than the onset of its law, and the law keeps its work.
struct MovingOnsets {
  std::function<double(const std::array<double, 3>& strains)> utilisation;  ///< rho
  std::array<double, 2> range{};  ///< of the onset over that of the law
};

/// Response of a point deep inside a lattice to a homogeneous stress that grows: the strength of a
/// body without flaws.
///
/// The stress is lambda S with a fixed form S. Its strain along S, e = S : eps, grows step by step;
/// lambda and the rest of the small strain eps follow from
///
///   sum a_b T_b s_b n_b n_b + sum a_t (product of the T of the sides) (M : eps) M = lambda S,
///
/// s_b = n_b . eps n_b the stretches, T their integrities, which never grow, a_b = c w L / (2 V)
/// summed over the bonds of one direction. The second sum is over triangles and tetrahedra of cpd:
/// M is the derivative of their relative area or volume, a_t = w |A| C_2 / V and w |V| C_3 / V.
/// The strength is the largest lambda on the way. In plane strain it is the stress in the plane.
///
/// Bonds of states (see StateTerm) that lose their integrity by what this releases have the stress
/// sum a_b T_b (s_b + zeta theta / 2) n_b n_b with zeta = 2 (lambda - mu) / ((d + 2) mu) and theta
/// = d (sum a_b T_b s_b) / sum a_b, and T_b depends on s_eq, s_eq^2 = s_b (s_b + zeta theta) where
/// s_b > 0. Of brittle bonds the whole drop counts, so that zeta d kappa r^2 s_b^2 / (2 M) is
/// subtracted. With zeta = 0, as of bonds, s_eq is s_b.
///
/// Bonds of cpd by release (see SimplexTerm) have
///
///   s_eq^2 = s_b^2 + sum over t on b of (a_t / a_b) (M : eps)^2 (product of the T of the other
///            sides)  where s_b > 0,
///
/// so that each bond counts by itself, not only its direction.
///
/// Directions n are those of sector_directions for square and cubic lattices, otherwise 24 (2D) or
/// 60 (3D) that are spread evenly. Without a lattice, or with more than most_directions of bonds
/// (of bonds of states: more bonds), the bonds' directions are spread evenly, too, with the
/// stiffness of the continuum or the lattice.
class BulkPull {
 public:
  /// @param lame_ratio lambda/mu of states; 1: bonds
  BulkPull(const BondSetting& setting, double micromodulus, double lame_ratio = 1.0);
  /// @param by_release what drives the bonds of cpd; otherwise their stretch
  BulkPull(const Kernel& kernel, double spacing, const CpdConstants& constants,
           bool by_release = false);

  /// Largest stress [Pa]; not for compression, under which bonds along it never fail. Infinite if
  /// the stress drives no bond, as equal tension does with lambda = 0, or any with bonds of states
  /// that are auxetic.
  [[nodiscard]] DirectionalSpread peak(Loading loading, const AnyLaw& law) const;

  /// Stress at which the bond that is driven most reaches the onset of the law [Pa]; infinite
  /// likewise.
  [[nodiscard]] DirectionalSpread onset(Loading loading, const AnyLaw& law) const;

  /// The same under stresses of a fixed ratio along two normal directions, the mean over these
  /// [Pa].
  /// @param moving null: onsets are the law's
  [[nodiscard]] double onset(const std::array<double, 2>& principal, const AnyLaw& law,
                             const MovingOnsets* moving = nullptr) const;
  [[nodiscard]] double peak(const std::array<double, 2>& principal, const AnyLaw& law,
                            const MovingOnsets* moving = nullptr) const;

  static constexpr std::size_t most_directions = 400;

  /// True if a strength takes seconds; for cpd in 3D it takes minutes at horizon ratios of 3.
  [[nodiscard]] bool is_quick() const;

 private:
  /// Symmetric, in Kelvin's notation: off-diagonal entries times sqrt(2).
  using Tensor = std::array<double, 6>;

  /// All bonds of a direction; by release two opposite ones.
  struct Fibre {
    Tensor dyad;
    double stiffness;   // [Pa]
    double drop = 0.0;  // zeta d kappa r^2 / (2 M)
  };
  /// All triangles or tetrahedra with the same sides.
  struct Simplex {
    std::array<int, 6> side;  // numbers of fibres
    double stiffness;         // [Pa]
  };
  struct Simplices {
    int sides;
    Tensor measure;
    std::vector<Simplex> all;
  };
  struct Form {
    Tensor tensor;
    double weight;  // in a mean over all forms
  };
  struct State;
  class Equilibrium;

  void spread_evenly(double first_moment);
  [[nodiscard]] std::vector<Form> forms(Loading loading) const;
  [[nodiscard]] double peak(const Tensor& form, const AnyLaw& law,
                            const MovingOnsets* moving = nullptr) const;
  [[nodiscard]] double onset(const Tensor& form, const AnyLaw& law,
                             const MovingOnsets* moving = nullptr) const;
  template <class Quantity>
  [[nodiscard]] DirectionalSpread over(Loading loading, const Quantity& of_form) const;
  template <class Quantity>
  [[nodiscard]] double mean(const std::array<double, 2>& principal, const Quantity& of_form) const;

  int dimension_;
  double zeta_ = 0.0;
  bool releases_simplices_ = false;  // bonds are driven by triangles and tetrahedra, too
  std::vector<Fibre> fibres_;
  std::vector<Simplices> simplices_;  // grouped by measure
  std::vector<WeightedDirection> directions_;
};

}  // namespace peristat
