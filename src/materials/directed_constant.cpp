#include "src/materials/directed_constant.hpp"

#include <algorithm>
#include <cmath>

namespace peristat {
namespace {

using Triple = std::array<double, 3>;

/// <t^k> over all directions, k = 0 … 4.
constexpr std::array<double, 5> moments_2d{1.0, 1.0 / 2, 3.0 / 8, 5.0 / 16, 35.0 / 128};
constexpr std::array<double, 5> moments_3d{1.0, 1.0 / 3, 1.0 / 5, 1.0 / 7, 1.0 / 9};

double determinant(const Triple& a, const Triple& b, const Triple& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// c_11, c_22 and c_12 [Pa].
Triple elasticity(const FibreModuli& moduli, int dimension) {
  const auto [e1, e2, g] = moduli;
  if (dimension == 2) {
    const double c11 = 0.5 * (e1 + std::sqrt(e1 * e1 + 4.0 * g * g * e1 / e2));
    return {c11, c11 * e2 / e1, g};
  }
  const double c22 = 9.0 / 16.0 * (e2 + std::sqrt(e2 * e2 + 16.0 / 9.0 * g * g * e2 / e1));
  return {e1 + 1.5 * g * g / c22, c22, g};
}

}  // namespace

double DirectedConstant::least() const {
  const auto [b0, b1, b2] = coefficients;
  double least = std::min(at(0.0), at(1.0));
  const double turn = b2 > 0.0 ? -0.5 * b1 / b2 : -1.0;
  if (turn > 0.0 && turn < 1.0) least = std::min(least, at(turn));
  return least;
}

double natural_shear(double along, double across, const BondSetting& setting) {
  return std::sqrt(along * across) / (2.0 * (1.0 + poisson_ratio(setting)));
}

DirectedConstant directed_micromodulus(const FibreModuli& moduli, const Coordinates& fibre,
                                       const BondSetting& setting) {
  const bool is_plane = setting.dimension == 2;
  const auto& m = is_plane ? moments_2d : moments_3d;
  const double across = is_plane ? 1.0 : 3.0 / 8, mixed = is_plane ? 1.0 : 1.0 / 2;
  // Columns of the three equations for b_0, b_1, b_2.
  std::array<Triple, 3> column;
  for (std::size_t k = 0; k < 3; ++k) {
    column[k] = {m[k + 2], across * (m[k] - 2.0 * m[k + 1] + m[k + 2]),
                 mixed * (m[k + 1] - m[k + 2])};
  }
  const Triple c = elasticity(moduli, setting.dimension);
  const double scale = 0.5 * setting.moment(1) * determinant(column[0], column[1], column[2]);
  return {
      {determinant(c, column[1], column[2]) / scale, determinant(column[0], c, column[2]) / scale,
       determinant(column[0], column[1], c) / scale},
      fibre};
}

std::array<double, 2> possible_shear(const FibreModuli& moduli, const BondSetting& setting) {
  constexpr int steps = 2000;
  std::array<double, 2> range{};
  FibreModuli tried = moduli;
  for (int k = 0; k <= steps; ++k) {
    tried.shear = std::sqrt(moduli.along * moduli.across) * std::pow(10.0, 4.0 * k / steps - 3.0);
    if (!(directed_micromodulus(tried, {1.0, 0.0, 0.0}, setting).least() > 0.0)) continue;
    if (range[0] == 0.0) range[0] = tried.shear;
    range[1] = tried.shear;
  }
  return range;
}

}  // namespace peristat
