#pragma once

#include <array>
#include <cmath>

namespace peristat {

// Inlining is forced: the compiler's own choice has cost the kernels a sixth when other code
// changed.

/// Vectors and matrices of an interaction, over any scalar (double or Lanes). Eigen's fixed-size
/// matrices do not take SIMD scalars, and these few operations are all that the measures need.
template <int D, class Real>
using Vector = std::array<Real, D>;

template <int D, class Real>
using Matrix = std::array<std::array<Real, D>, D>;

/// Relative vectors of an interaction, each from its first to one of its other points.
template <int Count, int D, class Real>
using Arms = std::array<Vector<D, Real>, Count>;

template <int D, class Real>
[[gnu::always_inline]] inline Real dot(const Vector<D, Real>& a, const Vector<D, Real>& b) {
  Real result = a[0] * b[0];
  for (int c = 1; c < D; ++c) result += a[c] * b[c];
  return result;
}

template <int D, class Real>
[[gnu::always_inline]] inline Vector<D, Real> plus(const Vector<D, Real>& a,
                                                   const Vector<D, Real>& b) {
  Vector<D, Real> result;
  for (int c = 0; c < D; ++c) result[c] = a[c] + b[c];
  return result;
}

template <int D, class Real>
[[gnu::always_inline]] inline Vector<D, Real> minus(const Vector<D, Real>& a,
                                                    const Vector<D, Real>& b) {
  Vector<D, Real> result;
  for (int c = 0; c < D; ++c) result[c] = a[c] - b[c];
  return result;
}

template <int D, class Real>
[[gnu::always_inline]] inline Vector<D, Real> scaled(const Real& factor, const Vector<D, Real>& a) {
  Vector<D, Real> result;
  for (int c = 0; c < D; ++c) result[c] = factor * a[c];
  return result;
}

template <class Real>
[[gnu::always_inline]] inline Vector<3, Real> cross(const Vector<3, Real>& a,
                                                    const Vector<3, Real>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// block += factor [w]x, the matrix with [w]x y = w x y
template <class Real>
[[gnu::always_inline]] inline void add_skew(const Real& factor, const Vector<3, Real>& w,
                                            Matrix<3, Real>& block) {
  const Vector<3, Real> f = scaled<3>(factor, w);
  block[0][1] -= f[2];
  block[0][2] += f[1];
  block[1][0] += f[2];
  block[1][2] -= f[0];
  block[2][0] -= f[1];
  block[2][1] += f[0];
}

/// block += factor a b^T
template <int D, class Real>
[[gnu::always_inline]] inline void add_outer(const Real& factor, const Vector<D, Real>& a,
                                             const Vector<D, Real>& b, Matrix<D, Real>& block) {
  for (int r = 0; r < D; ++r) {
    const Real row = factor * a[r];
    for (int c = 0; c < D; ++c) block[r][c] += row * b[c];
  }
}

/// The upper half of block += factor a a^T
template <int D, class Real>
[[gnu::always_inline]] inline void add_outer_square(const Real& factor, const Vector<D, Real>& a,
                                                    Matrix<D, Real>& block) {
  for (int r = 0; r < D; ++r) {
    const Real row = factor * a[r];
    for (int c = r; c < D; ++c) block[r][c] += row * a[c];
  }
}

/// Square root of double and Lanes alike.
template <class Real>
[[gnu::always_inline]] inline Real square_root(const Real& a) {
  using std::sqrt;
  return sqrt(a);
}

}  // namespace peristat
