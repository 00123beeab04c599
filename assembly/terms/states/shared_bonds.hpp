#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "src/core/types.hpp"
#include "src/parallel/communicator.hpp"

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

/// Rounds in which bonds may be decided on together as if one by one: every bond comes after those
/// before it that share a point with it. Of positions in `bonds`.
[[nodiscard]] std::vector<std::vector<std::size_t>> rounds_of(std::span<const SharedBond> bonds);

}  // namespace peristat
