#include "assembly/terms/projection.hpp"

#include <cassert>

#include <Eigen/Eigenvalues>

namespace peristat {
namespace {

template <int Size>
void project(double* matrix, double share) {
  using Square = Eigen::Matrix<double, Size, Size, Eigen::RowMajor>;
  using Vector = Eigen::Matrix<double, Size, 1>;
  Eigen::Map<Square> mapped(matrix);
  const Eigen::SelfAdjointEigenSolver<Square> solver(mapped);
  for (int k = 0; k < Size && solver.eigenvalues()[k] < 0.0; ++k) {  // ascending
    const Vector direction = solver.eigenvectors().col(k);
    mapped.noalias() -= share * solver.eigenvalues()[k] * direction * direction.transpose();
  }
}

}  // namespace

void project_to_semidefinite(double* matrix, int size, double share) {
  switch (size) {
    case 4:
      return project<4>(matrix, share);
    case 6:
      return project<6>(matrix, share);
    case 9:
      return project<9>(matrix, share);
    default:
      assert(!"no interaction has a Hessian of this size");
  }
}

}  // namespace peristat
