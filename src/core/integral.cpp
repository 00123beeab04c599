#include "src/core/integral.hpp"

#include <cmath>

#include <boost/math/quadrature/gauss_kronrod.hpp>

namespace peristat {
namespace {

using Function = std::function<double(double)>;
using Rule = boost::math::quadrature::gauss_kronrod<double, 21>;

struct Panel {
  double from = 0.0, to = 0.0;
  double value = 0.0, error = 0.0;
  double size = 0.0;  ///< integral of |f|
};

/// Applies the rule once. Boost can halve panels, too, but it compares errors on [-1, 1] with a
/// tolerance for [from, to]: over a short range it would halve to the end, a million times.
Panel panel(const Function& of, double from, double to) {
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
  const auto on_unit = [&](double t) { return of(middle + half * t); };
  double error = 0.0, size = 0.0;
  const double value = Rule::integrate(on_unit, -1.0, 1.0, 0, 0.0, &error, &size);
  return {from, to, half * value, std::abs(half) * error, std::abs(half) * size};
}

double refined(const Function& of, const Panel& whole, double tolerance, int most_halvings) {
  if (most_halvings == 0 || !(whole.error > tolerance)) return whole.value;
  const double middle = 0.5 * (whole.from + whole.to);
  return refined(of, panel(of, whole.from, middle), tolerance, most_halvings - 1) +
         refined(of, panel(of, middle, whole.to), tolerance, most_halvings - 1);
}

}  // namespace

double integral(const Function& of, double from, double to) {
  constexpr int most_halvings = 40;             // a panel with a jump is then 1e-12 of the range
  constexpr double relative_tolerance = 1e-14;  // some tens of round-offs
  const Panel whole = panel(of, from, to);
  return refined(of, whole, relative_tolerance * whole.size, most_halvings);
}

}  // namespace peristat
