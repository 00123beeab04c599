#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "src/core/communicator.hpp"

// Also compiled as C++17.

namespace peristat {

/// Amount of data that a rank sends to others.
struct Traffic {
  std::int64_t exchanges = 0;
  std::int64_t messages = 0;  ///< of all exchanges
  std::int64_t bytes = 0;
};

/// Copies owners' values to their ghosts, by Tpetra::Import.
class GhostExchange {
 public:
  virtual ~GhostExchange() = default;

  /// Overwrites the values of ghosts. Collective.
  /// @param values `width` per point, see make_ghost_exchange: of owned points, then of ghosts
  virtual void update(double* values) = 0;

  /// Data that this rank has sent so far.
  [[nodiscard]] virtual Traffic traffic() const = 0;
};

/// @param owned, ghosts numbers in the whole body of the points that this rank owns, and of those
///        whose values it needs; each is owned by one rank
/// @param width values per point
/// @throws std::logic_error for a ghost that no other rank owns
[[nodiscard]] std::unique_ptr<GhostExchange> make_ghost_exchange(
    const Communicator& ranks, const std::vector<std::int64_t>& owned,
    const std::vector<std::int64_t>& ghosts, int width);

}  // namespace peristat
