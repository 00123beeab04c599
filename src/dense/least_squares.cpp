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

std::vector<double> condensed_rows(std::span<const double> matrix, int rows) {
  // A P = Q R, so that C = R P^T. The decomposition above contains this one.
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(mapped(matrix, rows));
  const Eigen::Index columns = factors.cols();
  std::vector<double> condensed(std::size_t(columns * columns), 0.0);
  for (Eigen::Index c = 0; c < columns; ++c) {
    const Eigen::Index to = factors.colsPermutation().indices()(c);
    for (Eigen::Index r = 0; r <= c; ++r) {
      condensed[std::size_t(to * columns + r)] = factors.matrixR()(r, c);
    }
  }
  return condensed;
}

}  // namespace peristat
