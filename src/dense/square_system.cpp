#include "src/dense/square_system.hpp"

#include <Eigen/LU>

namespace peristat {

void solve_square(std::span<const double> matrix, std::span<double> side) {
  const Eigen::Index size = Eigen::Index(side.size());
  const Eigen::PartialPivLU<Eigen::MatrixXd> factors(
      Eigen::Map<const Eigen::MatrixXd>(matrix.data(), size, size));
  Eigen::Map<Eigen::VectorXd> x(side.data(), size);
  x = factors.solve(x).eval();
}

}  // namespace peristat
