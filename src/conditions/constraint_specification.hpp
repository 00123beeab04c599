#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "src/conditions/specification.hpp"
#include "src/core/types.hpp"
#include "src/geometry/images.hpp"

namespace peristat {

/// A set that moves as one rigid body. Expressions of the load parameters; nothing: free.
struct RigidSetSpecification {
  std::string set{};
  std::optional<Coordinates> centre{};  ///< [m]; nothing: the centroid of the set
  std::array<std::optional<std::string>, 3> displacement{};  ///< of the centre [m]
  /// Rotation vector [rad]; 2D: its first component, about z.
  std::array<std::optional<std::string>, 3> rotation{};
};

/// Points that are held along one direction and slide across it.
struct RollerSpecification {
  std::string set{};
  std::string label{};  ///< name of a roller without a set
  /// Instead of a set: where a roller touches the body [m], and in 3D the other end of its line.
  std::optional<Coordinates> at{}, to{};
  Coordinates normal{};
  /// Along the normal [m], an expression of place and load parameters; "free": unknown, but the
  /// same for all points of the set.
  std::string displacement = "0";

  [[nodiscard]] const std::string& name() const { return set.empty() ? label : set; }
};

/// A weighted sum of mean displacements of sets equals a displacement [m], an expression of the
/// load parameters.
struct LinearConstraintSpecification {
  std::string name{};
  std::vector<ControlTerm> terms{};
  std::string displacement = "0";
};

/// Two sides of a cell across an axis, between which the displacement jumps by the length times a
/// column of the mean displacement gradient.
struct PeriodSpecification : Period {
  /// du/dx_axis, expressions of the load parameters; nothing: free, this component of the body's
  /// mean stress is 0.
  std::array<std::optional<std::string>, 3> gradient{"0", "0", "0"};
};

/// Returns the other plane of symmetry across the axis of planes[of], on the body's other side, or
/// null.
[[nodiscard]] const SymmetryPlane* opposite(const std::vector<SymmetryPlane>& planes,
                                            std::size_t of);

/// Name of a plane in reports of reactions: "symmetry_x", or of two planes "symmetry_x-" for the
/// lower one and "symmetry_x+".
[[nodiscard]] std::string name_of_plane(const std::vector<SymmetryPlane>& planes, std::size_t of);

/// Name of a period in reports: "period_x".
[[nodiscard]] std::string name_of_period(const Period& period);

struct ConstraintSpecification {
  std::vector<RigidSetSpecification> rigid_sets{};
  std::vector<RollerSpecification> rollers{};
  std::vector<LinearConstraintSpecification> linear{};
  std::vector<SymmetryPlane> symmetries{};
  std::vector<PeriodSpecification> periods{};

  [[nodiscard]] bool none() const {
    return rigid_sets.empty() && rollers.empty() && linear.empty() && symmetries.empty() &&
           periods.empty();
  }
};

}  // namespace peristat
