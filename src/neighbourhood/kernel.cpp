#include "src/neighbourhood/kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "src/core/integral.hpp"
#include "src/neighbourhood/horizon.hpp"

namespace peristat {

double linear_partial_volume(double distance, double horizon, double size) {
  const double share = std::clamp((horizon + 0.5 * size - distance) / size, 0.0, 1.0);
  return share < horizon_tolerance ? 0.0 : share;  // round-off at the far end is no bond
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

double Kernel::search_radius(double largest_size) const {
  return volume_correction == VolumeCorrection::none ? horizon : horizon + 0.5 * largest_size;
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
  return cross_section * unit_sphere * radial * std::pow(horizon, power);
}

double Kernel::lattice_moment(int k, const Spacing& spacing) const {
  std::array<int, 3> width{};
  for (int c = 0; c < dimension; ++c) {
    width[c] = static_cast<int>(std::ceil(horizon / spacing.along(c))) + 1;
  }
  const double cell = std::pow(spacing, dimension) * cross_section;
  double sum = 0.0;
  for (int x = -width[0]; x <= width[0]; ++x) {
    for (int y = -width[1]; y <= width[1]; ++y) {
      for (int z = -width[2]; z <= width[2]; ++z) {
        const double distance =
            spacing.is_square()
                ? spacing * std::sqrt(double(x * x + y * y + z * z))
                : std::hypot(spacing.along(0) * x, spacing.along(1) * y, spacing.along(2) * z);
        const double share = distance > 0.0 ? partial_volume(distance, spacing) : 0.0;
        if (share == 0.0) continue;
        sum += cell * share * influence_at(distance) * std::pow(distance, k);
      }
    }
  }
  return sum;
}

}  // namespace peristat
