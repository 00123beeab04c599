#pragma once

#include <span>
#include <vector>

#include "src/core/types.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Part of the displacements' continuation into the missing part of a ball that is used: all of it,
/// or what is even in the tangential direction ([LPS] eq. 4.6).
enum class TractionForm { full, paper };

/// Entries of a symmetric tensor of third order, in ascending order of their axes.
constexpr int third_moment_entries(int dimension) { return dimension == 2 ? 4 : 10; }

/// Neighbours of points in both directions with the weights of a quadrature, and further constants,
/// frozen in the reference configuration.
///
/// With the kernel K = 1/r, m = int K r^2 dV over the ball and the quadrature's weights omega_ij of
/// the ball about i, a neighbour has k_ij = K(r) omega_ij / m [1/m2].
struct CollocationNetwork {
  int dimension = 2;
  std::vector<Offset> offset;        ///< points + 1
  std::vector<Index> neighbour;      ///< ascending
  std::vector<Offset> bond;          ///< number of its bond in the model's network
  std::vector<double> kernel_share;  ///< k_ij [1/m2]
  /// Sums of k xi [1/m] and k xi xi xi / r^2 [1/m] over what is missing from the start: places
  /// outside the body, and points beyond a pre-crack.
  std::vector<double> missing_first, missing_third;
  std::vector<char> is_whole;  ///< whether nothing of a point's ball is missing from the start
  /// Outward normals of points that have all of their bonds, points x dimension; zero, or empty:
  /// the normals follow from the neighbourhood.
  std::vector<double> normals{};
  /// Positions of the points if these are not the body's own reference; empty: they are [m].
  std::vector<double> places{};

  [[nodiscard]] Index points() const { return static_cast<Index>(offset.size()) - 1; }
};

/// Lame's constants of points [Pa]; pairs of points have their harmonic means.
struct LameConstants {
  std::vector<double> lambda, mu;
};

/// Adds k xi and k xi xi xi / r^2 of a neighbour.
template <int D>
void add_missing(const double* xi, double k, double* first, double* third) {
  double squared = 0.0;
  for (int c = 0; c < D; ++c) squared += xi[c] * xi[c];
  for (int c = 0; c < D; ++c) first[c] += k * xi[c];
  int entry = 0;
  for (int a = 0; a < D; ++a) {
    for (int b = a; b < D; ++b) {
      for (int c = b; c < D; ++c) third[entry++] += k * xi[a] * xi[b] * xi[c] / squared;
    }
  }
}

}  // namespace peristat
