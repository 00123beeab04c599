#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "assembly/terms/collocation/collocation_network.hpp"
#include "solvers/formulations/specification/contact_specification.hpp"
#include "solvers/formulations/specification/material_specification.hpp"
#include "src/conditions/conditions.hpp"
#include "src/conditions/constraint_specification.hpp"
#include "src/connectivity/crack.hpp"
#include "src/geometry/body_boundary.hpp"
#include "src/geometry/point_set.hpp"
#include "src/materials/effective_volumes.hpp"
#include "src/materials/interface_rule.hpp"
#include "src/materials/quadrature.hpp"

namespace peristat {

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
  double horizon = 0.0;  ///< [m]; the largest if points have horizons of their own
  /// In its place the horizon of each point over its size, see horizons_of_sizes; 0: none. A body
  /// gets its Points::horizons from it.
  double horizon_per_size = 0.0;
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
  ForceOperator force_operator = ForceOperator::bonds;  ///< see faster_operator
  std::vector<Crack> cracks{};
  /// Material of the points in no region. Without constants every point must be in a region.
  MaterialSpecification material{};
  std::vector<RegionSpecification> regions{};
  std::vector<InterfaceSpecification> interfaces{};
  std::vector<SupportSpecification> supports{};
  std::vector<LoadSpecification> loads{};
  std::vector<FoundationSpecification> foundations{};
  std::vector<ContactSpecification> contacts{};  ///< of points
  std::vector<ObstacleSpecification> obstacles{};
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
  std::vector<TimeTable> loads_over_time{};         ///< tables of `load`, … of a body in motion
  std::vector<InitialSpecification> initial{};      ///< of a body in motion
  std::vector<AbsorbingSpecification> absorbing{};  ///< likewise
  bool has_inertia = false;                         ///< for a motion by implicit steps
  /// Largest number of teeth of the saw-tooth that replaces each law of damage with a smoothly
  /// falling force; 0: the laws as they are.
  int teeth = 0;
  /// Memory per point to leave for the evaluation of a state beside the search for it [bytes].
  double evaluation_bytes_per_point = 0.0;

  /// True if its forces are summed by convolutions.
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

/// Cross-section of a body: the given one, or that of its points; 1 in 3D.
[[nodiscard]] double cross_section_of(const BodySpecification& of, const Points& points);

/// Refuses points that are no body: arrays that don't fit together, places and volumes that are not
/// finite or positive, a set with a number that is no point's.
/// @throws InputError ("points.…")
void check_points(const Points& points);

/// Adds a named set of the points that satisfy a rule.
/// @throws InputError ("name", "where", "shape…", or without key) if there is a set of this name,
///         it selects no point, or the rule can't be used
void add_set(Points& points, const SetRule& rule);

}  // namespace peristat
