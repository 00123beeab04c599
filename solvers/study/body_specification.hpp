#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "assembly/terms/collocation/collocation_network.hpp"
#include "src/conditions/conditions.hpp"
#include "src/conditions/constraint_specification.hpp"
#include "src/connectivity/crack.hpp"
#include "src/geometry/body_boundary.hpp"
#include "src/geometry/point_set.hpp"
#include "src/materials/bond_constants.hpp"
#include "src/materials/effective_volumes.hpp"
#include "src/materials/interface_rule.hpp"
#include "src/materials/quadrature.hpp"
#include "src/materials/random_field.hpp"
#include "src/neighbourhood/influence.hpp"
#include "src/potentials/potential.hpp"

namespace peristat {

/// Bond-based, continuum-kinematics-inspired peridynamics, or the linear peridynamic solid; by
/// convolutions alone also bonds with the difference of squared lengths, and a correspondence
/// material.
enum class MaterialModel { bond, cpd, lps, green_bond, correspondence };

/// True if a model's constants are those of bonds.
constexpr bool has_bonds(MaterialModel model) {
  return model == MaterialModel::bond || model == MaterialModel::green_bond;
}

/// True if they are those of an isotropic continuum.
constexpr bool has_lame_constants(MaterialModel model) {
  return model == MaterialModel::lps || model == MaterialModel::correspondence;
}

/// True if forces are polynomials of displacements, which only convolutions can sum.
constexpr bool is_polynomial(MaterialModel model) {
  return model == MaterialModel::green_bond || model == MaterialModel::correspondence;
}

/// Where constants from E and nu are exact.
enum class Calibration { lattice, continuum };

/// Do bonds stretch by their lengths, or by the displacements along them at rest?
enum class Kinematics { finite, linear };

/// How forces of linear kinematics are summed: bond by bond, or by convolutions on a lattice.
enum class ForceOperator { automatic, bonds, fft };

/// Law by which bonds, or points, fail.
enum class DamageLaw {
  none,
  energy_density,  ///< points fail if their energy density exceeds fracture_energy / (2 horizon)
  critical_stretch,
  tanh,
  tanh_continuous,
  linear,
  exponential,
  blended
};

struct DamageSpecification {
  DamageLaw law = DamageLaw::none;
  double onset = 0.0;                  ///< s_m, of the laws that soften
  double critical = 0.0;               ///< s_c
  double rate = 3.0;                   ///< beta of the tanh laws, a of the exponential one
  std::vector<std::string> no_fail{};  ///< sets whose points' bonds never fail
  double peak = 0.0;                   ///< s_p, of the blended law
  double hardening = 0.5;              ///< h, of the blended law
  /// In the place of `critical`: fracture energy of a plane crack, the mean over its directions
  /// [J/m2].
  std::optional<double> fracture_energy{};
  /// In the place of `onset` (of `critical` for the law critical_stretch): largest stress of the
  /// bulk under a pull, see with_stretches [Pa].
  std::optional<double> strength{};

  /// True if some stretches are still to be computed from these data.
  [[nodiscard]] bool is_by_data() const {
    return law != DamageLaw::energy_density && (fracture_energy || strength);
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
    return softens() && law != DamageLaw::linear && law != DamageLaw::blended;
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

/// Random factor of the bonds, the mean of the factors of their two points.
struct ScatterSpecification {
  enum class Quantity { stiffness, strength };
  enum class Distribution { weibull };
  Quantity of = Quantity::stiffness;  ///< scales their constants, or all stretches of their law
  Distribution distribution = Distribution::weibull;
  WeibullField field{};
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
  std::optional<Calibration> calibration{};   ///< none: see calibrated_on
  std::optional<double> thermal_expansion{};  ///< [1/K]
  std::optional<double> density{};            ///< [kg/m3], for gravity and dynamics
  DamageSpecification damage{};
  std::optional<FibreSpecification> fibre{};  ///< bonds with youngs_modulus, the one along them
  std::vector<ScatterSpecification> scatter{};

  [[nodiscard]] bool has_constants() const { return youngs_modulus || micromodulus || c1; }
  /// By default cpd is calibrated on the lattice; others have the published constants of the
  /// continuum.
  [[nodiscard]] Calibration calibrated_on() const {
    const bool is_cpd = model == MaterialModel::cpd;
    return calibration.value_or(is_cpd ? Calibration::lattice : Calibration::continuum);
  }
};

/// Set whose points have a material of their own.
struct RegionSpecification {
  std::string set{};
  MaterialSpecification
      material{};  ///< model, potential, plane and influence are those of the body
};

/// Law between points of two materials: their constants by a rule, or constants of its own.
struct InterfaceSpecification {
  /// Sets of regions, or `rest_name` for the points in none; both empty: all other pairs.
  std::array<std::string, 2> between{};
  InterfaceRule rule = InterfaceRule::harmonic;
  std::optional<MaterialSpecification> material{};

  [[nodiscard]] bool is_of_all() const { return between[0].empty(); }
};

/// Largest number of regions and interfaces of a body: points and bonds store theirs in a byte.
inline constexpr std::size_t most_materials = 200;

/// Name of the material of the points in no region.
inline constexpr const char* rest_name = "material";

/// Forces of model lps: those of [LPS] at points, exact for linear displacements, or the derivative
/// of an energy.
/// `printed`: as [FCBM] has them, without a potential where neighbourhoods differ.
enum class SolidForm { collocation, energy, printed };

/// Normals of model lps where a face cuts the balls: those of the neighbourhoods or, at points
/// below a single face that have lost no bond, the face's.
enum class NormalSource { numerical, exact };

/// Options of model lps in the form of collocation.
struct CollocationSpecification {
  int degree = 5;  ///< of the polynomials that the quadrature is exact for
  TractionForm traction_form = TractionForm::full;
  NormalSource normals = NormalSource::numerical;
};

/// Specification of a body of points.
struct BodySpecification {
  double horizon = 0.0;  ///< [m]
  /// 1D: area [m2]; 2D: thickness [m]; 3D: 1. 0: that of the points.
  double cross_section = 0.0;
  VolumeCorrection volume_correction = VolumeCorrection::none;
  HorizonShape horizon_shape = HorizonShape::ball;  ///< along the lattice's axes
  SurfaceCorrection surface_correction = SurfaceCorrection::none;
  InteractionWeights weights = InteractionWeights::mean;  ///< of cpd
  SolidForm form = SolidForm::collocation;                ///< of lps
  CollocationSpecification collocation{};                 ///< of lps in that form
  /// Faces of the body and names of their shapes, for tractions of model lps; null: not known. A
  /// body does not keep them.
  std::shared_ptr<const BodyBoundary> boundary{};
  std::vector<std::string> boundary_names{};
  ForceOperator force_operator =
      ForceOperator::bonds;  ///< of linear kinematics; see faster_operator
  std::vector<Crack> cracks{};
  /// Material of the points in no region. Without constants every point must be in a region.
  MaterialSpecification material{};
  std::vector<RegionSpecification> regions{};
  std::vector<InterfaceSpecification> interfaces{};
  std::vector<SupportSpecification> supports{};
  std::vector<LoadSpecification> loads{};
  std::vector<FoundationSpecification> foundations{};
  ConstraintSpecification constraints{};
  Eigenstrains eigenstrains{};
  /// Terms of the displacement that is controlled in the place of `load`, see DisplacementControl;
  /// none: `load` is the programme's own.
  std::vector<ControlTerm> controls{};
  /// Tables of the load parameters `load`, `load2`, …, see LoadingProgramme; none: `load` from 0 to
  /// 1. With controls the first table is that of the controlled displacement [m].
  std::vector<std::vector<double>> programme{};
  /// In the place of the tables the time `t`, up to this [s]: for a body in motion.
  std::optional<double> end_time{};
  std::vector<InitialSpecification> initial{};      ///< of a body in motion
  std::vector<AbsorbingSpecification> absorbing{};  ///< likewise
  bool has_inertia = false;                         ///< for a motion by implicit steps
  /// Largest number of teeth of the saw-tooth that replaces each law of damage with a smoothly
  /// falling force; 0: the laws as they are.
  int teeth = 0;
  /// Memory per point to leave for the evaluation of a state beside the search for it [bytes].
  double evaluation_bytes_per_point = 0.0;

  /// True for model lps with the form collocation, and (has_states) with another form.
  [[nodiscard]] bool is_collocated() const {
    return material.model == MaterialModel::lps && form == SolidForm::collocation;
  }
  [[nodiscard]] bool has_states() const {
    return material.model == MaterialModel::lps && form != SolidForm::collocation;
  }
  /// True if its bonds are linearised at rest.
  [[nodiscard]] bool is_linear() const {
    return material.model == MaterialModel::bond && material.kinematics == Kinematics::linear;
  }
  /// True if only convolutions can sum its forces.
  [[nodiscard]] bool needs_convolutions() const {
    return is_polynomial(material.model) || (has_states() && form == SolidForm::printed);
  }
  [[nodiscard]] bool is_convolved() const { return force_operator == ForceOperator::fft; }

  [[nodiscard]] bool has_pressures() const {
    return std::ranges::any_of(loads, [](const LoadSpecification& load) {
      return load.kind == LoadSpecification::Kind::pressure;
    });
  }
  /// True if all bonds follow from one micromodulus and one law.
  [[nodiscard]] bool is_uniform() const {
    return regions.empty() && !material.fibre && material.scatter.empty();
  }
};

/// Refuses points that are no body: arrays that don't fit together, places and volumes that are not
/// finite or positive, a set with a number that is no point's.
/// @throws InputError ("points.…")
void check_points(const Points& points);

/// Refuses a material that contradicts itself or is incomplete.
/// @param key of the material, for errors
/// @throws InputError
void check_material(const MaterialSpecification& material, const std::string& key, int dimension);

/// Refuses a specification that contradicts itself, is incomplete or would be ignored in part, like
/// a Poisson ratio given to bonds alone.
/// @throws InputError ("horizon", "cross_section", "material.…", "cracks[0].…", …)
void check_specification(const BodySpecification& of, const Points& points);

/// Refuses a lattice that model "cpd" does not support.
/// @throws InputError ("material.model")
void require_whole_square_cells(const Points& points);

/// Refuses a horizon whose neighbourhood in the bulk takes minutes to sum, however small the body.
/// @param key   key of the horizon, for the error
/// @param ratio horizon / spacing
/// @throws InputError
void require_summable(MaterialModel model, int dimension, const std::string& key,
                      const std::string& value, double ratio);

/// Adds a named set of the points that satisfy a rule.
/// @throws InputError ("name", "where", "shape…", or without key) if there is a set of this name,
///         it selects no point, or the rule can't be used
void add_set(Points& points, const SetRule& rule);

}  // namespace peristat
