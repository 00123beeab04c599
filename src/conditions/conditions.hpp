#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "src/conditions/displacement_control.hpp"
#include "src/conditions/environment.hpp"
#include "src/conditions/foundations.hpp"
#include "src/conditions/load_point.hpp"
#include "src/conditions/loading_programme.hpp"
#include "src/conditions/make_constraints.hpp"
#include "src/conditions/obstacles.hpp"
#include "src/conditions/pressed_boundary.hpp"
#include "src/conditions/specification.hpp"
#include "src/conditions/surface_tractions.hpp"
#include "src/connectivity/holding.hpp"
#include "src/core/expression.hpp"
#include "src/geometry/points.hpp"
#include "src/parallel/communicator.hpp"
#include "src/parallel/index_map.hpp"
#include "src/parallel/numbered_points.hpp"

namespace peristat {

/// Data that loads depend on besides the points; arrays are per point, or empty if unknown.
struct LoadSetting {
  double horizon = 0.0;                        ///< [m], for tractions
  std::vector<double> density = {};            ///< [kg/m3], for gravity
  std::vector<double> thermal_expansion = {};  ///< [1/K], for the temperature
  ObstacleSetting of_obstacles = {};
  /// Sites at which tractions act on the surface; nothing: tractions are forces on points.
  std::optional<std::vector<SurfaceSite>> surface = std::nullopt;
  const IndexMap& index_map = whole_body();
};

/// Eigenstrains, given directly or by a change of temperature.
struct Eigenstrains {
  std::vector<EigenstrainSpecification> given{};
  std::optional<std::string> temperature_change{};  ///< [K], an expression of x, y, z and load

  [[nodiscard]] bool are_there() const { return !given.empty() || temperature_change; }
};

/// Supports, constraints and loads of a body along its loading programme. Arrays have one entry per
/// degree of freedom (point x dimension + component), then those of the constraints' handles
/// (generalised degrees of freedom).
class Conditions {
 public:
  /// @throws InputError ("supports[k].…", "loads[k].…", k from 0) for a set that is unknown or
  ///         empty, a bad expression, or two supports that prescribe different displacements to one
  ///         point and component (compared at some stages, and whenever they are used); also what
  ///         DisplacementControl or make_constraints throws
  /// @param control replaces the first load parameter: the programme's first table then gives its
  ///        values [m]; no terms: none
  Conditions(const Points& points, const std::vector<SupportSpecification>& supports,
             const std::vector<LoadSpecification>& loads, LoadingProgramme programme = {},
             const std::vector<ControlTerm>& control = {}, const LoadSetting& setting = {},
             const Eigenstrains& eigenstrains = {}, const ConstraintSpecification& constraints = {},
             const std::vector<FoundationSpecification>& foundations = {},
             const std::vector<ObstacleSpecification>& obstacles = {});

  [[nodiscard]] int dimension() const { return points_.dimension; }
  [[nodiscard]] const LoadingProgramme& programme() const { return programme_; }
  /// Null if the programme's first table gives the load factor.
  [[nodiscard]] const DisplacementControl* control() const {
    return control_ ? &*control_ : nullptr;
  }
  /// The first load parameter.
  [[nodiscard]] double load_factor(const LoadPoint& at) const { return parameters(at).front(); }

  [[nodiscard]] const Constraints& constraints() const { return made_.constraints; }
  [[nodiscard]] const std::vector<Restraint>& restraints() const { return made_.restraints; }

  /// True for a degree of freedom without an equation: it is prescribed or a follower.
  [[nodiscard]] const std::vector<char>& prescribed() const { return prescribed_; }

  /// Returns what restrains pieces of the body at a displacement. Collective if the body has parts.
  [[nodiscard]] Holding holding(std::span<const double> displacement) const;

  /// Overwrites the prescribed entries with their displacement [m] at a point of the programme.
  /// @throws InputError if one is not finite, or two supports contradict each other there
  void prescribe(const LoadPoint& at, std::span<double> displacement) const;

  /// External force of the loads [N] there, every entry overwritten.
  /// @throws InputError if one is not finite
  void external_force(const LoadPoint& at, std::span<double> force) const;

  /// Returns the load-dependent data of the energy there; null without eigenstrains, pressures,
  /// surface tractions and a moving ground.
  /// @throws InputError if a value is not finite or an eigenstrain is not above -1
  [[nodiscard]] SharedEnvironment environment(const LoadPoint& at) const;

  /// True if these depend on the load parameters.
  [[nodiscard]] bool supports_move() const { return changes_.supports; }
  [[nodiscard]] bool loads_change() const { return changes_.loads; }
  [[nodiscard]] bool environment_changes() const { return changes_.environment; }

  [[nodiscard]] const Foundations& foundations() const { return foundations_; }
  [[nodiscard]] const Obstacles& obstacles() const { return obstacles_; }

  [[nodiscard]] bool has_pressures() const { return !pressures_.empty(); }
  /// Faces that pressures act on, in the order of Environment::pressure.
  [[nodiscard]] const PressedBoundary& pressed_boundary() const { return pressed_; }

  /// Returns the reaction of each support's set [N]: the sum of dE/dx - external force over its
  /// prescribed degrees of freedom, which is the force that the supports add. Points of two sets
  /// count in both. Also returns the reactions of restraints: the forces of rigid sets and rollers,
  /// those of the part of the body beyond a plane of symmetry or a period and, in its first
  /// component, the multiplier of a linear constraint; and the forces of foundations and obstacles.
  /// For a part of a body these are this rank's summands.
  /// @param gradient folded, see Constraints
  [[nodiscard]] std::map<std::string, Coordinates> reactions(std::span<const double> gradient,
                                                             std::span<const double> external,
                                                             std::span<const double> displacement,
                                                             const SharedEnvironment& environment,
                                                             const Slips& slips = {}) const;

  /// Moment of each rigid set's constraint about the set's present centre [N m]; for a part of a
  /// body this rank's summand.
  [[nodiscard]] std::map<std::string, Coordinates> moments(std::span<const double> displacement,
                                                           std::span<const double> gradient,
                                                           std::span<const double> external) const;

  /// Mean displacement gradient along each period, du/dx of its axis; 0 where the body does not
  /// reach over it.
  [[nodiscard]] std::map<std::string, Coordinates> mean_gradients(
      std::span<const double> displacement) const;

  /// Rotation vector of each rigid set [rad].
  [[nodiscard]] std::map<std::string, Coordinates> rotations(
      std::span<const double> displacement) const;

 private:
  struct Prescription {
    std::string key, set;
    const std::vector<Index>* points;
    int component;
    Expression displacement;
  };
  /// Points of a load, and the factor at each that turns the load's value into a force.
  struct Loaded {
    std::vector<Index> points;
    std::vector<double> amount;  // volume [m3], mass [kg], or area [m2]
    double spread_over = 1.0;    // total force: volume that it is spread over [m3]
  };
  struct Load {
    std::string key;
    std::shared_ptr<const Loaded> on;
    int component;
    Expression value;  // [N/m3], [N], [m/s2] or [Pa]
  };

  struct Eigenstretch {
    std::string key;
    std::vector<Index> points;
    std::vector<double> factor;  // per point
    Expression value;            // [1], or change of temperature [K]
  };

  struct Pressure {
    std::string key;
    std::size_t first, last;  // of the pressed boundary's faces
    Expression value;         // [Pa]
  };

  void add_pressure(const LoadSpecification& load, const LoadSetting& setting,
                    const std::string& table);
  void add_eigenstrains(const Eigenstrains& eigenstrains, const LoadSetting& setting);
  [[nodiscard]] Loaded loaded(const LoadSpecification& load, const LoadSetting& setting,
                              const std::string& table) const;

  [[nodiscard]] std::vector<double> parameters(const LoadPoint& at) const;
  void refuse_shared_names() const;
  void prescribe_handles();
  void hold_periodic_cell(const ConstraintSpecification& constraints, const LoadSetting& setting);
  /// Returns the owned point nearest to the middle of the body on the rank that owns it, nothing on
  /// others.
  [[nodiscard]] std::optional<Index> point_of_middle(const LoadSetting& setting) const;
  /// Calls add_loads ahead of a collective sum: if it fails on one rank, all ranks throw.
  void add_loads_of_all(const std::function<void()>& add_loads) const;
  /// Throws if the loads do not add up to 0 along an axis in which nothing holds a periodic cell.
  void require_balance(std::span<const double> force, const std::string& key) const;
  void prescribe_handles_at(std::span<const double> loads, double preload,
                            std::span<double> displacement) const;
  [[nodiscard]] Coordinates reaction_of(const Restraint& restraint,
                                        std::span<const double> gradient) const;
  void add_held_sums(std::span<const double> displacement, Holding& holding) const;
  void find_shared();
  void find_changes();
  void try_stages();
  /// Returns the present position of a point, or of a handle with the reference position `at`.
  [[nodiscard]] Coordinates moved(Index row, Coordinates at,
                                  std::span<const double> displacement) const;
  [[nodiscard]] std::size_t dof_of(const Prescription& prescription, Index point) const {
    return std::size_t(point) * points_.dimension + prescription.component;
  }
  [[noreturn]] void refuse_contradiction(const Prescription& second, Index point,
                                         double first_value, double second_value,
                                         double load_factor) const;

  const Points& points_;
  const Communicator& ranks_;
  LoadingProgramme programme_;
  std::vector<Prescription> prescriptions_;
  std::vector<Load> loads_;
  std::vector<Eigenstretch> eigenstretches_;
  PressedBoundary pressed_;
  std::vector<Pressure> pressures_;
  SurfaceTractions surface_;
  Foundations foundations_;
  Obstacles obstacles_;
  std::vector<char> prescribed_;
  MadeConstraints made_;
  std::optional<DisplacementControl> control_;
  /// First prescription of each degree of freedom; empty if none has more than one.
  std::vector<const Prescription*> first_;
  std::array<bool, 3> floats_{};  ///< components in which nothing holds a periodic cell
  struct Changes {
    bool supports = false, loads = false, environment = false;
  } changes_;
  double largest_ = 0.0;  ///< largest displacement at the stages that were tried [m]
};

}  // namespace peristat
