#pragma once

#include <optional>
#include <string>
#include <vector>

#include "src/conditions/conditions.hpp"
#include "src/connectivity/crack.hpp"
#include "src/geometry/point_set.hpp"
#include "src/materials/bond_constants.hpp"
#include "src/materials/effective_volumes.hpp"
#include "src/materials/quadrature.hpp"
#include "src/potentials/potential.hpp"

namespace peristat {

/// Bonds alone, or continuum-kinematics-inspired peridynamics.
enum class MaterialModel { bond, cpd };

/// What constants from E and nu are to be right on.
enum class Calibration { lattice, continuum };

/// How bonds fail.
enum class DamageLaw { none, critical_stretch, tanh, tanh_continuous };

struct DamageSpecification {
  DamageLaw law = DamageLaw::none;
  double onset = 0.0;                  ///< s_m, of the tanh laws
  double critical = 0.0;               ///< s_c
  double rate = 3.0;                   ///< beta, of the tanh laws
  std::vector<std::string> no_fail{};  ///< sets whose points' bonds never fail
};

struct MaterialSpecification {
  MaterialModel model = MaterialModel::bond;
  std::string potential = Harmonic::name;  ///< of whole bonds, see WholeBondPotentials
  PlaneState plane = PlaneState::stress;
  std::optional<double>
      youngs_modulus{};                   ///< [Pa]; exactly one of this, micromodulus and c1 is set
  std::optional<double> micromodulus{};   ///< c [N/m6]
  std::optional<double> poisson_ratio{};  ///< cpd, with youngs_modulus
  std::optional<double> c1{};             ///< C1 [N/m6]
  double c2 = 0.0;                        ///< C2 [N/m10]; in 2D not with youngs_modulus
  double c3 = 0.0;                        ///< C3 [N/m14]; with c1 only
  Calibration calibration = Calibration::lattice;
  std::optional<double> thermal_expansion{};  ///< [1/K]
  std::optional<double> density{};            ///< [kg/m3], for gravity and dynamics
  DamageSpecification damage{};
};

/// What makes a body of points.
struct BodySpecification {
  double horizon = 0.0;  ///< [m]
  /// 1D: area [m2]; 2D: thickness [m]; 3D: 1. 0: as the points have it.
  double cross_section = 0.0;
  VolumeCorrection volume_correction = VolumeCorrection::none;
  SurfaceCorrection surface_correction = SurfaceCorrection::none;
  InteractionWeights weights = InteractionWeights::mean;  ///< of cpd
  std::vector<Crack> cracks{};
  MaterialSpecification material{};
  std::vector<SupportSpecification> supports{};
  std::vector<LoadSpecification> loads{};
  Eigenstrains eigenstrains{};
  /// In the place of `load`, see DisplacementControl; none: the programme's own.
  std::vector<ControlTerm> controls{};
  /// Tables of the load parameters `load`, `load2`, …, see LoadingProgramme; none: `load` from 0 to
  /// 1. With controls the first table is of the controlled displacement [m].
  std::vector<std::vector<double>> programme{};
};

/// Refuses points that are no body: arrays that don't fit together, places and volumes that are not
/// finite or positive, a set with a number that is no point's.
/// @throws InputError ("points.…")
void check_points(const Points& points);

/// Refuses what contradicts itself, lacks something or would be overlooked, like a Poisson ratio
/// given to bonds alone.
/// @throws InputError ("horizon", "cross_section", "material.…", "cracks[0].…", …)
void check_specification(const BodySpecification& of, const Points& points);

/// Refuses a horizon whose neighbourhood in the bulk takes minutes to sum, however small the body.
/// @param key   what holds the horizon, for the error
/// @param ratio horizon / spacing
/// @throws InputError
void require_summable(MaterialModel model, int dimension, const std::string& key,
                      const std::string& value, double ratio);

/// Adds a named set of the points that satisfy a rule.
/// @throws InputError ("name", "where", "shape…", or without key) if there is a set of this name,
///         it selects no point, or the rule can't be used
void add_set(Points& points, const SetRule& rule);

}  // namespace peristat
