#include "solvers/linear/block_jacobi.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace peristat {
namespace {

/// A pivot below this fraction of its block's largest entry is zero up to round-off.
constexpr double zero_pivot = 1e3 * std::numeric_limits<double>::epsilon();

/// Inverts a block of the free degrees of freedom of a point, in place; prescribed ones get zeros.
template <int D>
LinearOutcome invert(const Index* equation, double* block) {
  using Block = Eigen::Matrix<double, D, D, Eigen::RowMajor>;
  Eigen::Map<Block> entries(block);
  Block with_unit_rows = entries;
  double largest = 0.0;
  for (int r = 0; r < D; ++r) {
    if (equation[r] != FreeDofs::none) {
      largest = std::max(largest, std::abs(entries(r, r)));
      continue;
    }
    with_unit_rows.row(r).setZero();
    with_unit_rows.col(r).setZero();
  }
  if (largest == 0.0 &&
      std::any_of(equation, equation + D, [](Index e) { return e != FreeDofs::none; })) {
    return LinearOutcome::singular;
  }
  for (int r = 0; r < D; ++r) {
    if (equation[r] == FreeDofs::none) with_unit_rows(r, r) = largest > 0.0 ? largest : 1.0;
  }
  if (!with_unit_rows.allFinite()) return LinearOutcome::singular;
  const Eigen::LDLT<Block> factor(with_unit_rows);
  const double least = factor.vectorD().minCoeff();
  if (std::abs(least) <= zero_pivot * largest) return LinearOutcome::singular;
  if (least < 0.0) return LinearOutcome::not_positive_definite;
  entries = factor.solve(Block::Identity());
  for (int r = 0; r < D; ++r) {
    if (equation[r] != FreeDofs::none) continue;
    entries.row(r).setZero();
    entries.col(r).setZero();
  }
  return LinearOutcome::solved;
}

template <int D>
LinearOutcome invert_all(const FreeDofs& free, std::vector<double>& blocks) {
  LinearOutcome outcome = LinearOutcome::solved;
  for (std::size_t i = 0; i < free.equation.size() / D; ++i) {
    const LinearOutcome one = invert<D>(&free.equation[i * D], &blocks[i * D * D]);
    if (one == LinearOutcome::not_positive_definite) return one;
    if (one != LinearOutcome::solved) outcome = one;
  }
  return outcome;
}

}  // namespace

void BlockJacobi::analyze(const Pattern&, const FreeDofs& free) { free_ = &free; }

LinearOutcome BlockJacobi::build(const TangentOperator& tangent) {
  const std::size_t d = std::size_t(tangent.dimension);
  threads_ = tangent.threads();
  inverse_ = tangent.diagonal;
  if (blocks_ == Blocks::entries) {
    for (std::size_t k = 0; k < inverse_.size(); ++k) {
      if (k / d % d != k % d) inverse_[k] = 0.0;
    }
  }
  if (d == 1) return invert_all<1>(*free_, inverse_);
  return d == 2 ? invert_all<2>(*free_, inverse_) : invert_all<3>(*free_, inverse_);
}

void BlockJacobi::apply(std::span<const double> residual, std::span<double> correction) {
  std::fill(correction.begin(), correction.end(), 0.0);
  add(1.0, residual, correction);
}

void BlockJacobi::add(double scale, std::span<const double> residual,
                      std::span<double> correction) const {
  const Index d = free_->dimension;
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (Index e = 0; e < free_->count(); ++e) {
    const Index dof = free_->dof[e], first = dof - dof % d;
    const double* row = &inverse_[std::size_t(dof) * d];
    double sum = 0.0;
    for (Index c = 0; c < d; ++c) {
      const Index other = free_->equation[first + c];
      if (other != FreeDofs::none) sum += row[c] * residual[other];
    }
    correction[e] += scale * sum;
  }
}

std::string BlockJacobi::describe() const {
  return blocks_ == Blocks::entries ? "Jacobi" : "block Jacobi";
}

}  // namespace peristat
