#include "solvers/ranks/part_bonds.hpp"

#include <stdexcept>

#include "solvers/ranks/agree_on_kinds.hpp"
#include "src/geometry/counts_bond.hpp"

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
                 const Communicator& ranks, int threads) {
  if (part.reach < reach_here(part.points, surface, setting)) {
    throw std::logic_error("the ghosts of a part don't reach as far as its bonds");
  }
  Bonds bonds = make_bonds(part.points, surface, setting, threads);
  // Ghosts come last, so that a lower point that is one has no other partners.
  bonds.remove_if([&](Index i, Offset) { return part.is_ghost(i); });
  agree_on_kinds(bonds, part, ranks);
  return bonds;
}

GlobalIndex count_bonds(const Points& points, const Bonds& bonds, const Communicator& ranks) {
  GlobalIndex mine = 0;
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Index j = bonds.partner[std::size_t(bond)];
      if (bonds.weight(bond) != 0.0 && counts_bond(points, i, j)) ++mine;
    }
  }
  return ranks.count_all(mine).all;
}

}  // namespace peristat
