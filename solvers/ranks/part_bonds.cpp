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
  // Ghosts come last, so that a lower point that is one has no other partners.
  bonds.remove_if([&](Index i, Offset) { return part.is_ghost(i); });
  return bonds;
}

GlobalIndex count_bonds(Index owned, const Bonds& bonds, const Communicator& ranks) {
  GlobalIndex ends = 0;  // that are this rank's
  for (Offset bond = 0; bond < bonds.count(); ++bond) {
    if (bonds.weight(bond) == 0.0) continue;
    ends += bonds.partner[std::size_t(bond)] >= owned ? 1 : 2;
  }
  return ranks.count_all(ends).all / 2;
}

}  // namespace peristat
