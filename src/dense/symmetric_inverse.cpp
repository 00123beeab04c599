#include "src/dense/symmetric_inverse.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace peristat {

template <int D>
double invert_symmetric(double* matrix) {
  using Matrix = Eigen::Matrix<double, D, D, Eigen::RowMajor>;
  Eigen::Map<Matrix> entries(matrix);
  const Eigen::LDLT<Matrix> factors(entries);
  const auto pivots = factors.vectorD();
  if ((pivots.array() != 0.0).all()) entries = factors.solve(Matrix::Identity());
  return pivots.minCoeff();
}

template double invert_symmetric<1>(double*);
template double invert_symmetric<2>(double*);
template double invert_symmetric<3>(double*);

}  // namespace peristat
