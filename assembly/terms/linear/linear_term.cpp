#include "assembly/terms/linear/linear_term.hpp"

#include <array>
#include <utility>

#include "assembly/convolutions/linear_bonds.hpp"
#include "assembly/terms/linear/linear_bond_sums.hpp"
#include "assembly/terms/states/state_term.hpp"

namespace peristat {

LinearTerm::LinearTerm(std::shared_ptr<const Bonds> bonds, double micromodulus,
                       BearableEnergies bearable, std::optional<ConvolvedLattice> lattice,
                       int threads, std::optional<ConvolvedSolid> solid)
    : PointTerm(std::move(bonds), micromodulus, std::move(bearable), std::move(lattice), threads),
      solid_(std::move(solid)) {}

std::unique_ptr<LatticeForces> LinearTerm::forces(const Points& points, Workspace& shared) const {
  constexpr std::array<bool, 3> open{};
  if (!has_lattice()) {
    return std::make_unique<LinearBondSums>(points, bonds(), micromodulus(), shared);
  }
  const ConvolvedLattice& of = *lattice();
  if (solid_) {
    return std::make_unique<LinearSolid>(of.box, open, solid_->arms, solid_->setting,
                                         shared.threads());
  }
  return with_images(of, [&] {
    return std::make_unique<LinearBonds>(of.box, open, of.springs, shared.threads());
  });
}

double LinearTerm::bound_over_blocks(int dimension) const {
  if (!solid_) return 2.0;
  if (is_printed()) return 0.0;
  const std::span constants(&solid_->setting.constants, 1);
  return state_ratios(constants, dimension).bound_over_blocks();
}

Balances LinearTerm::balances() const {
  if (is_printed()) return {false, false, true, false, true};
  return {true, false, true, true, true};
}

double LinearTerm::bytes_of_forces() const {
  const ConvolvedLattice& of = *lattice();
  if (solid_) return convolved_bytes(of.box, solid_->arms);
  return (of.has_images() ? 2.0 : 1.0) * convolved_bytes(of.box, of.springs);
}

}  // namespace peristat
