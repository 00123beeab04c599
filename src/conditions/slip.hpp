#pragma once

#include <cstddef>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// What a state remembers of a contact with friction.
struct Slip {
  std::size_t contact = 0;    ///< number of the contact
  double normal_force = 0.0;  ///< that limits the friction [N]
  Coordinates normal{};       ///< of the surface
  Coordinates elastic{};      ///< displacement that the friction still springs back from [m]
  Coordinates start{};        ///< displacement relative to the obstacle where that was so [m]
};

/// Ascending by contact.
using Slips = std::vector<Slip>;

}  // namespace peristat
