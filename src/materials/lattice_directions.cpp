#include "src/materials/lattice_directions.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <boost/math/quadrature/gauss.hpp>

#include "src/core/coordinates.hpp"

namespace peristat {
namespace {

/// Gauss's points and weights over [0, 1].
template <unsigned count>
std::vector<std::array<double, 2>> gauss_rule() {
  using Rule = boost::math::quadrature::gauss<double, count>;
  static_assert(count % 2 == 0);
  std::vector<std::array<double, 2>> rule;
  for (std::size_t k = 0; k < Rule::abscissa().size(); ++k) {
    const double x = Rule::abscissa()[k], weight = 0.5 * Rule::weights()[k];
    rule.push_back({0.5 * (1.0 - x), weight});
    rule.push_back({0.5 * (1.0 + x), weight});
  }
  return rule;
}

}  // namespace

std::vector<Coordinates> even_directions(int dimension, int count) {
  if (dimension == 1) return {};
  std::vector<Coordinates> directions;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int k = 0; k < count; ++k) {
    const double share = (k + 0.5) / count;
    const double ring = std::sqrt(1.0 - share * share);
    directions.push_back(dimension == 2 ? Coordinates{std::cos(std::numbers::pi * share),
                                                      std::sin(std::numbers::pi * share), 0.0}
                                        : Coordinates{ring * std::cos(golden * k),
                                                      ring * std::sin(golden * k), share});
  }
  return directions;
}

std::vector<WeightedDirection> sector_directions(int dimension) {
  if (dimension == 1) return {{{1.0, 0.0, 0.0}, 1.0}};
  std::vector<WeightedDirection> result;
  if (dimension == 2) {
    for (const auto& [share, weight] : gauss_rule<12>()) {
      const double angle = share * std::numbers::pi / 4.0;
      result.push_back({{std::cos(angle), std::sin(angle), 0.0}, weight});
    }
    return result;
  }
  double total = 0.0;
  for (const auto& [y, weight_y] : gauss_rule<4>()) {
    for (const auto& [share, weight_z] : gauss_rule<4>()) {
      const Coordinates along{1.0, y, share * y};
      // dy dz = y dy d(z/y), whose solid angle is 1/|n|^3 of it
      const double length = std::hypot(along[0], along[1], along[2]);
      const double weight = weight_y * weight_z * y / std::pow(length, 3);
      result.push_back({unit(along), weight});
      total += weight;
    }
  }
  for (WeightedDirection& of : result) of.weight /= total;
  return result;
}

std::vector<Coordinates> sector_corners(int dimension) {
  std::vector<Coordinates> corners{{1, 0, 0}};
  if (dimension > 1) corners.push_back(unit({1, 1, 0}));
  if (dimension > 2) corners.push_back(unit({1, 1, 1}));
  return corners;
}

}  // namespace peristat
