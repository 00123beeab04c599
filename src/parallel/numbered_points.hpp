#pragma once

#include <optional>
#include <span>

#include "src/core/types.hpp"

namespace peristat {

/// The points of a part by their numbers in the whole body: those that its rank owns, then ghosts.
struct NumberedPoints {
  std::span<const GlobalIndex> owned, ghosts;  ///< numbers, ascending
  std::span<const int> owner;                  ///< rank that owns each ghost

  [[nodiscard]] bool is_owned(Index point) const { return std::size_t(point) < owned.size(); }
  [[nodiscard]] bool is_ghost(Index point) const {
    return !is_owned(point) && std::size_t(point) < owned.size() + ghosts.size();
  }
  [[nodiscard]] GlobalIndex number_of(Index point) const {
    const auto at = std::size_t(point);
    return is_owned(point) ? owned[at] : ghosts[at - owned.size()];
  }
  [[nodiscard]] int owner_of_ghost(Index point) const {
    return owner[std::size_t(point) - owned.size()];
  }
  /// The point that has a number, if it is here.
  [[nodiscard]] std::optional<Index> find(GlobalIndex number) const;
};

}  // namespace peristat
