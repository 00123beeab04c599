#include "src/dense/symmetric_spectrum.hpp"

#include <Eigen/Eigenvalues>

namespace peristat {
namespace {

// A dynamic size for all: each fixed one takes eight seconds more to compile.
using Solver = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

Solver solver_of(const double* matrix, int size, int options) {
  return Solver(Eigen::Map<const Eigen::MatrixXd>(matrix, size, size), options);
}

/// Solver of a tensor given row by row, in Eigen's order by columns.
template <int D>
Solver solver_of_rows(const double* matrix, int options) {
  std::array<double, std::size_t(D * D)> transposed;
  for (int r = 0; r < D; ++r) {
    for (int c = 0; c < D; ++c) transposed[std::size_t(c * D + r)] = matrix[r * D + c];
  }
  return solver_of(transposed.data(), D, options);
}

}  // namespace

template <int D>
SymmetricSpectrum<D> symmetric_spectrum(const double* matrix) {
  const Solver solver = solver_of_rows<D>(matrix, Eigen::ComputeEigenvectors);
  SymmetricSpectrum<D> found;
  for (int k = 0; k < D; ++k) {
    found.values[std::size_t(k)] = solver.eigenvalues()(k);
    for (int c = 0; c < D; ++c) {
      found.vectors[std::size_t(k)][std::size_t(c)] = solver.eigenvectors()(c, k);
    }
  }
  return found;
}

template <int D>
std::array<double, D> symmetric_eigenvalues(const double* matrix) {
  const Solver solver = solver_of_rows<D>(matrix, Eigen::EigenvaluesOnly);
  std::array<double, D> values;
  for (int k = 0; k < D; ++k) values[std::size_t(k)] = solver.eigenvalues()(k);
  return values;
}

template SymmetricSpectrum<1> symmetric_spectrum<1>(const double*);
template SymmetricSpectrum<2> symmetric_spectrum<2>(const double*);
template SymmetricSpectrum<3> symmetric_spectrum<3>(const double*);
template std::array<double, 1> symmetric_eigenvalues<1>(const double*);
template std::array<double, 2> symmetric_eigenvalues<2>(const double*);
template std::array<double, 3> symmetric_eigenvalues<3>(const double*);

SymmetricModes symmetric_modes(std::span<const double> matrix, int size) {
  if (size == 0) return {true, {}, {}};
  const Solver solver = solver_of(matrix.data(), size, Eigen::ComputeEigenvectors);
  const Eigen::VectorXd& values = solver.eigenvalues();
  const Eigen::MatrixXd& vectors = solver.eigenvectors();
  return {solver.info() == Eigen::Success,
          {values.data(), values.data() + values.size()},
          {vectors.data(), vectors.data() + vectors.size()}};
}

}  // namespace peristat
