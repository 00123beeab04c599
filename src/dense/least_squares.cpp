#include "src/dense/least_squares.hpp"

#include <Eigen/QR>

namespace peristat {
namespace {

Eigen::Map<const Eigen::MatrixXd> mapped(std::span<const double> matrix, int rows) {
  return {matrix.data(), rows, Eigen::Index(matrix.size()) / rows};
}

}  // namespace

std::vector<double> least_squares(std::span<const double> matrix, int rows,
                                  std::span<const double> sides) {
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factors(mapped(matrix, rows));
  const Eigen::MatrixXd found = factors.solve(mapped(sides, rows));
  return {found.data(), found.data() + found.size()};
}

std::vector<double> triangular_factor(std::span<const double> matrix, int rows) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> factors(mapped(matrix, rows));
  const Eigen::Index columns = factors.matrixQR().cols();
  std::vector<double> triangle(std::size_t(columns * columns), 0.0);
  Eigen::Map<Eigen::MatrixXd>(triangle.data(), columns, columns) =
      factors.matrixQR().topRows(columns).triangularView<Eigen::Upper>();
  return triangle;
}

}  // namespace peristat
