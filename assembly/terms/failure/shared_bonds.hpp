#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "assembly/terms/failure/one_by_one.hpp"
#include "src/core/types.hpp"
#include "src/neighbourhood/bonds.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/communicator.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// A driven bond as all ranks know it.
struct SharedBond {
  double utilisation = 0.0;
  std::array<GlobalIndex, 2> ends{};  ///< numbers of its points in the whole body
  int rank = 0;                       ///< that decides on it
  std::size_t number = 0;             ///< among those of its rank
};

/// The bonds of all ranks, the most utilised first, of equal ones in the order of their points.
/// Collective; alike on all ranks.
[[nodiscard]] std::vector<SharedBond> in_order(const Communicator& ranks,
                                               std::vector<SharedBond> mine);

/// What the loss of a bond changes for others.
enum class LossReaches {
  bonds_of_points,  ///< those that share a point with it
  any_bond          ///< also others near it
};

/// Rounds in which bonds may be decided on together as if one by one: every bond comes after those
/// before it that its loss depends on. Of positions in `bonds`.
[[nodiscard]] std::vector<std::vector<std::size_t>> rounds_of(std::span<const SharedBond> bonds,
                                                              LossReaches reaches);

/// As damage_one_by_one, for the driven bonds of all ranks. Collective.
/// @param find see driven_in_order
/// @param decide(bond) returns an array of what the bond of this rank loses, the first positive if
///        it is damaged
/// @param take(ends, bond, loss) called on all ranks, with the ends and the bond as far as they are
///        here
template <class Find, class Decide, class Take>
void damage_on_ranks(const IndexMap& index_map, const Bonds& bonds, LossReaches reaches, int parts,
                     const Find& find, const Decide& decide, const Take& take) {
  const Communicator& ranks = index_map.ranks();
  for (bool any = true; any;) {
    const std::vector<DrivenBond> mine = driven_in_order(parts, find);
    if (!any_of_all(ranks, !mine.empty())) return;
    std::vector<SharedBond> all;
    for (std::size_t k = 0; k < mine.size(); ++k) {
      const Index j = bonds.partner(mine[k].point, mine[k].bond);
      all.push_back({mine[k].utilisation,
                     {index_map.number_of(mine[k].point), index_map.number_of(j)},
                     ranks.rank(),
                     k});
    }
    all = in_order(ranks, std::move(all));
    any = false;
    for (const std::vector<std::size_t>& round : rounds_of(all, reaches)) {
      using Loss = decltype(decide(mine.front()));
      constexpr std::size_t width = std::tuple_size_v<Loss>;
      std::vector<double> losses(width * round.size());
      for (std::size_t k = 0; k < round.size(); ++k) {
        const SharedBond& one = all[round[k]];
        if (one.rank == ranks.rank())
          std::ranges::copy(decide(mine[one.number]), losses.begin() + std::ptrdiff_t(width * k));
      }
      add_up(ranks, losses);
      for (std::size_t k = 0; k < round.size(); ++k) {
        Loss loss;
        std::copy_n(losses.begin() + std::ptrdiff_t(width * k), width, loss.begin());
        if (!(loss.front() > 0.0)) continue;
        any = true;
        const std::array ends{index_map.find(all[round[k]].ends[0]),
                              index_map.find(all[round[k]].ends[1])};
        take(ends, ends[0] && ends[1] ? bonds.find(*ends[0], *ends[1]) : std::nullopt, loss);
      }
    }
  }
}

}  // namespace peristat
