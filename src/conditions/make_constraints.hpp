#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "src/conditions/constraint_specification.hpp"
#include "src/constraints/constraints.hpp"
#include "src/core/expression.hpp"
#include "src/parallel/communicator.hpp"
#include "src/parallel/index_map.hpp"
#include "src/parallel/numbered_points.hpp"

namespace peristat {

/// Handle (generalised degree of freedom) prescribed as a function of the load parameters.
struct HandlePrescription {
  std::string key;
  std::size_t dof;
  Coordinates place;  ///< at which its expression is evaluated [m]
  double factor;      ///< that its value is multiplied by
  Expression value;
};

/// Restraint of a body besides its supports, for reports of its reactions.
struct Restraint {
  enum class Kind { rigid_set, rollers, linear, symmetry, period } kind;
  std::string key, name;
  std::vector<Index> handles{};  ///< rigid set: its translation; rollers and linear: one per value;
                                 ///< period: the jump across it, if the body reaches over it
  Coordinates direction{};       ///< rollers: their normal
  int axis = 0;                  ///< symmetry, period
  double at = 0.0;               ///< symmetry [m]
  std::optional<double> opposite{};   ///< symmetry: where another plane crosses the axis [m]
  double length = 0.0;                ///< period [m]
  std::array<bool, 3> is_mirrored{};  ///< period: components that a plane of symmetry reverses
};

/// Sum of displacements, weighted by vectors, that a roller or linear constraint holds. For a part
/// of a body all ranks have the same sums, each with the points that it owns.
using HeldSum = std::vector<std::pair<Index, Coordinates>>;

/// Component of a handle along which a single point slides.
struct Slide {
  std::size_t dof;
  Index member;
  Coordinates direction;
};

/// Constraints with the prescriptions of their handles and records of what they hold.
struct MadeConstraints {
  Constraints constraints;
  std::vector<HandlePrescription> prescriptions{};
  std::vector<std::size_t> unused{};  ///< components of handles without a meaning
  std::vector<Restraint> restraints{};
  std::vector<HeldSum> held_sums{};
  std::vector<Slide> slides{};
};

/// @param points with their images
/// @param prescribed by supports, per degree of freedom of the points
/// @param parameters names of the load parameters
/// Collective.
/// @throws InputError ("rigid_sets[k].…", "rollers[k].…", "linear[k].…", "periods[k].…") for sets
///         that are unknown, points held twice by these or also by a support, a rigid set whose
///         points do not determine its rotation, expressions that can't be read, constraints that
///         contradict or repeat others
[[nodiscard]] MadeConstraints make_constraints(const Points& points,
                                               const ConstraintSpecification& of,
                                               const std::vector<char>& prescribed,
                                               const std::vector<std::string>& parameters,
                                               const IndexMap& index_map = whole_body());

}  // namespace peristat
