#include "src/potentials/tanh_degradation.hpp"

#include <cmath>
#include <numbers>

namespace peristat {
namespace {

/// Dilogarithm Li_2(-z) for 0 <= z <= 1: with u = -ln(1 + z) the series sum_n B_n u^(n+1)/(n+1)! of
/// the Bernoulli numbers, whose terms fall by a factor of 80 each (Vollinga and Weinzierl 2005).
double dilogarithm_of_minus(double z) {
  constexpr double coefficients[] = {
      1.0 / 36.0,        -1.0 / 3600.0,           1.0 / 211680.0,         -1.0 / 10886400.0,
      1.0 / 526901760.0, -4.0647616451442255e-11, 8.9216910204564526e-13, -1.9939295860721076e-14};
  const double u = -std::log1p(z);
  double sum = 0.0;
  for (int k = 7; k >= 0; --k) sum = sum * u * u + coefficients[k];
  return u - 0.25 * u * u + u * u * u * sum;
}

/// Primitive of 1/(1 + exp y).
double first_primitive(double y) {
  return y > 0.0 ? -std::log1p(std::exp(-y)) : y - std::log1p(std::exp(y));
}

/// Primitive of y/(1 + exp y).
double second_primitive(double y) {
  constexpr double pi = std::numbers::pi;
  if (y < 0.0) return 0.5 * y * y - second_primitive(-y) - pi * pi / 6.0;
  const double z = std::exp(-y);
  return -y * std::log1p(z) + dilogarithm_of_minus(z);
}

}  // namespace

TanhDegradation TanhDegradation::continuous(double onset, double critical, double rate) {
  // 1/(1 + exp y) runs from (1 + tanh beta)/2 to (1 - tanh beta)/2.
  const double range = std::tanh(rate);
  return {onset, critical, rate, 1.0 / range, -0.5 * (1.0 - range) / range};
}

double TanhDegradation::exponent(double s) const {
  return 2.0 * rate * (2.0 * s - onset_stretch - critical_stretch) /
         (critical_stretch - onset_stretch);
}

double TanhDegradation::integrity(double s) const {
  if (s <= onset_stretch) return 1.0;
  if (s >= critical_stretch) return 0.0;
  return scale / (1.0 + std::exp(exponent(s))) + shift;
}

double TanhDegradation::slope(double s) const {
  if (s <= onset_stretch || s >= critical_stretch) return 0.0;
  const double share = 1.0 / (1.0 + std::exp(exponent(s)));
  return -4.0 * rate / (critical_stretch - onset_stretch) * scale * share * (1.0 - share);
}

double TanhDegradation::primitive(double y) const {
  const double a = 0.25 * (critical_stretch - onset_stretch) / rate;
  const double middle = 0.5 * (onset_stretch + critical_stretch);
  return a * middle * first_primitive(y) + a * a * second_primitive(y);
}

double TanhDegradation::work(const Harmonic&, double s) const {
  const double elastic = 0.5 * onset_stretch * onset_stretch;
  if (s <= onset_stretch) return 0.5 * s * s;
  const double end = s < critical_stretch ? s : critical_stretch;
  return elastic + scale * (primitive(exponent(end)) - primitive(exponent(onset_stretch))) +
         shift * (0.5 * end * end - elastic);
}

}  // namespace peristat
