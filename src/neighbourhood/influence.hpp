#pragma once

#include <cmath>
#include <concepts>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace peristat {

/// omega(x) of the distance over the horizon, x = r / delta: smooth from 0 to 1. Beyond 1, where
/// points may lie whose cells reach into the horizon, the function's own value counts.
template <class I>
concept Influence = std::is_aggregate_v<I> && requires(const I influence, double x) {
  { I::name } -> std::convertible_to<std::string_view>;
  { influence(x) } -> std::same_as<double>;
};

/// omega_0 of [GPMB] 2.1.1: 1 everywhere.
struct ConstantInfluence {
  static constexpr const char* name = "constant";
  double operator()(double) const { return 1.0; }
};

/// omega_0.5: 1 up to the horizon, 0 beyond.
struct PiecewiseConstantInfluence {
  static constexpr const char* name = "piecewise_constant";
  double operator()(double x) const { return x <= 1.0 ? 1.0 : 0.0; }
};

/// omega_1 = 1 - x, 0 beyond the horizon as are those that follow.
struct LinearInfluence {
  static constexpr const char* name = "linear";
  double operator()(double x) const { return x < 1.0 ? 1.0 - x : 0.0; }
};

/// omega_3 = 1 - 3 x^2 + 2 x^3 = (1 - x)^2 (1 + 2 x)
struct CubicInfluence {
  static constexpr const char* name = "cubic";
  double operator()(double x) const {
    return x < 1.0 ? (1.0 - x) * (1.0 - x) * (1.0 + 2.0 * x) : 0.0;
  }
};

/// omega_5 = 1 - 10 x^3 + 15 x^4 - 6 x^5 = (1 - x)^3 (1 + 3 x + 6 x^2)
struct QuinticInfluence {
  static constexpr const char* name = "quintic";
  double operator()(double x) const {
    const double left = 1.0 - x;
    return x < 1.0 ? left * left * left * (1.0 + x * (3.0 + 6.0 * x)) : 0.0;
  }
};

/// omega_7 = 1 - 35 x^4 + 84 x^5 - 70 x^6 + 20 x^7 = (1 - x)^4 (1 + 4 x + 10 x^2 + 20 x^3)
struct SepticInfluence {
  static constexpr const char* name = "septic";
  double operator()(double x) const {
    const double squared = (1.0 - x) * (1.0 - x);
    return x < 1.0 ? squared * squared * (1.0 + x * (4.0 + x * (10.0 + 20.0 * x))) : 0.0;
  }
};

/// exp(-x^2), everywhere
struct GaussianInfluence {
  static constexpr const char* name = "gaussian";
  double operator()(double x) const { return std::exp(-x * x); }
};

/// 1/x, everywhere: the force per relative displacement is the same for all bonds.
struct InverseInfluence {
  static constexpr const char* name = "inverse";
  double operator()(double x) const { return 1.0 / x; }
};

template <Influence... Each>
struct InfluenceList {
  /// Calls visit(influence) for each of them.
  template <class Visit>
  static void for_each(const Visit& visit) {
    (visit(Each{}), ...);
  }
};

/// The list of influence functions; a case file chooses by their names.
using Influences =
    InfluenceList<ConstantInfluence, PiecewiseConstantInfluence, LinearInfluence, CubicInfluence,
                  QuinticInfluence, SepticInfluence, GaussianInfluence, InverseInfluence>;

/// Names of all of them.
[[nodiscard]] std::vector<std::string> influence_names();

/// The function of a name; empty for the constant 1 and for an unknown name.
[[nodiscard]] std::function<double(double)> influence_named(const std::string& name);

}  // namespace peristat
