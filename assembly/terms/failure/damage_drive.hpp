#pragma once

namespace peristat {

/// What drives the damage of a bond.
enum class DamageDrive {
  stretch,  ///< its stretch s
  release   ///< what its loss would set free, as an equivalent stretch: see BondFailure
};

}  // namespace peristat
