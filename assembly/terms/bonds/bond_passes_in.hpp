#pragma once

#include <algorithm>
#include <span>
#include <stdexcept>
#include <vector>

#include "assembly/terms/bonds/bond_kernels.hpp"
#include "assembly/terms/bonds/bond_passes.hpp"
#include "assembly/terms/bonds/bond_workspace.hpp"
#include "assembly/terms/failure/bond_failure.hpp"
#include "assembly/terms/model.hpp"

namespace peristat {

/// The passes over bonds in a dimension, with their potential.
template <int dimension>
class BondPassesIn : public TermPasses, BlockTangent, RowVisits {
 public:
  BondPassesIn(const BondFailure& failure, const TermSetting& setting);

  Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) override;
  Evaluation commit(std::span<const double> displacement, const SharedEnvironment& environment,
                    History& history, std::span<double> gradient, Write how) override;
  Evaluation commit_forces(std::span<const double> displacement,
                           const SharedEnvironment& environment, History& history,
                           std::span<double> gradient, Write how) override;
  DamageGrowth growth(const StateView& at) override;
  [[nodiscard]] TangentForms forms() override { return {.blocks = this, .visits = this}; }
  void tangent(const StateView& at, Tangent& tangent, double projection, Write how) override;
  void visit_tangent(const StateView& at, double projection, const RowVisitor& visit,
                     std::span<double> diagonal) override;
  void find_diagonal(const StateView& at, double projection, std::span<double> diagonal) override;
  void product(const StateView& at, std::span<const double> v, double projection,
               std::span<double> product, Write how) override;
  [[nodiscard]] bool has_single_products() const override { return workspace_.runs.in_use(); }
  void point_energies(const StateView& at, std::span<double> energies, Write how) override;
  [[nodiscard]] bool shares_energy() const override { return true; }
  void add_virials(const StateView& at, std::span<double> virials) override;

 private:
  using Kernels = BondKernels<dimension>;

  /// Calls body(law, history of the bonds, eigenstretch) with the concrete type of the potential,
  /// and with NoEigenstretch where there is none.
  template <class Body>
  auto dispatch(const StateView& at, const Body& body);

  template <bool with_energy>
  Evaluation commit(std::span<const double> displacement, const SharedEnvironment& environment,
                    History& history, std::span<double> gradient, Write how);

  /// Writes straight into the tangent, whose off-diagonal blocks are those of the bonds.
  void write_tangent(const StateView& at, double projection, Tangent& tangent);

  const BondFailure& failure_;
  std::size_t slot_;
  const BlockPattern& pattern_;
  std::vector<Offset> places_;  // positions of bonds' blocks in the pattern; empty: its order
  BondWorkspace workspace_;
};

template <int dimension>
BondPassesIn<dimension>::BondPassesIn(const BondFailure& failure, const TermSetting& setting)
    : failure_(failure),
      slot_(setting.model.slot_of(failure)),
      pattern_(setting.pattern),
      places_(setting.pattern.places_of(failure.bonds())),
      workspace_(setting.points, failure.bonds(), setting.workspace,
                 setting.model.sums_along_runs() ? &failure.bonds().kind : nullptr) {}

template <int dimension>
template <class Body>
auto BondPassesIn<dimension>::dispatch(const StateView& at, const Body& body) {
  const auto with_law = [&](const auto& law, const double* largest_stretch) {
    const std::span<const double> of_point = at.eigenstretch();
    if (of_point.empty()) return body(law, largest_stretch, NoEigenstretch{});
    return body(law, largest_stretch, Eigenstretch{of_point.data()});
  };
  return std::visit(
      [&]<class P>(const P& potential) {
        if constexpr (PotentialWithHistory<P>) {
          const std::span<const double> history = at.history.of(slot_);
          P law = failure_.at_history(potential, history);
          law.holds_damage = at.damage == Damage::held || failure_.fails_in_avalanches();
          workspace_.runs.follow(failure_.bonds(), law, history.data(), at.history.version());
          return with_law(law, history.data());
        } else {
          return with_law(potential, nullptr);
        }
      },
      failure_.potential());
}

template <int dimension>
Evaluation BondPassesIn<dimension>::gradient(const StateView& at, std::span<double> gradient,
                                             Write how) {
  return dispatch(
      at, [&](const auto& law, const double* largest_stretch, const auto& eigenstretch) {
        return Kernels::template gradient<false>(workspace_, law, eigenstretch, at.displacement,
                                                 largest_stretch, gradient, how);
      });
}

template <int dimension>
Evaluation BondPassesIn<dimension>::commit(std::span<const double> displacement,
                                           const SharedEnvironment& environment, History& history,
                                           std::span<double> gradient, Write how) {
  return commit<true>(displacement, environment, history, gradient, how);
}

template <int dimension>
Evaluation BondPassesIn<dimension>::commit_forces(std::span<const double> displacement,
                                                  const SharedEnvironment& environment,
                                                  History& history, std::span<double> gradient,
                                                  Write how) {
  return commit<false>(displacement, environment, history, gradient, how);
}

template <int dimension>
template <bool with_energy>
Evaluation BondPassesIn<dimension>::commit(std::span<const double> displacement,
                                           const SharedEnvironment& environment, History& history,
                                           std::span<double> gradient, Write how) {
  const StateView at{displacement, history, Damage::grows, environment};
  if (failure_.fails_in_avalanches()) return this->gradient(at, gradient, how);
  const bool can_fail = failure_.can_fail();
  double* const to_change = can_fail ? history.change(slot_).data() : nullptr;
  const Evaluation found = dispatch(
      at, [&]<class P>(const P& law, const double* largest_stretch, const auto& eigenstretch) {
        if constexpr (PotentialWithHistory<P>) {
          return Kernels::template gradient<true, with_energy>(
              workspace_, law, eigenstretch, displacement, to_change, gradient, how);
        } else {
          return Kernels::template gradient<false, with_energy>(
              workspace_, law, eigenstretch, displacement, largest_stretch, gradient, how);
        }
      });
  // A part of a body does not count all of its bonds.
  if (can_fail && (found.growth.degrading > 0 || workspace_.points.owned)) {
    history.note_damage();
    workspace_.runs.have_followed(history.version());
  }
  return found;
}

template <int dimension>
DamageGrowth BondPassesIn<dimension>::growth(const StateView& at) {
  if (!failure_.can_fail() || failure_.fails_in_avalanches()) return {};
  return dispatch(
      at, [&]<class P>(const P& law, const double* largest_stretch, const auto& eigenstretch) {
        if constexpr (PotentialWithHistory<P>) {
          return Kernels::growth(workspace_, law, eigenstretch, at.displacement, largest_stretch);
        } else {
          return DamageGrowth{};
        }
      });
}

template <int dimension>
void BondPassesIn<dimension>::tangent(const StateView& at, Tangent& tangent, double projection,
                                      Write how) {
  if (how == Write::over && places_.empty()) return write_tangent(at, projection, tangent);
  if (how == Write::over) tangent.clear();
  std::vector<double> diagonal(tangent.diagonal.size());
  visit_tangent(
      at, projection,
      [&](int, Index i, std::span<const double> blocks) {
        Offset bond = failure_.bonds().offset[i];
        const std::size_t entries = std::size_t(tangent.dimension * tangent.dimension);
        for (std::size_t k = 0; k < blocks.size(); k += entries, ++bond) {
          tangent.add_to_block(places_.empty() ? bond : places_[std::size_t(bond)],
                               blocks.subspan(k, entries));
        }
      },
      diagonal);
  for (std::size_t k = 0; k < diagonal.size(); ++k) tangent.diagonal[k] += diagonal[k];
}

template <int dimension>
void BondPassesIn<dimension>::visit_tangent(const StateView& at, double projection,
                                            const RowVisitor& visit, std::span<double> diagonal) {
  dispatch(at, [&](const auto& law, const double* largest_stretch, const auto& eigenstretch) {
    visit_rows<dimension>(workspace_, visit, [&](const auto& blocks_of, const auto& done) {
      Kernels::template tangent<Tangent::Blocks::whole>(workspace_, law, eigenstretch,
                                                        at.displacement, largest_stretch,
                                                        projection, blocks_of, done, diagonal);
    });
  });
}

template <int dimension>
void BondPassesIn<dimension>::find_diagonal(const StateView& at, double projection,
                                            std::span<double> diagonal) {
  dispatch(at, [&](const auto& law, const double* largest_stretch, const auto& eigenstretch) {
    Kernels::diagonal(workspace_, law, eigenstretch, at.displacement, largest_stretch, projection,
                      diagonal);
  });
}

template <int dimension>
void BondPassesIn<dimension>::product(const StateView& at, std::span<const double> v,
                                      double projection, std::span<double> product, Write how) {
  dispatch(at, [&](const auto& law, const double* largest_stretch, const auto& eigenstretch) {
    Kernels::product(workspace_, law, eigenstretch, at.displacement, largest_stretch, v, projection,
                     at.precision, product, how);
  });
}

template <int dimension>
void BondPassesIn<dimension>::point_energies(const StateView& at, std::span<double> energies,
                                             Write how) {
  dispatch(at, [&](const auto& law, const double* largest_stretch, const auto& eigenstretch) {
    Kernels::point_energies(workspace_, law, eigenstretch, at.displacement, largest_stretch,
                            energies, how);
  });
}

template <int dimension>
void BondPassesIn<dimension>::add_virials(const StateView& at, std::span<double> virials) {
  dispatch(at, [&](const auto& law, const double* largest_stretch, const auto& eigenstretch) {
    Kernels::add_virials(workspace_, law, eigenstretch, at.displacement, largest_stretch, virials);
  });
}

template <int dimension>
void BondPassesIn<dimension>::write_tangent(const StateView& at, double projection,
                                            Tangent& tangent) {
  dispatch(at, [&](const auto& law, const double* largest_stretch, const auto& eigenstretch) {
    const auto blocks_of = [&](int, Index i) {
      return &tangent.off_diagonal[std::size_t(pattern_.offset[i]) * tangent.block_size()];
    };
    const auto done = [](int, Index) {};
    if (tangent.blocks == Tangent::Blocks::whole) {
      Kernels::template tangent<Tangent::Blocks::whole>(
          workspace_, law, eigenstretch, at.displacement, largest_stretch, projection, blocks_of,
          done, tangent.diagonal);
    } else {
      Kernels::template tangent<Tangent::Blocks::upper_halves>(
          workspace_, law, eigenstretch, at.displacement, largest_stretch, projection, blocks_of,
          done, tangent.diagonal);
    }
  });
}

template <int dimension>
std::unique_ptr<TermPasses> make_bond_passes_in(const BondFailure& failure,
                                                const TermSetting& setting) {
  return std::make_unique<BondPassesIn<dimension>>(failure, setting);
}

}  // namespace peristat
