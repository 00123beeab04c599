#include "solvers/ranks/part_bonds.hpp"

#include <stdexcept>

namespace peristat {
namespace {

double reach_here(const Points& points, SurfaceCorrection surface, const BondSetting& setting) {
  const double once = search_radius(points, setting);
  return surface == SurfaceCorrection::none ? once : 2.0 * once;
}

}  // namespace

double reach_of_bonds(const Points& points, SurfaceCorrection surface, const BondSetting& setting,
                      const Communicator& ranks) {
  return ranks.max(reach_here(points, surface, setting));
}

Bonds make_bonds(const Part& part, SurfaceCorrection surface, const BondSetting& setting,
                 int threads) {
  if (part.reach < reach_here(part.points, surface, setting)) {
    throw std::logic_error("the ghosts of a part don't reach as far as its bonds");
  }
  Bonds bonds = make_bonds(part.points, surface, setting, threads);
  bonds.remove_if([&](Index i, Offset bond) {
    return !is_owned(part.points, i) && !is_owned(part.points, bonds.partner[std::size_t(bond)]);
  });
  return bonds;
}

GlobalIndex count_bonds(const Points& points, const Bonds& bonds, const Communicator& ranks) {
  GlobalIndex ends = 0;  // that are this rank's
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      if (bonds.weight(bond) == 0.0) continue;
      ends += int(is_owned(points, i)) + int(is_owned(points, bonds.partner[std::size_t(bond)]));
    }
  }
  return ranks.count_all(ends).all / 2;
}

}  // namespace peristat
