#pragma once

#include <span>

#include "assembly/operators/tangent_operator.hpp"
#include "src/constraints/constraints.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Upper bounds of the sums of the absolute entries of the rows of J^T K J [N/m]:
///
///   sums = |J|^T |K| |J| 1
///
/// computed from whatever rows of K a rank has, and so the same on any number of ranks; where K has
/// no rows, the largest entry of |J| 1 replaces all of them. Rows of dependent degrees of freedom
/// are 0.
/// @param whole K, of the body's points
/// @param displacement at which K is linearised, of points and handles
/// @param index_map partition of a distributed body: collective; null: the body is whole
/// @param sums of points and handles, per degree of freedom
void bound_constrained_row_sums(const TangentOperator& whole, const Points& points,
                                const Constraints& constraints,
                                std::span<const double> displacement, const IndexMap& index_map,
                                std::span<double> sums);

}  // namespace peristat
