#include "src/core/integral.hpp"

#include <boost/math/quadrature/gauss_kronrod.hpp>

namespace peristat {

double integral(const std::function<double(double)>& of, double from, double to) {
  constexpr unsigned most_halvings = 20;
  constexpr double relative_tolerance = 1e-14;
  return boost::math::quadrature::gauss_kronrod<double, 21>::integrate(of, from, to, most_halvings,
                                                                       relative_tolerance);
}

}  // namespace peristat
