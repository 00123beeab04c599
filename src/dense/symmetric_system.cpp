#include "src/dense/symmetric_system.hpp"

#include <Eigen/Cholesky>

namespace peristat {
namespace {

Eigen::Map<const Eigen::MatrixXd> square(std::span<const double> matrix, int size) {
  return {matrix.data(), size, size};
}

Eigen::Map<Eigen::VectorXd> column(std::span<double> side) {
  return {side.data(), Eigen::Index(side.size())};
}

}  // namespace

struct SymmetricFactors::Factors {
  Eigen::LDLT<Eigen::MatrixXd> ldlt;
};

SymmetricFactors::SymmetricFactors() : factors_(std::make_unique<Factors>()) {}
SymmetricFactors::~SymmetricFactors() = default;
SymmetricFactors::SymmetricFactors(SymmetricFactors&&) noexcept = default;
SymmetricFactors& SymmetricFactors::operator=(SymmetricFactors&&) noexcept = default;

void SymmetricFactors::compute(std::span<const double> matrix, int size) {
  factors_->ldlt.compute(square(matrix, size));
}

bool SymmetricFactors::is_positive(double least_share) const {
  const auto& ldlt = factors_->ldlt;
  const auto pivots = ldlt.vectorD();
  return ldlt.info() == Eigen::Success && ldlt.isPositive() &&
         pivots.minCoeff() > least_share * pivots.maxCoeff();
}

void SymmetricFactors::solve(std::span<double> side) const {
  const Eigen::VectorXd given = column(side);
  column(side) = factors_->ldlt.solve(given);
}

void solve_symmetric(std::span<const double> matrix, std::span<double> side) {
  SymmetricFactors factors;
  factors.compute(matrix, int(side.size()));
  factors.solve(side);
}

}  // namespace peristat
