#pragma once

#include <span>

#include "assembly/operators/tangent_operator.hpp"
#include "src/constraints/constraints.hpp"
#include "src/core/sharing.hpp"

namespace peristat {

/// Numbers that are not less than the sums of the absolute entries of the rows of J^T K J [N/m]:
///
///   sums = |J|^T |K| |J| 1
///
/// whatever part of K's rows a rank has, and so alike on any number of ranks; where K has no rows,
/// the largest entry of |J| 1 stands for all of them. Rows of what follows are 0.
/// @param whole K, of the body's points
/// @param displacement where K is, of points and handles
/// @param sharing of a part of a body, in a call that all ranks make
/// @param sums of points and handles, per degree of freedom
void bound_constrained_row_sums(const TangentOperator& whole, const Points& points,
                                const Constraints& constraints,
                                std::span<const double> displacement, const Sharing* sharing,
                                std::span<double> sums);

}  // namespace peristat
