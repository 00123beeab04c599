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

/// A rotation R of a whole body, or the identity.
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
  /// Replaces upper bounds of a point's absolute row sums of K by those of R K R^T: its rows are
  /// sums of rows weighted with |R|, and blocks grow by sqrt(D) at most.
  template <int D>
  void bound(Vector<D, double>& rows) const;
};

/// Finds the mean rotation of a lattice body, and takes it off displacements.
///
/// For frame-indifferent laws whose sums by convolutions are differences of powers of u: in a
/// rotated body n spacings wide these are n^3 and n^4 times as large as their differences. The
/// choice of the rotation changes nothing but round-off.
class LatticeTurns {
 public:
  /// @param is_periodic along any axis: no rotation is taken off, as images do not rotate
  LatticeTurns(const LatticeBox& box, const std::array<bool, 3>& is_periodic,
               std::span<const LatticeSpring> springs);

  /// R if it moves the body's ends by more than a bond's length: a smaller rotation costs no
  /// digits, and small displacements stay as they are.
  /// @param u without its mean
  [[nodiscard]] LatticeTurn find(const LatticeFields& fields, std::span<const double> u) const;

  /// u := R^T (X + u) - X, up to its mean
  void take_off(const LatticeTurn& turn, std::span<double> u) const;

  [[nodiscard]] double bytes() const { return 8.0 * double(places_.size()); }

 private:
  int dimension_;
  std::vector<double> places_;  // X from the middle of the box, per point; empty: no rotation
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
