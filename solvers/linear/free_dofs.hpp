#pragma once

#include <span>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// Numbering of the degrees of freedom that are solved for. Prescribed ones have no equation: their
/// rows and columns leave the system ([ADAPT] sec. 2.3).
struct FreeDofs {
  static constexpr Index none = -1;

  /// @param prescribed one flag per degree of freedom
  FreeDofs(const std::vector<char>& prescribed, int dimension_of_points);

  int dimension;
  std::vector<Index> equation;  ///< per degree of freedom, or none
  std::vector<Index> dof;       ///< per equation

  [[nodiscard]] Index count() const { return static_cast<Index>(dof.size()); }

  /// free[e] = full[dof of e]
  void restrict_to_free(std::span<const double> full, std::span<double> free,
                        int threads = 1) const;
  /// full[dof of e] = free[e], zero elsewhere
  void extend_by_zero(std::span<const double> free, std::span<double> full, int threads = 1) const;
};

}  // namespace peristat
