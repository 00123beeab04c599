#include "assembly/terms/failure/neighbour_sums.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "assembly/convolutions/linear_bonds.hpp"

namespace peristat {

NeighbourSums neighbour_sums(const Bonds& bonds, std::span<const double> integrity) {
  NeighbourSums sums{std::vector<double>(integrity.size()), std::vector<double>(integrity.size())};
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Index j = bonds.partner(i, bond);
      const double left = integrity[std::size_t(i)] * integrity[std::size_t(j)];
      for (const Index point : {i, j}) {
        sums.weight[std::size_t(point)] += left * bonds.weight(bond);
        sums.count[std::size_t(point)] += left;
      }
    }
  }
  return sums;
}

NeighbourSums neighbour_sums(const CutLattice& box, std::span<const LatticeSpring> springs,
                             double micromodulus, std::span<const double> integrity,
                             std::size_t own, int threads) {
  std::array<std::vector<double>, 2> kernels;
  auto& [weight, one] = kernels;
  one.assign(springs.size(), 1.0);
  for (const LatticeSpring& spring : springs) {
    const double length = std::hypot(spring.arm[0], spring.arm[1], spring.arm[2]);
    weight.push_back(spring.stiffness * length / micromodulus);
  }
  std::vector<std::vector<double>> found = lattice_sums(box, springs, kernels, integrity, threads);
  NeighbourSums sums{std::move(found[0]), std::move(found[1])};
  if (own < integrity.size()) {
    std::vector<double> without_images(integrity.begin(), integrity.end());
    std::fill(without_images.begin() + std::ptrdiff_t(own), without_images.end(), 0.0);
    found = lattice_sums(box, springs, kernels, without_images, threads);
    for (std::size_t i = 0; i < integrity.size(); ++i) {
      sums.weight[i] = 0.5 * ((i < own ? sums.weight[i] : 0.0) + found[0][i]);
      if (i >= own) sums.count[i] = found[1][i];
    }
  }
  for (std::size_t i = 0; i < integrity.size(); ++i) {
    sums.weight[i] *= integrity[i];
    sums.count[i] *= integrity[i];
  }
  return sums;
}

}  // namespace peristat
