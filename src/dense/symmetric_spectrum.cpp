#include "src/dense/symmetric_spectrum.hpp"

#include <Eigen/Eigenvalues>

namespace peristat {
namespace {

template <int D>
using Tensor = Eigen::Matrix<double, D, D, Eigen::RowMajor>;

template <int D>
Eigen::SelfAdjointEigenSolver<Tensor<D>> spectrum_of(const double* matrix, int options) {
  return Eigen::SelfAdjointEigenSolver<Tensor<D>>(Eigen::Map<const Tensor<D>>(matrix), options);
}

}  // namespace

template <int D>
SymmetricSpectrum<D> symmetric_spectrum(const double* matrix) {
  const auto solver = spectrum_of<D>(matrix, Eigen::ComputeEigenvectors);
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
  const auto solver = spectrum_of<D>(matrix, Eigen::EigenvaluesOnly);
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
  const Eigen::Map<const Eigen::MatrixXd> mapped(matrix.data(), size, size);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(mapped);
  const Eigen::VectorXd& values = solver.eigenvalues();
  const Eigen::MatrixXd& vectors = solver.eigenvectors();
  return {solver.info() == Eigen::Success,
          {values.data(), values.data() + values.size()},
          {vectors.data(), vectors.data() + vectors.size()}};
}

}  // namespace peristat
