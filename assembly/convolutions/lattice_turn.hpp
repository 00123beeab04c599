#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "assembly/convolutions/lattice_fields.hpp"
#include "assembly/convolutions/lattice_springs.hpp"
#include "src/geometry/lattice_box.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {

/// A rotation R of a whole body, or none.
struct LatticeTurn {
  bool is_one = true;
  std::array<std::array<double, 3>, 3> rotation{};

  /// v := R^T v of every point
  void take_off(int dimension, std::span<double> v) const;
  /// v := R v of every point
  void put_on(int dimension, std::span<double> v) const;
  /// B := R B R^T
  template <int D>
  void put_on(Matrix<D, double>& block) const;
  /// Sums of the absolute entries of a point's rows become numbers that are not less than those of
  /// R K R^T: a row of it is a mean of rows with |R|, each of whose blocks grows by sqrt(D) at
  /// most.
  template <int D>
  void bound(Vector<D, double>& rows) const;
};

/// Finds the rotation that a body of a lattice has on average, and displacements without it.
///
/// For laws that turn with the body, whose sums by convolutions are differences of powers of u: of
/// a body n spacings wide that has turned these are n^3 and n^4 times what they leave. Which
/// rotation is taken off changes nothing but round-off.
class LatticeTurns {
 public:
  /// @param is_periodic along any axis: nothing is taken off, as images do not turn
  LatticeTurns(const LatticeBox& box, const std::array<bool, 3>& is_periodic,
               std::span<const LatticeSpring> springs);

  /// R where it moves the body's ends by more than a bond's length: less costs no digits, and small
  /// displacements stay as they are.
  /// @param u without its mean
  [[nodiscard]] LatticeTurn find(const LatticeFields& fields, std::span<const double> u) const;

  /// u := R^T (X + u) - X, but for its mean
  void take_off(const LatticeTurn& turn, std::span<double> u) const;

  [[nodiscard]] double bytes() const { return 8.0 * double(places_.size()); }

 private:
  int dimension_;
  std::vector<double> places_;  // X from the middle of the box, per point; empty: nothing turns
  double reach_ = 0.0, bond_ = 0.0;
};

template <int D>
void LatticeTurn::put_on(Matrix<D, double>& block) const {
  if (is_one) return;
  const Matrix<D, double> before = block;
  for (std::size_t r = 0; r < D; ++r) {
    for (std::size_t c = 0; c < D; ++c) {
      block[r][c] = 0.0;
      for (std::size_t a = 0; a < D; ++a) {
        for (std::size_t b = 0; b < D; ++b) {
          block[r][c] += rotation[r][a] * before[a][b] * rotation[c][b];
        }
      }
    }
  }
}

template <int D>
void LatticeTurn::bound(Vector<D, double>& rows) const {
  if (is_one) return;
  const Vector<D, double> before = rows;
  for (std::size_t r = 0; r < D; ++r) {
    rows[r] = 0.0;
    for (std::size_t a = 0; a < D; ++a) {
      rows[r] += std::sqrt(double(D)) * std::abs(rotation[r][a]) * before[a];
    }
  }
}

}  // namespace peristat
