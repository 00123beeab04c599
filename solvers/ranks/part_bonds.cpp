#include "solvers/ranks/part_bonds.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "solvers/ranks/agree_on_kinds.hpp"
#include "src/geometry/counts_bond.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

double reach_here(const Points& points, SurfaceCorrection surface, const BondSetting& setting,
                  PartBonds which) {
  const int more = int(surface != SurfaceCorrection::none) + int(which == PartBonds::of_neighbours);
  return (1 + more) * search_radius(points, setting);
}

/// True for each point or image that this rank owns, or that has a bond with such a one.
std::vector<char> owned_and_neighbours(const Part& part, const Bonds& bonds) {
  const Points& points = part.points;
  std::vector<char> is_near(points.volume.size(), 0);
  for (Index i = 0; i < points.count(); ++i) {
    if (points.owns(i)) is_near[std::size_t(i)] = 1;
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Index j = bonds.partner(i, bond);
      if (points.owns(i)) is_near[std::size_t(j)] = 1;
      if (points.owns(j)) is_near[std::size_t(i)] = 1;
    }
  }
  return is_near;
}

}  // namespace

double reach_of_bonds(const Points& points, SurfaceCorrection surface, const BondSetting& setting,
                      const Communicator& ranks, PartBonds which) {
  return ranks.max(reach_here(points, surface, setting, which));
}

Bonds make_bonds(const Part& part, SurfaceCorrection surface, const BondSetting& setting,
                 const Communicator& ranks, int threads, PartBonds which) {
  if (part.reach < reach_here(part.points, surface, setting, which)) {
    throw std::logic_error("the ghosts of a part don't reach as far as its bonds");
  }
  Bonds bonds = make_bonds(part.points, surface, setting, threads);
  const std::vector<char> is_near = owned_and_neighbours(part, bonds);
  bonds.remove_if([&](Index i, Offset bond) {
    const Index j = bonds.partner(i, bond);
    if (part.points.owns(i) || part.points.owns(j)) return false;
    const bool near_i = is_near[std::size_t(i)] != 0, near_j = is_near[std::size_t(j)] != 0;
    if (which == PartBonds::among_neighbours) return !(near_i && near_j);
    return which == PartBonds::of_owned || !(near_i || near_j);
  });
  const std::span<const GlobalIndex> numbers = part.number;
  const auto owned = std::size_t(part.owned);
  agree_on_kinds(bonds, part.points, {numbers.first(owned), numbers.subspan(owned), part.owner},
                 ranks);
  return bonds;
}

GlobalIndex count_bonds(const Points& points, const Bonds& bonds, const Communicator& ranks) {
  GlobalIndex mine = 0;
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Index j = bonds.partner(i, bond);
      if (bonds.weight(bond) != 0.0 && counts_bond(points, i, j)) ++mine;
    }
  }
  return ranks.count_all(mine).all;
}

GlobalIndex count_interactions(const Points& points, const InteractionCount& here,
                               const Communicator& ranks) {
  GlobalIndex corners = 0;
  for (Index i = 0; i < points.count(); ++i) {
    if (points.owns(i)) corners += here.per_point[std::size_t(i)];
  }
  const int of_each = here.orders == 1 ? 2 : here.orders == 2 ? 3 : 4;  // orders = (of_each - 1)!
  return ranks.count_all(corners).all / of_each;
}

}  // namespace peristat
