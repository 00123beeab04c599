#pragma once

#include <span>
#include <vector>

namespace peristat {

/// The X of least norm among those that make |A X - B| least, by a complete orthogonal
/// decomposition, which finds the rank of A. All matrices are stored column by column.
/// @param matrix A, rows x columns
/// @param sides  B, rows x any number
/// @return X, columns x that number
[[nodiscard]] std::vector<double> least_squares(std::span<const double> matrix, int rows,
                                                std::span<const double> sides);

/// A square C with C^T C = A^T A, which has the same least squares as A.
/// @param matrix A, rows x columns, at least as many rows as columns
/// @return columns x columns
[[nodiscard]] std::vector<double> condensed_rows(std::span<const double> matrix, int rows);

}  // namespace peristat
