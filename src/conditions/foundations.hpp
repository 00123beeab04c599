#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "src/conditions/environment.hpp"
#include "src/conditions/specification.hpp"
#include "src/core/expression.hpp"
#include "src/geometry/points.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Springs along the axes, from a point to the ground.
struct Spring {
  Index point = 0;
  Coordinates stiffness{};  ///< [N/m]
};

/// Elastic foundations: the energy is the sum of k (u - g)^2 / 2 over the components of all
/// springs, u the displacement of the point and g that of the ground.
class Foundations {
 public:
  Foundations() = default;

  /// @param ranks that have parts of the body: collective, each rank has the springs of its own
  ///        points
  /// @throws InputError ("foundations[k].…", k from 0) for a place that traction_areas or
  ///         points_of_set refuses, a stiffness that is negative, not finite or zero in all
  ///         components, and a bad expression
  Foundations(const Points& points, const std::vector<FoundationSpecification>& specifications,
              const std::vector<std::string>& parameters, const Communicator& ranks = sole_rank());

  [[nodiscard]] bool none() const { return foundations_.empty(); }
  [[nodiscard]] const std::vector<Spring>& springs() const { return springs_; }
  /// True if any spring acts along an axis.
  [[nodiscard]] bool hold(int axis) const { return holds_[std::size_t(axis)]; }

  /// Summary of a foundation for reports.
  struct Summary {
    std::string name, key;  ///< key of the name
    std::size_t springs = 0;
    Coordinates stiffness{};  ///< sum of all springs [N/m]
  };
  [[nodiscard]] std::vector<Summary> summaries() const;

  /// True unless the displacement of the ground is given as 0 everywhere.
  [[nodiscard]] bool ground_moves() const;
  /// Displacement of the ground, springs x dimension [m].
  /// @throws InputError if it is not finite
  [[nodiscard]] std::vector<double> ground(std::span<const double> loads) const;

  /// Adds factor * k (g - u), the forces of the springs on their points [N].
  void add_force(std::span<const double> displacement, const SharedEnvironment& environment,
                 double factor, std::span<double> force) const;
  /// Calls visit(dof, k, u - g) for each component of each spring.
  template <class Visit>
  void for_each(std::span<const double> displacement, const SharedEnvironment& environment,
                const Visit& visit) const {
    for_each(0, springs_.size(), displacement, environment, visit);
  }

  /// Force of each foundation on the body [N].
  [[nodiscard]] std::map<std::string, Coordinates> forces(
      std::span<const double> displacement, const SharedEnvironment& environment) const;

 private:
  struct Foundation {
    std::string name, table;
    std::size_t first, last;  // of its springs
    std::vector<Expression> ground;
  };

  template <class Visit>
  void for_each(std::size_t first, std::size_t last, std::span<const double> displacement,
                const SharedEnvironment& environment, const Visit& visit) const {
    const auto d = std::size_t(dimension_);
    const bool is_moved = environment && !environment->ground.empty();
    for (std::size_t k = first; k < last; ++k) {
      for (std::size_t c = 0; c < d; ++c) {
        const std::size_t dof = std::size_t(springs_[k].point) * d + c;
        const double ground = is_moved ? environment->ground[k * d + c] : 0.0;
        visit(dof, springs_[k].stiffness[c], displacement[dof] - ground);
      }
    }
  }

  int dimension_ = 0;
  std::array<bool, 3> holds_{};  // per axis
  std::vector<Spring> springs_;
  std::vector<Coordinates> place_;  // of the springs' points, in the reference [m]
  std::vector<Foundation> foundations_;
};

}  // namespace peristat
