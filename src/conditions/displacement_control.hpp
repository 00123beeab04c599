#pragma once

#include <span>
#include <vector>

#include "src/conditions/specification.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Displacement control: a weighted sum of displacements replaces the first load parameter,
///
///   c = sum over terms t of sum over components a of w_ta mean over the set of u_a   [m],
///
/// for example the opening of a mouth or the shortening of a column.
class DisplacementControl {
 public:
  /// @param prescribed per degree of freedom
  /// @throws InputError ("controls", "controls[k].…", k from 0) for a set that is unknown or empty,
  ///         weights that are not finite or all zero, and where all displacements in the sum are
  ///         prescribed
  DisplacementControl(const Points& points, const std::vector<ControlTerm>& terms,
                      const std::vector<char>& prescribed);

  /// dc/du, per degree of freedom.
  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }
  [[nodiscard]] double value(std::span<const double> displacement) const;

 private:
  std::vector<double> weights_;
};

}  // namespace peristat
