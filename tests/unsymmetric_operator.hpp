#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "assembly/operators/unsymmetric_tangent.hpp"
#include "solvers/linear/linear_solver.hpp"
#include "tests/bodies.hpp"

namespace peristat::tests {

/// Grid of points with unit spacing and a synthetic operator.
struct GridSetting {
  int dimension = 2;
  int side = 10;            ///< points
  double reach = 3.01;      ///< of the operator [spacings]
  double convection = 0.3;  ///< relative stiffening of neighbours towards +x
  double disorder = 0.2;    ///< share by which k_ij and k_ji differ at random
  double mass = 0.0;        ///< on the diagonal
  std::uint64_t seed = 1;   ///< of the disorder
  int threads = 1;
};

/// Convection and diffusion of a vector: (K u)_i = mass u_i + sum_j k_ij (u_i - u_j), with blocks
/// k_ij = (1/2 + n n) w_ij / r^2 for a direction n and a distance r, and weights w_ij that differ
/// from w_ji. Without mass, translations give no force.
struct GridOperator : UnsymmetricTangent {
  explicit GridOperator(const GridSetting& of)
      : UnsymmetricTangent(BlockPattern::of_rows(std::vector<Offset>(points_of(of) + 1, 0), {}),
                           of.dimension, of.threads, {}),
        setting(of) {
    assemble();
  }

  static std::size_t points_of(const GridSetting& of) {
    return std::size_t(std::lround(std::pow(of.side, of.dimension)));
  }

  void assemble() {
    matrix = rows_within(setting.reach, 1.0);
    const std::size_t d = std::size_t(dimension);
    for (std::size_t r = 0; r < std::size_t(matrix.rows()); ++r) {
      for (Offset k = matrix.offset[r]; k < matrix.offset[r + 1]; ++k) {
        const std::size_t c = std::size_t(matrix.column[std::size_t(k)]);
        if (c / d == r / d)
          diagonal[r / d * d * d + r % d * d + c % d] = matrix.value[std::size_t(k)];
      }
    }
  }

  [[nodiscard]] SparseRows rows() const override { return matrix; }
  [[nodiscard]] double bytes_of_rows() const override {
    return double(matrix.column.size()) * (sizeof(Index) + sizeof(double));
  }
  /// Rows of the nearest neighbours, as stiff as all neighbours for long waves: sum k r^2 is the
  /// same.
  [[nodiscard]] SparseRows local_rows() const override {
    constexpr double local_reach = 1.5;
    return rows_within(local_reach, double(offsets_within(setting.reach).size() - 1) /
                                        double(offsets_within(local_reach).size() - 1));
  }
  [[nodiscard]] std::vector<double> positions() const override { return {}; }
  void linearise(Energy&, const StateView&, double) override {}

  void multiply(std::span<const double> v, std::span<double> result) const override {
#pragma omp parallel for num_threads(setting.threads) schedule(static)
    for (Index r = 0; r < matrix.rows(); ++r) {
      double sum = 0.0;
      for (Offset k = matrix.offset[std::size_t(r)]; k < matrix.offset[std::size_t(r) + 1]; ++k) {
        sum += matrix.value[std::size_t(k)] * v[std::size_t(matrix.column[std::size_t(k)])];
      }
      result[std::size_t(r)] = sum;
    }
  }

  GridSetting setting;
  SparseRows matrix;

 private:
  using Step = std::array<int, 3>;

  /// Offsets, ascending in the numbers of the points that they lead to.
  [[nodiscard]] std::vector<Step> offsets_within(double reach) const {
    const int most = int(reach), y = dimension > 1 ? most : 0, z = dimension > 2 ? most : 0;
    std::vector<Step> steps;
    for (int c = -z; c <= z; ++c) {
      for (int b = -y; b <= y; ++b) {
        for (int a = -most; a <= most; ++a) {
          if (a * a + b * b + c * c <= reach * reach) steps.push_back({a, b, c});
        }
      }
    }
    return steps;
  }

  /// Pseudo-random number between -1 and 1 for each ordered pair of points.
  [[nodiscard]] double noise(Index i, Index j) const {
    std::uint64_t mixed = setting.seed * 0x9e3779b97f4a7c15u +
                          std::uint64_t(i) * 0xbf58476d1ce4e5b9u +
                          std::uint64_t(j) * 0x94d049bb133111ebu;
    for (const int shift : {31, 27, 33}) mixed = (mixed ^ (mixed >> shift)) * 0xd6e8feb86659fd93u;
    return 2.0 * double(mixed >> 11) / 9007199254740992.0 - 1.0;
  }

  [[nodiscard]] SparseRows rows_within(double reach, double scale) const {
    const std::vector<Step> steps = offsets_within(reach);
    const int n = setting.side, d = dimension;
    const auto has = [&](int at) { return at >= 0 && at < n; };
    SparseRows made{{0}, {}, {}};
    for (Index i = 0; i < pattern.points(); ++i) {
      const Step at{i % n, d > 1 ? i / n % n : 0, d > 2 ? i / (n * n) : 0};
      for (int r = 0; r < d; ++r) {
        std::size_t own = 0;
        std::array<double, 3> sum{};
        for (const Step& step : steps) {
          const Step to{at[0] + step[0], at[1] + step[1], at[2] + step[2]};
          if (!has(to[0]) || !has(to[1]) || !has(to[2])) continue;
          const Index j = to[0] + n * (to[1] + n * to[2]);
          if (j == i) own = made.column.size();
          const double squared = double(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]);
          const double weight =
              scale *
              (1.0 + setting.convection * step[0] / std::sqrt(squared + (j == i)) +
               setting.disorder * noise(i, j)) /
              (squared + (j == i));
          for (int c = 0; c < d; ++c) {
            const double block = weight * ((r == c ? 0.5 : 0.0) +
                                           double(step[std::size_t(r)] * step[std::size_t(c)]) /
                                               (squared + (j == i)));
            made.column.push_back(j * d + c);
            made.value.push_back(j == i ? 0.0 : -block);
            if (j != i) sum[std::size_t(c)] += block;
          }
        }
        for (int c = 0; c < d; ++c) {
          made.value[own + std::size_t(c)] = sum[std::size_t(c)] + (r == c ? setting.mass : 0.0);
        }
        made.offset.push_back(Offset(made.column.size()));
      }
    }
    return made;
  }
};

/// A grid's operator with some degrees of freedom prescribed, and a system with a known solution.
struct GridSystem {
  explicit GridSystem(const GridSetting& of, bool is_held = true)
      : tangent(of), free(held(tangent, is_held), of.dimension) {
    expected = Random(3).vector(std::size_t(free.count()));
    find_right_hand_side();
  }

  /// Prescribes all components of the first row of points (in 1D, of three points), and single
  /// components of others.
  static std::vector<char> held(const GridOperator& of, bool is_held) {
    std::vector<char> prescribed(std::size_t(of.dofs()), 0);
    if (!is_held) return prescribed;
    for (std::size_t k = 0; k < std::size_t(of.dofs()); ++k) {
      const bool in_first_row =
          k < std::size_t(of.dimension == 1 ? 3 : of.setting.side * of.dimension);
      prescribed[k] = char(in_first_row || k % 37 == 5);
    }
    return prescribed;
  }

  void find_right_hand_side() {
    std::vector<double> full(free.equation.size()), product(full.size());
    free.extend_by_zero(expected, full);
    tangent.multiply(full, product);
    b.resize(expected.size());
    free.restrict_to_free(product, b);
    x.assign(b.size(), 1e300);
  }

  LinearOutcome solve(LinearSolver& solver, double tolerance = 1e-12,
                      FactorUse use = FactorUse::factorize_now) {
    LinearOutcome outcome = solver.factorize(tangent, use);
    if (outcome == LinearOutcome::solved) outcome = solver.solve(b, x, tolerance);
    return outcome;
  }

  /// |A x - b| / |b|
  [[nodiscard]] double residual() const {
    std::vector<double> full(free.equation.size()), product(full.size()), left(b.size());
    free.extend_by_zero(x, full);
    tangent.multiply(full, product);
    free.restrict_to_free(product, left);
    return distance(left, b) / norm(b);
  }
  [[nodiscard]] double error() const { return distance(x, expected) / norm(expected); }

  GridOperator tangent;
  FreeDofs free;
  std::vector<double> expected, b, x;
};

}  // namespace peristat::tests
