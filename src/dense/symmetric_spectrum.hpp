#pragma once

#include <array>
#include <span>
#include <vector>

namespace peristat {

/// Eigenvalues, ascending, and orthonormal eigenvectors of a symmetric matrix.
template <int D>
struct SymmetricSpectrum {
  std::array<double, D> values;
  std::array<std::array<double, D>, D> vectors;  ///< vectors[k] belongs to values[k]
};

/// Spectrum of a small tensor; D is 1, 2 or 3.
/// @param matrix D x D entries, of which the lower half, row by row, is read
template <int D>
[[nodiscard]] SymmetricSpectrum<D> symmetric_spectrum(const double* matrix);

/// The eigenvalues alone.
template <int D>
[[nodiscard]] std::array<double, D> symmetric_eigenvalues(const double* matrix);

/// Spectrum of a matrix of any size.
struct SymmetricModes {
  bool is_found = false;        ///< true if the iterations have converged
  std::vector<double> values;   ///< ascending
  std::vector<double> vectors;  ///< one after another, in the order of the values
};

/// @param matrix size x size entries, of which the lower half, column by column, is read
[[nodiscard]] SymmetricModes symmetric_modes(std::span<const double> matrix, int size);

}  // namespace peristat
