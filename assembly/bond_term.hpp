#pragma once

#include "src/neighbourhood/bonds.hpp"
#include "src/potentials/potential.hpp"

namespace peristat {

/// One-neighbour interactions with their potential: energy sum over bonds of w psi(l; L). Constant
/// in a solve.
struct BondTerm {
  Bonds bonds;
  BondPotential potential;
};

}  // namespace peristat
