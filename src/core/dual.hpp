#pragma once

namespace peristat {

/// A number and its derivative along a direction (dual number); sums and products are
/// differentiated exactly, d(a b) = a db + b da.
struct Dual {
  double value = 0.0, rate = 0.0;

  constexpr Dual() = default;
  constexpr Dual(double of_value, double of_rate = 0.0) : value(of_value), rate(of_rate) {}

  Dual& operator+=(const Dual& b) { return *this = *this + b; }
  Dual& operator-=(const Dual& b) { return *this = *this - b; }

  friend constexpr Dual operator+(const Dual& a, const Dual& b) {
    return {a.value + b.value, a.rate + b.rate};
  }
  friend constexpr Dual operator-(const Dual& a, const Dual& b) {
    return {a.value - b.value, a.rate - b.rate};
  }
  friend constexpr Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, a.value * b.rate + a.rate * b.value};
  }
};

}  // namespace peristat
