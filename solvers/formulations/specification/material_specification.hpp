#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "assembly/terms/failure/damage_drive.hpp"
#include "src/core/types.hpp"
#include "src/materials/bond_constants.hpp"
#include "src/materials/peak_factors.hpp"
#include "src/materials/random_field.hpp"
#include "src/materials/strength_surface.hpp"
#include "src/neighbourhood/influence.hpp"
#include "src/potentials/potential.hpp"

namespace peristat {

/// Bond-based, continuum-kinematics-inspired, or ordinary state-based peridynamics, or the linear
/// peridynamic solid; by convolutions alone also bonds with the difference of squared lengths, and
/// a correspondence material.
enum class MaterialModel { bond, cpd, state, lps, green_bond, correspondence };

/// Where constants from E and nu are exact.
enum class Calibration { lattice, continuum };

/// Do bonds stretch by their lengths, or by the displacements along them at rest?
enum class Kinematics { finite, linear };

/// How forces are summed: bond by bond, which is done along rows of alike points where there are
/// any; in that way or not at all; or by convolutions on a lattice.
enum class ForceOperator { automatic, bonds, stencil, fft };

/// Law by which bonds, or points, fail.
enum class DamageLaw {
  none,
  energy_density,  ///< points fail if their energy density exceeds fracture_energy / (2 horizon)
  critical_stretch,
  tanh,
  tanh_continuous,
  linear,
  exponential,
  blended,
  table,       ///< the force is a given curve
  bilinear,    ///< by the opening of a crack, see OpeningLaw
  cornelissen  ///< likewise
};

/// Stretches of a law of bonds; those of `critical_stretch` are equal.
struct LawStretches {
  double onset = 0.0, critical = 0.0;
};

inline constexpr std::array<double, 2> usual_strength_factor{0.2, 100.0};

/// What becomes of bonds that still join the faces of an open crack, see Struts.
enum class StrutRemedy { keep, cut };

/// Whether bonds that are damaged still bear compression.
enum class Compression { lost, kept };

struct DamageSpecification {
  DamageLaw law = DamageLaw::none;
  double onset = 0.0;                  ///< s_m, of the laws that soften
  double critical = 0.0;               ///< s_c
  double rate = 3.0;                   ///< beta of the tanh laws, a of the exponential one
  std::vector<std::string> no_fail{};  ///< sets whose points' bonds never fail
  double peak = 0.0;                   ///< s_p, of the blended law
  double hardening = 0.5;              ///< h, of the blended law
  /// Pairs of the law table: stretches, ascending, and forces over the constant c; see ForceTable.
  std::vector<double> stretches{}, forces{};
  /// In the place of `critical`: fracture energy of a plane crack, the mean over its directions
  /// [J/m2].
  std::optional<double> fracture_energy{};
  /// In the place of `fracture_energy`: toughness K_Ic of a plane crack, see with_fracture_energy
  /// [Pa sqrt(m)].
  std::optional<double> fracture_toughness{};
  /// In the place of `onset` (of `critical` for the law critical_stretch): largest stress of the
  /// bulk under a pull, see with_stretches [Pa].
  std::optional<double> strength{};
  /// Surface of the stresses at which a body without flaws fails, through `strength` and, if it
  /// needs another one, one of these; see StrengthOnsets [Pa].
  StrengthCriterion strength_surface = StrengthCriterion::none;
  std::optional<double> compressive_strength{}, biaxial_strength{};
  std::array<double, 2> strength_factor = usual_strength_factor;  ///< range of chi
  /// With a surface also `strength`, which the stretches replace, and factors of the peak, found
  /// with them; otherwise none.
  double strength_of_peak = 0.0;
  std::shared_ptr<const PeakFactors> peak_factors{};
  /// What drives the damage; none: see Formulation::default_drive.
  std::optional<DamageDrive> drive{};
  StrutRemedy struts = StrutRemedy::keep;
  Compression compression = Compression::lost;
  /// True if the stretches were computed from a fracture energy: those of a bond then depend on the
  /// horizons of its points, and these are for the body's horizon.
  bool is_by_energy = false;
  /// Stretches by horizon, see stretches_of; empty: proportional to the root of 1 / horizon.
  std::vector<LawStretches> of_horizons{};

  [[nodiscard]] constexpr bool has_fracture_energy() const {
    return fracture_energy || fracture_toughness;
  }
  [[nodiscard]] constexpr bool has_surface() const {
    return strength_surface != StrengthCriterion::none;
  }
  /// That surface, where there is one.
  [[nodiscard]] StrengthSurface surface() const {
    const double tension = strength.value_or(strength_of_peak);
    const double compressive = biaxial_strength
                                   ? peristat::compressive_strength(tension, *biaxial_strength)
                                   : compressive_strength.value_or(0.0);
    return {strength_surface, tension, compressive};
  }
  /// True if some stretches are still to be computed from these data.
  [[nodiscard]] bool is_by_data() const {
    return law != DamageLaw::energy_density && (has_fracture_energy() || strength);
  }

  /// True if bonds break one by one, by their stretches.
  [[nodiscard]] bool breaks_bonds() const {
    return law != DamageLaw::none && law != DamageLaw::energy_density;
  }
  /// True if stiffness is lost over a range of stretches.
  [[nodiscard]] bool softens() const {
    return breaks_bonds() && law != DamageLaw::critical_stretch;
  }
  /// True if the law has a rate.
  [[nodiscard]] bool has_rate() const {
    return law == DamageLaw::tanh || law == DamageLaw::tanh_continuous ||
           law == DamageLaw::exponential;
  }
  /// True if the force follows from the opening of a crack.
  [[nodiscard]] bool opens() const {
    return law == DamageLaw::bilinear || law == DamageLaw::cornelissen;
  }
  /// Softening curve of a law that opens.
  [[nodiscard]] OpeningCurve opening_curve() const {
    return law == DamageLaw::bilinear ? OpeningCurve::bilinear : OpeningCurve::cornelissen;
  }
  /// Limit of the onset over the critical stretch of a law that softens, which it stays below.
  [[nodiscard]] double largest_onset() const {
    return (opens() ? largest_onset_of(opening_curve()) : 1.0) * (1.0 - 1e-9);
  }
  /// Fraction of the range from onset to critical over which the force rises.
  [[nodiscard]] double rise() const {
    return law == DamageLaw::blended ? (peak - onset) / (critical - onset) : 0.0;
  }
};

/// Fibres. The moduli and stretches of the material hold along them, the members here across them.
struct FibreSpecification {
  double angle = 0.0;                           ///< 2D: against the x axis [degrees]
  Coordinates direction{};                      ///< 3D, of any length
  double transverse_modulus = 0.0;              ///< Young's modulus across the fibres [Pa]
  std::optional<double> shear_modulus{};        ///< [Pa]; none: natural_shear
  std::optional<double> transverse_critical{};  ///< s_c of bonds across; none: as along
};

/// Factor of the bonds, the mean of the factors of their two points: random, or given at the
/// points.
struct ScatterSpecification {
  enum class Quantity { stiffness, strength };
  enum class Distribution { weibull };
  Quantity of = Quantity::stiffness;  ///< scales their constants, or all stretches of their law
  Distribution distribution = Distribution::weibull;
  WeibullField field{};
  std::string factor{};  ///< expression of place and the points' columns; empty: random
};

struct MaterialSpecification {
  MaterialModel model = MaterialModel::bond;
  std::string potential = Harmonic::name;  ///< of undamaged bonds, see WholeBondPotentials
  PlaneState plane = PlaneState::stress;
  Kinematics kinematics = Kinematics::finite;  ///< of bonds; lps is always linear
  /// omega of bonds, see Influences. For lps with the form `energy` it is its kernel K; the form
  /// collocation always has the inverse one.
  std::string influence = ConstantInfluence::name;
  std::optional<double>
      youngs_modulus{};                   ///< [Pa]; exactly one of this, micromodulus and c1 is set
  std::optional<double> micromodulus{};   ///< c [N/m6]
  std::optional<double> poisson_ratio{};  ///< cpd, lps, correspondence, with youngs_modulus
  double stabilisation = 0.5;             ///< G_s of correspondence, see Correspondence
  std::optional<double> c1{};             ///< C1 [N/m6]
  double c2 = 0.0;                        ///< C2 [N/m10]; in 2D not with youngs_modulus
  double c3 = 0.0;                        ///< C3 [N/m14]; with c1 only
  /// None: on the lattice for cpd; others have the published constants of the continuum.
  std::optional<Calibration> calibration{};
  std::optional<double> thermal_expansion{};  ///< [1/K]
  std::optional<double> density{};            ///< [kg/m3], for gravity and dynamics
  DamageSpecification damage{};
  std::optional<FibreSpecification> fibre{};  ///< bonds with youngs_modulus, the one along them
  std::vector<ScatterSpecification> scatter{};

  [[nodiscard]] bool has_constants() const { return youngs_modulus || micromodulus || c1; }
};

}  // namespace peristat
