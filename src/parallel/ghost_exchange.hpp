#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "src/parallel/communicator.hpp"

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

}  // namespace peristat
