#include "assembly/terms/bonds/stretches_along.hpp"

#include "assembly/terms/bonds/bond_look.hpp"

namespace peristat {
namespace {

template <int D>
std::vector<BondDrive> along(const Points& points, const Bonds& bonds, const StateView& at,
                             const StateLine& line, int threads) {
  const BondLook<D> look(points, bonds, at);
  std::vector<BondDrive> all(std::size_t(bonds.count()));
#pragma omp parallel for num_threads(threads)
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const auto [value, rate] = look.along(i, bond, line);
      all[std::size_t(bond)] = BondDrive::by_stretch(value, rate);
    }
  }
  return all;
}

}  // namespace

std::vector<BondDrive> stretches_along(const Points& points, const Bonds& bonds,
                                       const StateView& at, const StateLine& line, int threads) {
  switch (points.dimension) {
    case 1:
      return along<1>(points, bonds, at, line, threads);
    case 2:
      return along<2>(points, bonds, at, line, threads);
    default:
      return along<3>(points, bonds, at, line, threads);
  }
}

}  // namespace peristat
