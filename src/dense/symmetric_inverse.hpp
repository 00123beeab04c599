#pragma once

namespace peristat {

/// Inverts a symmetric matrix in place, by L D L^T with pivots along the diagonal; D is 1, 2 or 3.
/// @param matrix D x D entries, of which the lower half, row by row, is read
/// @return the smallest pivot; where one is 0 the matrix has no inverse and keeps its entries
template <int D>
[[nodiscard]] double invert_symmetric(double* matrix);

}  // namespace peristat
