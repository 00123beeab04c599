#include "src/constraints/rotation.hpp"

#include <cmath>

#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

/// Below this square of the angle the series is used; the closed forms lose digits there.
constexpr double small = 1.0;

/// sum over k of (-t)^k / (2 k + first)! and its first two derivatives by t: sin x / x for first =
/// 1, (1 - cos x) / x^2 for first = 2, t = x^2.
std::array<double, 3> series(double t, int first) {
  std::array<double, 3> sum{};
  double inverse_factorial = first == 1 ? 1.0 : 0.5;
  constexpr int terms = 12;  // the next one is below 1e-25
  for (int k = 0; k < terms; ++k) {
    const double coefficient = k % 2 == 0 ? inverse_factorial : -inverse_factorial;
    sum[0] += coefficient * std::pow(t, k);
    if (k > 0) sum[1] += coefficient * k * std::pow(t, k - 1);
    if (k > 1) sum[2] += coefficient * k * (k - 1) * std::pow(t, k - 2);
    inverse_factorial /= double(2 * k + first + 1) * double(2 * k + first + 2);
  }
  return sum;
}

}  // namespace

Rotation::Rotation(const Coordinates& vector) : theta_(vector) {
  const double t = dot<3>(vector, vector);
  if (t < small) {
    const auto a = series(t, 1), b = series(t, 2);
    a_ = a[0], a_rate_ = a[1], a_curvature_ = a[2];
    b_ = b[0], b_rate_ = b[1], b_curvature_ = b[2];
    return;
  }
  const double angle = std::sqrt(t), cosine = std::cos(angle);
  a_ = std::sin(angle) / angle;
  b_ = (1.0 - cosine) / t;
  a_rate_ = (cosine - a_) / (2.0 * t);
  b_rate_ = (a_ - 2.0 * b_) / (2.0 * t);
  a_curvature_ = -(0.5 * a_ + 3.0 * a_rate_) / (2.0 * t);
  b_curvature_ = (a_rate_ - 4.0 * b_rate_) / (2.0 * t);
}

Coordinates Rotation::moved(const Coordinates& arm) const {
  const Coordinates once = cross(theta_, arm), twice = cross(theta_, once);
  return plus<3>(scaled<3>(a_, once), scaled<3>(b_, twice));
}

std::array<Coordinates, 3> Rotation::rates(const Coordinates& arm) const {
  const Coordinates once = cross(theta_, arm), twice = cross(theta_, once);
  const double along = dot<3>(theta_, arm);
  std::array<Coordinates, 3> rates;
  for (std::size_t k = 0; k < 3; ++k) {
    Coordinates axis{};
    axis[k] = 1.0;
    const Coordinates turned = cross(axis, arm);
    for (std::size_t c = 0; c < 3; ++c) {
      rates[k][c] = 2.0 * theta_[k] * (a_rate_ * once[c] + b_rate_ * twice[c]) + a_ * turned[c] +
                    b_ * (axis[c] * along + theta_[c] * arm[k] - 2.0 * theta_[k] * arm[c]);
    }
  }
  return rates;
}

Tensor Rotation::curvature(const Tensor& moment) const {
  // M : R = tr M + a theta.w + b theta.S theta
  const Coordinates w{moment[2][1] - moment[1][2], moment[0][2] - moment[2][0],
                      moment[1][0] - moment[0][1]};
  const double trace = moment[0][0] + moment[1][1] + moment[2][2];
  Tensor symmetric{};
  Coordinates s{};  // S theta
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) {
      symmetric[r][c] = 0.5 * (moment[r][c] + moment[c][r]) - (r == c ? trace : 0.0);
      s[r] += symmetric[r][c] * theta_[c];
    }
  }
  const double linear = dot<3>(theta_, w), quadratic = dot<3>(theta_, s);
  Tensor result{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) {
      result[r][c] =
          4.0 * theta_[r] * theta_[c] * (a_curvature_ * linear + b_curvature_ * quadratic) +
          2.0 * a_rate_ * (theta_[r] * w[c] + w[r] * theta_[c]) +
          4.0 * b_rate_ * (theta_[r] * s[c] + s[r] * theta_[c]) + 2.0 * b_ * symmetric[r][c];
      if (r == c) result[r][c] += 2.0 * (a_rate_ * linear + b_rate_ * quadratic);
    }
  }
  return result;
}

}  // namespace peristat
