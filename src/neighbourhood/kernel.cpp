#include "src/neighbourhood/kernel.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "src/core/integral.hpp"
#include "src/neighbourhood/lattice_kernel.hpp"

namespace peristat {

double linear_partial_volume(double distance, double horizon, double size) {
  const double share = std::clamp((horizon + 0.5 * size - distance) / size, 0.0, 1.0);
  return share < least_share ? 0.0 : share;  // round-off at the far end is no bond
}

double Kernel::partial_volume(double distance, double size) const {
  if (volume_correction == VolumeCorrection::linear) {
    return linear_partial_volume(distance, horizon, size);
  }
  return distance <= inclusive_radius(horizon) ? 1.0 : 0.0;
}

double Kernel::influence_at(double distance) const {
  if (!influence) return 1.0;
  const double ratio = distance / horizon;
  const double omega = influence(std::abs(ratio - 1.0) <= horizon_tolerance ? 1.0 : ratio);
  return omega < horizon_tolerance ? 0.0 : omega;
}

double Kernel::search_radius(const Spacing& largest_size) const {
  if (volume_correction == VolumeCorrection::none) return reach();
  if (volume_correction == VolumeCorrection::linear) return horizon + 0.5 * largest_size;
  double squared = 0.0;  // of the diagonal
  for (int c = 0; c < dimension; ++c) squared += largest_size.along(c) * largest_size.along(c);
  return horizon + 0.5 * std::sqrt(squared);
}

double Kernel::moment(int k) const {
  constexpr double pi = std::numbers::pi;
  const double unit_sphere = dimension == 1 ? 2.0 : dimension == 2 ? 2.0 * pi : 4.0 * pi;
  const int power = k + dimension;
  const double radial =
      influence
          ? integral([&](double ratio) { return influence(ratio) * std::pow(ratio, power - 1); },
                     0.0, 1.0)
          : 1.0 / power;
  return cross_section * unit_sphere * radial * std::pow(horizon, power) *
         mean_of_reach(shape, dimension, power);
}

double Kernel::cloud_moment(int k, double size) const {
  if (volume_correction != VolumeCorrection::linear) return moment(k);
  const int power = k + dimension;
  const auto shell = [&](double ratio) {
    return partial_volume(ratio * horizon, size) * influence_at(ratio * horizon) *
           std::pow(ratio, power - 1);
  };
  const double half = 0.5 * size / horizon;
  const double inside = integral(shell, 0.0, 1.0 - half);
  const double around = integral(shell, 1.0 - half, 1.0) + integral(shell, 1.0, 1.0 + half);
  Kernel whole = *this;
  whole.influence = {};
  return whole.moment(k) * power * (inside + around);
}

double Kernel::lattice_moment(int k, const Spacing& spacing) const {
  const LatticeKernel lattice(*this, spacing);
  const double cell = std::pow(spacing, dimension) * cross_section;
  double sum = 0.0;
  lattice.for_each_neighbour([&](const LatticeStep& step, double factor) {
    sum += cell * factor * std::pow(lattice.distance(step), k);
  });
  return sum;
}

}  // namespace peristat
