#pragma once

#include <span>

namespace peristat {

/// Solves A x = b with any regular A, by elimination with partial pivots. Rows and columns of very
/// different size, such as those of a stiffness beside those of a constraint, keep their digits.
/// @param matrix column by column
/// @param side b, which becomes x
void solve_square(std::span<const double> matrix, std::span<double> side);

}  // namespace peristat
