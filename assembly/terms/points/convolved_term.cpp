#include "assembly/terms/points/convolved_term.hpp"

#include <array>
#include <utility>

#include "assembly/convolutions/green_bonds.hpp"
#include "assembly/terms/workspace.hpp"

namespace peristat {

ConvolvedTerm::ConvolvedTerm(std::shared_ptr<const Bonds> bonds, double micromodulus,
                             BearableEnergies bearable, ConvolvedLattice lattice, ConvolvedLaw law,
                             int threads)
    : PointTerm(std::move(bonds), micromodulus, std::move(bearable), std::move(lattice), threads),
      law_(std::move(law)) {}

std::unique_ptr<LatticeForces> ConvolvedTerm::forces(const Points& /*points*/,
                                                     Workspace& shared) const {
  constexpr std::array<bool, 3> open{};
  if (const ConvolvedCorrespondence* of = correspondence()) {
    return std::make_unique<Correspondence>(lattice()->box, open, of->arms, of->setting,
                                            shared.threads());
  }
  return with_images(*lattice(), [&] {
    return std::make_unique<GreenBonds>(lattice()->box, open, lattice()->springs, shared.threads());
  });
}

Balances ConvolvedTerm::balances() const {
  const bool turns_freely = correspondence() == nullptr || !point_failure().can_fail();
  return {true, turns_freely, true, true, false};
}

double ConvolvedTerm::bytes_of_forces() const {
  if (correspondence() != nullptr) {
    return Correspondence::expected_bytes(lattice()->box, lattice()->springs);
  }
  return (lattice()->has_images() ? 2.0 : 1.0) *
         GreenBonds::expected_bytes(lattice()->box, lattice()->springs);
}

}  // namespace peristat
