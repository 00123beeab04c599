#pragma once

#include <array>
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
  /// Of a point of the body that is pressed on others, which are its obstacle: that point, and
  /// these with their shares.
  struct Partner {
    Index point = 0;
    double share = 0.0;
  };
  Index point = -1;
  std::vector<Partner> partners{};
  double friction = 0.0, stiffness = 0.0;  ///< mu, k_t [N/m]
};

/// Ascending by contact.
using Slips = std::vector<Slip>;

/// What rubs: points on obstacles, on one another, or on faces.
enum class Rub { obstacles, pairs, faces };
inline constexpr std::array all_rubs{Rub::obstacles, Rub::pairs, Rub::faces};

}  // namespace peristat
