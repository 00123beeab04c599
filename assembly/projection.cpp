#include "assembly/projection.hpp"

#include <cassert>

#include <Eigen/Eigenvalues>

namespace peristat {
namespace {

template <int Size>
void project(double* matrix) {
  using Square = Eigen::Matrix<double, Size, Size, Eigen::RowMajor>;
  Eigen::Map<Square> mapped(matrix);
  const Eigen::SelfAdjointEigenSolver<Square> solver(mapped);
  mapped.noalias() = solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).asDiagonal() *
                     solver.eigenvectors().transpose();
}

}  // namespace

void project_to_semidefinite(double* matrix, int size) {
  switch (size) {
    case 4:
      return project<4>(matrix);
    case 6:
      return project<6>(matrix);
    case 9:
      return project<9>(matrix);
    default:
      assert(!"no interaction has a Hessian of this size");
  }
}

}  // namespace peristat
