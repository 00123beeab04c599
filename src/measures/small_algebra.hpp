#pragma once

#include <array>
#include <cmath>

#include <experimental/simd>

namespace peristat {

/// Vectors and matrices of an interaction, over any scalar (double or Lanes). Eigen's fixed-size
/// matrices do not take SIMD scalars, and these few verbs are all that the measures need.
template <int D, class Real>
using Vector = std::array<Real, D>;

template <int D, class Real>
using Matrix = std::array<std::array<Real, D>, D>;

template <int D, class Real>
inline Real dot(const Vector<D, Real>& a, const Vector<D, Real>& b) {
  Real result = a[0] * b[0];
  for (int c = 1; c < D; ++c) result += a[c] * b[c];
  return result;
}

template <int D, class Real>
inline Vector<D, Real> plus(const Vector<D, Real>& a, const Vector<D, Real>& b) {
  Vector<D, Real> result;
  for (int c = 0; c < D; ++c) result[c] = a[c] + b[c];
  return result;
}

template <int D, class Real>
inline Vector<D, Real> minus(const Vector<D, Real>& a, const Vector<D, Real>& b) {
  Vector<D, Real> result;
  for (int c = 0; c < D; ++c) result[c] = a[c] - b[c];
  return result;
}

template <int D, class Real>
inline Vector<D, Real> scaled(const Real& factor, const Vector<D, Real>& a) {
  Vector<D, Real> result;
  for (int c = 0; c < D; ++c) result[c] = factor * a[c];
  return result;
}

/// Square root of double and Lanes alike.
template <class Real>
inline Real square_root(const Real& a) {
  using std::sqrt;
  using std::experimental::sqrt;
  return sqrt(a);
}

}  // namespace peristat
