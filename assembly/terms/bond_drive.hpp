#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace peristat {

/// A line of states: the rate of the displacements, with that of the eigenstretches of points.
/// Empty: there is no line, or no eigenstretch.
struct StateLine {
  std::span<const double> rate{}, eigenstretch_rate{};
};

/// What drives the damage of a bond that fails by release, along a line of states u + t v: the
/// square of its equivalent stretch is c_0 + c_1 t + c_2 t^2 where its stretch s + t s' is positive
/// and the square is, otherwise 0. It is that of the drop which the bond is next to make: the
/// energy that this sets free over the energy that its law takes, times the square of the stretch
/// that it bears.
struct BondDrive {
  double stretch = 0.0, rate = 0.0;  ///< s, s'
  std::array<double, 3> squared{};   ///< c_k

  /// That of a bond which its own stretch alone drives.
  [[nodiscard]] static BondDrive by_stretch(double stretch, double rate) {
    return {stretch, rate, {stretch * stretch, 2.0 * stretch * rate, rate * rate}};
  }
  /// The equivalent stretch at t = 0.
  [[nodiscard]] double driving() const {
    return stretch > 0.0 ? std::sqrt(std::max(squared[0], 0.0)) : 0.0;
  }
};

}  // namespace peristat
