#include "solvers/linear/block_jacobi.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "solvers/linear/zero_pivot.hpp"
#include "src/dense/symmetric_inverse.hpp"

namespace peristat {
namespace {

/// Sets the rows and columns of prescribed degrees of freedom to zero, and their diagonal entries
/// to `diagonal`.
template <int D>
void set_prescribed(const Index* equation, double diagonal, double* block) {
  for (int r = 0; r < D; ++r) {
    if (equation[r] != FreeDofs::none) continue;
    for (int c = 0; c < D; ++c) block[r * D + c] = block[c * D + r] = 0.0;
    block[r * (D + 1)] = diagonal;
  }
}

/// Inverts a block of the free degrees of freedom of a point, in place; prescribed ones get zeros.
template <int D>
LinearOutcome invert(const Index* equation, double* block) {
  double largest = 0.0;
  for (int r = 0; r < D; ++r) {
    if (equation[r] == FreeDofs::none) continue;
    largest = std::max(largest, std::abs(block[r * (D + 1)]));
  }
  if (largest == 0.0 &&
      std::any_of(equation, equation + D, [](Index e) { return e != FreeDofs::none; })) {
    return LinearOutcome::singular;
  }
  std::array<double, D * D> inverse;
  std::copy_n(block, D * D, inverse.begin());
  set_prescribed<D>(equation, largest > 0.0 ? largest : 1.0, inverse.data());
  if (!std::ranges::all_of(inverse, [](double entry) { return std::isfinite(entry); })) {
    return LinearOutcome::singular;
  }
  const double least = invert_symmetric<D>(inverse.data());
  if (std::abs(least) <= zero_pivot * largest) return LinearOutcome::singular;
  if (least < 0.0) return LinearOutcome::not_positive_definite;
  set_prescribed<D>(equation, 0.0, inverse.data());
  std::ranges::copy(inverse, block);
  return LinearOutcome::solved;
}

constexpr std::size_t upper_half(int dimension) {
  return std::size_t(dimension) * std::size_t(dimension + 1) / 2;
}

/// @param entries_only off-diagonal entries of the blocks are taken as zero
template <int D>
LinearOutcome invert_all(const FreeDofs& free, const std::vector<double>& blocks, bool entries_only,
                         std::vector<double>& upper_halves) {
  LinearOutcome outcome = LinearOutcome::solved;
  double* to = upper_halves.data();
  for (std::size_t i = 0; i < free.equation.size() / D; ++i) {
    double block[D * D];
    for (int k = 0; k < D * D; ++k) {
      block[k] = entries_only && k / D != k % D ? 0.0 : blocks[i * D * D + std::size_t(k)];
    }
    const LinearOutcome one = invert<D>(&free.equation[i * D], block);
    if (one == LinearOutcome::not_positive_definite) return one;
    if (one != LinearOutcome::solved) outcome = one;
    for (int r = 0; r < D; ++r) {
      for (int c = r; c < D; ++c) *to++ = block[r * D + c];
    }
  }
  return outcome;
}

/// correction += scale M^-1 residual
template <int D>
void add_all(const FreeDofs& free, const std::vector<double>& upper_halves, int threads,
             double scale, std::span<const double> residual, std::span<double> correction) {
  const auto points = static_cast<std::ptrdiff_t>(free.equation.size() / D);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (std::ptrdiff_t i = 0; i < points; ++i) {
    const Index* equation = &free.equation[std::size_t(i) * D];
    const double* entry = &upper_halves[std::size_t(i) * upper_half(D)];
    double from[D], to[D] = {};
    for (int c = 0; c < D; ++c)
      from[c] = equation[c] == FreeDofs::none ? 0.0 : residual[equation[c]];
    for (int r = 0; r < D; ++r) {
      to[r] += *entry++ * from[r];
      for (int c = r + 1; c < D; ++c, ++entry) {
        to[r] += *entry * from[c];
        to[c] += *entry * from[r];
      }
    }
    for (int c = 0; c < D; ++c) {
      if (equation[c] != FreeDofs::none) correction[equation[c]] += scale * to[c];
    }
  }
}

/// Returns the symmetric parts of the blocks, which precondition an unsymmetric tangent.
std::vector<double> symmetric_parts(std::vector<double> blocks, std::size_t d) {
  for (std::size_t first = 0; first < blocks.size(); first += d * d) {
    for (std::size_t r = 0; r < d; ++r) {
      for (std::size_t c = r + 1; c < d; ++c) {
        double &upper = blocks[first + r * d + c], &lower = blocks[first + c * d + r];
        upper = lower = 0.5 * (upper + lower);
      }
    }
  }
  return blocks;
}

LinearOutcome invert_all(const FreeDofs& free, const std::vector<double>& blocks, int dimension,
                         bool entries_only, std::vector<double>& upper_halves) {
  if (dimension == 1) return invert_all<1>(free, blocks, entries_only, upper_halves);
  if (dimension == 2) return invert_all<2>(free, blocks, entries_only, upper_halves);
  return invert_all<3>(free, blocks, entries_only, upper_halves);
}

}  // namespace

void BlockJacobi::analyze(const BlockPattern&, const FreeDofs& free) { free_ = &free; }

LinearOutcome BlockJacobi::build(const TangentOperator& tangent) {
  threads_ = tangent.threads();
  const int d = tangent.dimension;
  const bool entries_only = blocks_ == Blocks::entries;
  inverse_.resize(std::size_t(tangent.pattern.points()) * upper_half(d));
  if (!tangent.as_unsymmetric()) {
    return invert_all(*free_, tangent.diagonal, d, entries_only, inverse_);
  }
  const auto blocks = symmetric_parts(tangent.diagonal, std::size_t(d));
  const LinearOutcome outcome = invert_all(*free_, blocks, d, entries_only, inverse_);
  return outcome == LinearOutcome::solved ? outcome : LinearOutcome::inaccurate;
}

void BlockJacobi::apply(std::span<const double> residual, std::span<double> correction) {
  std::fill(correction.begin(), correction.end(), 0.0);
  add(1.0, residual, correction);
}

void BlockJacobi::add(double scale, std::span<const double> residual,
                      std::span<double> correction) const {
  const int d = free_->dimension;
  if (d == 1) add_all<1>(*free_, inverse_, threads_, scale, residual, correction);
  if (d == 2) add_all<2>(*free_, inverse_, threads_, scale, residual, correction);
  if (d == 3) add_all<3>(*free_, inverse_, threads_, scale, residual, correction);
}

std::string BlockJacobi::describe() const {
  return blocks_ == Blocks::entries ? "Jacobi" : "block Jacobi";
}

}  // namespace peristat
