#include "src/neighbourhood/lattice_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "src/geometry/box_in_ball.hpp"

namespace peristat {

LatticeKernel::LatticeKernel(const Kernel& kernel, const Spacing& spacing)
    : kernel_(kernel), spacing_(spacing) {
  for (int c = 0; c < kernel.dimension; ++c) {
    width_[std::size_t(c)] =
        static_cast<int>(std::ceil(kernel.search_radius(spacing) / spacing.along(c))) + 1;
  }
  factors_.reserve(std::size_t(width_[0] + 1) * std::size_t(width_[1] + 1) *
                   std::size_t(width_[2] + 1));
  // In square or cubic cells, steps that differ by the order of axes alone have the same factor.
  std::map<LatticeStep, double> known;
  for (int x = 0; x <= width_[0]; ++x) {
    for (int y = 0; y <= width_[1]; ++y) {
      for (int z = 0; z <= width_[2]; ++z) {
        if (!kernel.has_exact_shares() || !spacing.is_square()) {
          factors_.push_back(find_factor({x, y, z}));
          continue;
        }
        const auto [least, most] = std::minmax({x, y, z});
        const LatticeStep step{most, x + y + z - most - least, least};
        const auto [at, is_new] = known.try_emplace(step, 0.0);
        if (is_new) at->second = find_factor(step);
        factors_.push_back(at->second);
      }
    }
  }
}

double LatticeKernel::factor(const LatticeStep& step) const {
  std::size_t at = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const int steps = std::abs(step[c]);
    if (steps > width_[c]) return 0.0;
    at = at * std::size_t(width_[c] + 1) + std::size_t(steps);
  }
  return factors_[at];
}

double LatticeKernel::distance(const LatticeStep& step) const {
  const auto [x, y, z] = step;
  return spacing_.is_square()
             ? spacing_ * std::sqrt(double(x * x + y * y + z * z))
             : std::hypot(spacing_.along(0) * x, spacing_.along(1) * y, spacing_.along(2) * z);
}

double LatticeKernel::find_factor(const LatticeStep& step) const {
  const double between = distance(step);
  if (between == 0.0) return 0.0;
  Coordinates centre{}, edges{};
  for (int c = 0; c < kernel_.dimension; ++c) {
    edges[std::size_t(c)] = spacing_.along(c);
    centre[std::size_t(c)] = spacing_.along(c) * step[std::size_t(c)];
  }
  if (!kernel_.has_exact_shares()) {
    const double at =
        kernel_.shape == HorizonShape::ball ? between : norm_of(kernel_.shape, centre);
    return kernel_.partial_volume(at, spacing_) * kernel_.influence_at(at);
  }
  const auto [share, centroid] = box_in_ball(centre, edges, kernel_.horizon, kernel_.dimension);
  if (share < least_share) return 0.0;
  if (kernel_.volume_correction == VolumeCorrection::exact) {
    return share * kernel_.influence_at(between);
  }
  const double counted = std::hypot(centroid[0], centroid[1], centroid[2]);
  return share * kernel_.influence_at(counted) * counted / between;
}

}  // namespace peristat
