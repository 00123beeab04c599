#include "solvers/linear/local_operator.hpp"

#include <algorithm>
#include <new>
#include <stdexcept>
#include <utility>
#include <vector>

#include "solvers/linear/free_rows.hpp"

namespace peristat {
namespace {

/// Frobenius norm of the skew part over that of the whole, up to which the symmetric part is used.
constexpr double nearly_symmetric = 0.03;

/// Tolerance of a solve by factors, which need not be refined.
constexpr double rough = 1e-3;

/// Pattern of the blocks (i, j), i < j, of rows over whole points with a symmetric pattern.
BlockPattern upper_blocks(const SparseRows& rows, int d) {
  std::vector<Offset> offset{0};
  std::vector<Index> partner;
  for (Index row = 0; row < rows.rows(); row += d) {
    for (Offset e = rows.offset[std::size_t(row)]; e < rows.offset[std::size_t(row) + 1]; e += d) {
      const Index j = rows.column[std::size_t(e)] / d;
      if (j > row / d) partner.push_back(j);
    }
    offset.push_back(Offset(partner.size()));
  }
  return BlockPattern::of_rows(std::move(offset), partner);
}

/// Writes the symmetric part of the rows to the tangent.
/// @return squared Frobenius norm of twice the skew part over that of the rows
double fill_symmetric_part(const SparseRows& rows, Tangent& tangent) {
  const auto d = Index(tangent.dimension);
  tangent.clear();
  double squares = 0.0, products = 0.0;  // sums of a_ij a_ij and of a_ij a_ji
  std::vector<double> lower(tangent.off_diagonal.size());
  for (Index row = 0; row < rows.rows(); ++row) {
    const Index i = row / d, r = row % d;
    for (Offset e = rows.offset[std::size_t(row)]; e < rows.offset[std::size_t(row) + 1]; ++e) {
      const double value = rows.value[std::size_t(e)];
      const Index j = rows.column[std::size_t(e)] / d, c = rows.column[std::size_t(e)] % d;
      squares += value * value;
      if (i == j) {
        tangent.diagonal[std::size_t((i * d + r) * d + c)] += 0.5 * value;
        tangent.diagonal[std::size_t((i * d + c) * d + r)] += 0.5 * value;
        continue;
      }
      const std::optional<Offset> block = tangent.pattern.find(std::min(i, j), std::max(i, j));
      if (!block) throw std::logic_error("local rows couple points in one direction alone");
      const std::size_t first = std::size_t(*block) * std::size_t(d * d);
      if (i < j) {
        tangent.off_diagonal[first + std::size_t(r * d + c)] = value;
      } else {
        lower[first + std::size_t(c * d + r)] = value;
      }
    }
  }
  for (std::size_t k = 0; k < lower.size(); ++k) {
    products += 2.0 * tangent.off_diagonal[k] * lower[k];
    tangent.off_diagonal[k] = 0.5 * (tangent.off_diagonal[k] + lower[k]);
  }
  for (const double value : tangent.diagonal) products += value * value;
  return squares > 0.0 ? std::max(0.0, 2.0 * (squares - products) / squares) : 0.0;
}

}  // namespace

void LocalOperator::analyze(const BlockPattern& /*pattern*/, const FreeDofs& free) {
  free_ = &free;
  factor_.reset();
  symmetric_.reset();
  cholesky_.reset();
}

LinearOutcome LocalOperator::build_symmetric(const SparseRows& rows, int dimension, int threads) {
  const BlockPattern pattern = upper_blocks(rows, dimension);
  const bool is_known = symmetric_ && cholesky_ && symmetric_->pattern == pattern;
  if (!is_known) {
    symmetric_ = std::make_unique<Tangent>(pattern, dimension, threads);
    cholesky_ = std::make_unique<Cholesky>(FactorReuse{0}, most_bytes_);
    cholesky_->count_pivots(false);
  }
  const double skew = fill_symmetric_part(rows, *symmetric_);
  if (skew > 4.0 * nearly_symmetric * nearly_symmetric) return LinearOutcome::inaccurate;
  if (!is_known) {
    const LinearOutcome analysis = cholesky_->analyze(symmetric_->pattern, *free_);
    if (analysis != LinearOutcome::solved) return analysis;
  }
  return cholesky_->factorize(*symmetric_, FactorUse::factorize_now);
}

LinearOutcome LocalOperator::build(const TangentOperator& tangent) {
  const UnsymmetricTangent* const unsymmetric = tangent.as_unsymmetric();
  if (!unsymmetric) throw std::logic_error("LocalOperator is for unsymmetric tangents");
  try {
    SparseRows rows = unsymmetric->local_rows();
    if (build_symmetric(rows, tangent.dimension, tangent.threads()) == LinearOutcome::solved) {
      return LinearOutcome::solved;
    }
    symmetric_.reset();
    cholesky_.reset();
    const LinearOutcome outcome = factor_.factorize(free_rows(std::move(rows), *free_));
    return outcome == LinearOutcome::singular ? LinearOutcome::inaccurate : outcome;
  } catch (const std::bad_alloc&) {
    factor_.reset();
    symmetric_.reset();
    cholesky_.reset();
    return LinearOutcome::out_of_memory;
  }
}

void LocalOperator::apply(std::span<const double> residual, std::span<double> correction) {
  if (cholesky_) {
    // Iterations make up for the digits that a rough solve lacks.
    static_cast<void>(cholesky_->solve(residual, correction, rough));
    return;
  }
  std::copy(residual.begin(), residual.end(), correction.begin());
  factor_.solve(correction);
}

}  // namespace peristat
