#pragma once

#include <array>

#include "src/core/types.hpp"

namespace peristat {

/// Finite rotation R = exp([theta]x) = I + a [theta]x + b [theta]x^2 by a rotation vector theta
/// [rad], with a = sin|theta| / |theta| and b = (1 - cos|theta|) / |theta|^2 (Rodrigues), and its
/// derivatives by theta. In 2D theta is along z.
class Rotation {
 public:
  explicit Rotation(const Coordinates& vector);

  /// (R - I) X, without cancellation for small angles [m].
  [[nodiscard]] Coordinates moved(const Coordinates& arm) const;

  /// d(R X) / d theta_k for k = x, y, z.
  [[nodiscard]] std::array<Coordinates, 3> rates(const Coordinates& arm) const;

  /// d2(M : R) / d theta d theta, symmetric.
  /// @param moment M = sum of F X^T over forces F at arms X
  [[nodiscard]] Tensor curvature(const Tensor& moment) const;

 private:
  Coordinates theta_;
  double a_, b_;                      // of t = theta . theta
  double a_rate_, b_rate_;            // d/dt
  double a_curvature_, b_curvature_;  // d2/dt2
};

}  // namespace peristat
