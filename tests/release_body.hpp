#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "assembly/terms/states/state_term.hpp"
#include "src/materials/lame_constants.hpp"
#include "src/potentials/potential.hpp"
#include "tests/problems.hpp"

namespace peristat::tests {

/// A box of states whose bonds take kappa r^2 (q_i + q_j) times the work of the law.
struct ReleaseBody {
  Points points;
  std::shared_ptr<StateTerm> term;
  Model model, bond_model;

  ReleaseBody(const BoxSetting& box, double poisson_ratio, const BondPotential& potential)
      : ReleaseBody(
            box, poisson_ratio, [&](const Bonds&) { return potential; }, nullptr) {}

  /// Bonds of one law whose onsets follow from strengths.
  ReleaseBody(const BoxSetting& box, double poisson_ratio, const AnyBondLaw& law,
              std::shared_ptr<const StrengthOnsets> onsets)
      : ReleaseBody(
            box, poisson_ratio,
            [&](const Bonds& bonds) -> BondPotential {
              auto laws = std::make_shared<BondLaws>(std::vector<AnyBondLaw>{law},
                                                     std::size_t(bonds.count()));
              for (Offset bond = 0; bond < bonds.count(); ++bond) {
                laws->set(bond, 0, law.onset(), law.critical());
              }
              return DegradedByBond<>{1.0, std::move(laws)};
            },
            onsets) {}

 private:
  ReleaseBody(const BoxSetting& box, double poisson_ratio,
              const std::function<BondPotential(const Bonds&)>& potential_of,
              std::shared_ptr<const StrengthOnsets> onsets)
      : points(points_with_ends(box)) {
    BondSetting setting = bond_setting(box);
    setting.influence = [](double) { return 1.0; };  // K = 1 / r
    Bonds bonds = make_bonds(points, SurfaceCorrection::none, setting, 1);
    const LamePair constants =
        lame_constants(2.0, poisson_ratio, box.dimension, PlaneState::stress);
    StateShares shares;
    shares.whole = bonds.kind;
    shares.moment = moments_of(points, bonds);
    shares.constants.assign(points.volume.size(), constants);
    const int d = box.dimension;
    const auto q = [&](Index point) {
      const auto i = std::size_t(point);
      return points.volume[i] * d * (d + 2) * constants.mu / shares.moment[i];
    };
    bonds.set_weights([&](Index i, Offset bond) {
      return shares.whole[bond].weight * (q(i) + q(bonds.partner(i, bond)));
    });
    const BondPotential potential = potential_of(bonds);
    bond_model =
        Model(bonds, potential, {}, onsets ? DamageDrive::release : DamageDrive::stretch, onsets);
    term = std::make_shared<StateTerm>(
        std::make_shared<const Bonds>(std::move(bonds)), potential, std::vector<char>(),
        std::move(shares), StateRules{Extension::finite, DamageDrive::release, onsets}, 1);
    model = Model(std::shared_ptr<Term>(term));
  }

 public:
  [[nodiscard]] std::size_t dofs() const { return points.reference.size(); }

  /// Moves the points beyond x apart.
  [[nodiscard]] std::vector<double> torn(double x, double opening) const {
    const auto d = std::size_t(points.dimension);
    std::vector<double> u(dofs(), 0.0);
    for (Index i = 0; i < points.count(); ++i) {
      if (points.position(i)[0] >= x) u[std::size_t(i) * d] = opening;
    }
    return u;
  }

  /// sum over the bonds across x of what they take in all.
  [[nodiscard]] double taken_across(double x, double work_of_law) const {
    double sum = 0.0;
    for_each_bond(model.bonds(), [&](Index i, Index j, Offset bond) {
      if ((points.position(i)[0] < x) == (points.position(j)[0] < x)) return;
      sum += model.bonds().weight(bond) * model.bonds().length(bond) * work_of_law;
    });
    return sum;
  }
};

}  // namespace peristat::tests
