#pragma once

#include <vector>

#include "assembly/terms/bonds/bond_term.hpp"
#include "assembly/terms/bonds/bond_workspace.hpp"

namespace peristat {

/// The passes over bonds, with their potential.
class BondPasses : public TermPasses {
 public:
  BondPasses(const BondTerm& term, const TermSetting& setting);

  Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) override;
  Evaluation commit(std::span<const double> displacement, const SharedEnvironment& environment,
                    History& history, std::span<double> gradient, Write how) override;
  Evaluation commit_forces(std::span<const double> displacement,
                           const SharedEnvironment& environment, History& history,
                           std::span<double> gradient, Write how) override;
  DamageGrowth growth(const StateView& at) override;
  void tangent(const StateView& at, double projection, Tangent& tangent, Write how) override;
  void visit_tangent(const StateView& at, double projection, const RowVisitor& visit,
                     std::span<double> diagonal) override;
  void product(const StateView& at, std::span<const double> v, double projection,
               std::span<double> product, Write how) override;
  void point_energies(const StateView& at, std::span<double> energies, Write how) override;
  [[nodiscard]] bool shares_energy() const override { return true; }
  void add_virials(const StateView& at, std::span<double> virials) override;

 private:
  /// Calls body(dimension, law, history of the bonds, eigenstretch) with the dimension as a
  /// compile-time constant, the potential as its own type, and one for no eigenstretch.
  template <class Body>
  auto dispatch(const StateView& at, const Body& body) const;

  template <bool with_energy>
  Evaluation commit(std::span<const double> displacement, const SharedEnvironment& environment,
                    History& history, std::span<double> gradient, Write how);

  /// Straight into the tangent, whose off-diagonal blocks are those of the bonds.
  void write_tangent(const StateView& at, double projection, Tangent& tangent);

  const BondTerm& term_;
  std::size_t slot_;
  const BlockPattern& pattern_;
  std::vector<Offset> places_;  // of the bonds' blocks in the pattern; empty: in its order
  BondWorkspace workspace_;
};

}  // namespace peristat
