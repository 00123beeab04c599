#pragma once

#include <span>
#include <vector>

namespace peristat {

/// Returns the X of least norm among those that minimise |A X - B|, by a complete orthogonal
/// decomposition, which finds the rank of A. All matrices are stored by columns.
/// @param matrix A, rows x columns
/// @param sides  B, rows x any number
/// @return X, columns x that number
[[nodiscard]] std::vector<double> least_squares(std::span<const double> matrix, int rows,
                                                std::span<const double> sides);

/// Returns a square C with C^T C = A^T A, so that |C x| = |A x|.
/// @param matrix A, rows x columns, at least as many rows as columns
/// @return columns x columns
[[nodiscard]] std::vector<double> condensed_rows(std::span<const double> matrix, int rows);

}  // namespace peristat
