#include "assembly/terms/states/state_term.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "assembly/energy/kept_state.hpp"
#include "assembly/terms/bonds/bond_look.hpp"
#include "assembly/terms/bonds/bond_passes.hpp"
#include "assembly/terms/failure/shared_bonds.hpp"
#include "assembly/terms/model.hpp"
#include "assembly/terms/states/state_kernels.hpp"
#include "assembly/terms/workspace.hpp"
#include "src/geometry/counts_bond.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// Bonds up to which the blocks of a tangent are counted; of more bonds they are at most so many
/// times as many, since twice the horizon reaches 2^d times the volume.
constexpr double most_bonds_to_count = 1e6;

template <int D, class Measure>
class StatePasses : public TermPasses, BlockTangent, RowVisits {
 public:
  StatePasses(const StateTerm& term, const TermSetting& setting)
      : term_(term),
        failure_(term.bond_failure()),
        slot_(setting.model.slot_of(term)),
        stretches_(make_bond_passes(term.bond_failure(), setting)),
        points_(setting.points),
        index_map_(setting.index_map),
        pattern_(setting.pattern),
        threads_(setting.workspace.threads()),
        parts_(setting.workspace.parts()),
        kernels_(setting.points, term.bonds(), term.shares(), setting.workspace,
                 setting.model.sums_along_runs()) {}

  Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) override {
    const Evaluation found = find_states(at);
    if (!gradient.empty()) {
      with_eigenstretch(at,
                        [&](const auto& relief) { kernels_.write_forces(relief, gradient, how); });
    }
    return found;
  }

  Evaluation commit(std::span<const double> displacement, const SharedEnvironment& environment,
                    History& history, std::span<double> gradient, Write how) override {
    const StateView now{displacement, history, Damage::grows, environment};
    // On all ranks: a bond that is damaged here may be counted by another rank.
    if (!failure_.can_fail() || failure_.fails_in_avalanches() ||
        !any_of_all(index_map_.ranks(), growth(now).degrading > 0)) {
      return this->gradient(now, gradient, how);
    }
    const History before = history;
    static_cast<void>(this->gradient({displacement, before, Damage::grows, environment}, {}, how));
    const auto remembered = kernels_.remembered();
    const DamageGrowth committed =
        stretches_->commit_forces(displacement, environment, history, {}, Write::over).growth;
    Evaluation found =
        this->gradient({displacement, history, Damage::grows, environment}, gradient, how);
    found.growth = committed;
    found.moves_equilibrium = true;
    // Where a bond was stretched against the dilatation the energy may rise as it breaks. That is
    // no dissipation; the energy has to be supplied from elsewhere.
    const double mine = dissipated_of(displacement, remembered, before);
    const double dissipated = index_map_.ranks().sum(mine) < 0.0 ? 0.0 : mine;  // keeps NaN
    found.released = dissipated - (dissipated_by_law(history) - dissipated_by_law(before));
    return found;
  }

  DamageGrowth growth(const StateView& at) override {
    if (!failure_.can_fail()) return {};
    if (!failure_.fails_in_avalanches()) return stretches_->growth(at);
    return visit_driven(at, [](int, const DrivenBond&) {});
  }

  std::optional<DamageGrowth> release(const StateView& at, History& history) override {
    const auto now = [&] {
      return StateView{at.displacement, history, Damage::grows, at.environment};
    };
    const auto find = [&](const auto& visit) { visit_driven(now(), visit); };
    if (index_map_.is_whole()) {
      return damage_one_by_one(parts_, find, [&](const DrivenBond& one, DamageGrowth& growth) {
        const Loss loss = decide(one, history.of(slot_), growth);
        if (!(loss[0] > 0.0)) return;
        kernels_.lose(one, loss);
        history.change(slot_)[std::size_t(one.bond)] = loss[0];
        if (one.twin >= 0) history.change(slot_)[std::size_t(one.twin)] = loss[0];
      });
    }
    DamageGrowth growth;
    damage_on_ranks(
        index_map_, term_.bonds(), LossReaches::bonds_of_points, parts_, find,
        [&](const DrivenBond& one) { return decide(one, history.of(slot_), growth); },
        [&](const auto& ends, const auto& bond, const Loss& loss) {
          for (const auto& end : ends) {
            if (end) kernels_.lose_at(*end, loss);
          }
          if (bond) history.change(slot_)[std::size_t(*bond)] = loss[0];
        });
    return growth;
  }

  void add_drive(const StateView& at, const StateLine& line, std::span<BondDrive> drives) override {
    if (term_.extension() == Extension::linear) take_stretches(at, line, drives);
    take_integrities(at);
    found_ = {};  // whose integrities the kernels had
    const std::span<const double> history = at.history.of(slot_);
    failure_.with_damage_law(
        history, [&](const auto& law) { kernels_.add_drive(law, history.data(), drives); });
  }

  [[nodiscard]] TangentForms forms() override { return {.blocks = this, .visits = this}; }

  void tangent(const StateView& at, Tangent& tangent, double projection, Write how) override {
    if (tangent.blocks != Tangent::Blocks::whole) {
      throw std::logic_error("the blocks of states are not symmetric");
    }
    if (how == Write::over) tangent.clear();
    find_states(at);
    with_eigenstretch(at, [&](const auto& relief) {
      kernels_.add_tangent(at.displacement, relief, projection, term_.network(), pattern_,
                           tangent.off_diagonal, tangent.diagonal);
    });
  }

  /// Rows of the bonds alone, whose positive semidefinite part is taken whatever the projection:
  /// no definiteness of the tangent could be read off them.
  void visit_tangent(const StateView& at, double /*projection*/, const RowVisitor& visit,
                     std::span<double> diagonal) override {
    if (!are_found(at)) find_states(at);
    with_eigenstretch(at, [&](const auto& relief) {
      kernels_.visit_bonds(at.displacement, relief, visit, diagonal);
    });
  }
  [[nodiscard]] double most_over_visited() const override {
    return state_ratios(term_.shares().constants, D).most;
  }

  void product(const StateView& at, std::span<const double> v, double projection,
               std::span<double> product, Write how) override {
    if (!are_found(at)) find_states(at);
    with_eigenstretch(at, [&](const auto& relief) {
      kernels_.write_product(at.displacement, relief, v, projection, product, how);
    });
  }

  void point_energies(const StateView& at, std::span<double> energies, Write how) override {
    if (!are_found(at)) find_states(at);
    const std::span<const double> found = kernels_.energies();
    for (std::size_t i = 0; i < found.size(); ++i) {
      energies[i] = how == Write::over ? found[i] : energies[i] + found[i];
    }
  }

  void add_virials(const StateView& at, std::span<double> virials) override {
    find_states(at);
    with_eigenstretch(
        at, [&](const auto& relief) { kernels_.add_virials(at.displacement, relief, virials); });
  }

 private:
  /// Calls visit with the eigenstretch of the points, if there is one.
  template <class Visit>
  static void with_eigenstretch(const StateView& at, const Visit& visit) {
    const std::span<const double> of_point = at.eigenstretch();
    if (of_point.empty()) {
      visit(NoEigenstretch{});
    } else {
      visit(Eigenstretch{of_point.data()});
    }
  }

  Evaluation find_states(const StateView& at) {
    take_integrities(at);
    Evaluation found;
    with_eigenstretch(
        at, [&](const auto& relief) { found = kernels_.find_states(at.displacement, relief); });
    found_.keep(at);
    return found;
  }

  template <class Visit>
  DamageGrowth visit_driven(const StateView& at, const Visit& visit) {
    if (!are_found(at)) find_states(at);
    DamageGrowth found;
    const std::span<const double> history = at.history.of(slot_);
    failure_.with_damage_law(history, [&](const auto& law) {
      with_eigenstretch(at, [&](const auto& relief) {
        found = kernels_.growth_by_release(at.displacement, law, relief, history.data(), visit);
      });
    });
    return found;
  }

  using Loss = typename StateKernels<D, Measure>::Loss;

  /// What a bond loses, if what the ones before it have left still drives it; counts it.
  Loss decide(const DrivenBond& one, std::span<const double> stretches, DamageGrowth& growth) {
    Loss loss{};
    failure_.with_damage_law(stretches, [&](const auto& law) {
      const auto& of_bond = law.of_bond(one.bond);
      loss = kernels_.loss_by_release(one, of_bond, stretches[std::size_t(one.bond)]);
      if (!(loss[0] > 0.0)) return;
      growth.degrading += one.bonds();
      growth.breaking += of_bond.is_broken(loss[0]) ? one.bonds() : 0;
    });
    return loss;
  }

  /// True if the kernels have the states of `at`: solvers multiply many times at one state.
  [[nodiscard]] bool are_found(const StateView& at) const {
    const StateView last = found_.view();
    return last.history.of(slot_).data() == at.history.of(slot_).data() &&
           last.environment == at.environment &&
           std::ranges::equal(last.displacement, at.displacement);
  }

  void take_integrities(const StateView& at) {
    if (!failure_.can_fail()) return;
    const std::span<const double> stretch = at.history.of(slot_);
    if (stretch.data() == found_.view().history.of(slot_).data()) return;
    failure_.with_damage_law(stretch, [&](const auto& law) {
      kernels_.scale([&](Offset bond) {
        return law.of_bond(bond).integrity_after(stretch[std::size_t(bond)]);
      });
    });
  }

  /// Takes the stretches of the term's own measure.
  void take_stretches(const StateView& at, const StateLine& line, std::span<BondDrive> drives) {
    const Bonds& bonds = term_.bonds();
    const BondLook<D, Measure> look(points_, bonds, at);
#pragma omp parallel for num_threads(threads_)
    for (Index i = 0; i < bonds.points(); ++i) {
      for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
        const auto [value, rate] = look.along(i, bond, line);
        drives[std::size_t(bond)] = BondDrive::by_stretch(value, rate);
      }
    }
  }

  /// Energy dissipated by the bonds that are counted here. Bonds that have overshot the stretch
  /// that they bear broke when they passed it, and held less energy then, by the square of the
  /// ratio; the rest is overshoot, not dissipation.
  [[nodiscard]] double dissipated_of(std::span<const double> displacement,
                                     const typename StateKernels<D, Measure>::Before& remembered,
                                     const History& before) const {
    const std::span<const double> history = before.of(slot_);
    double sum = 0.0;
    failure_.with_damage_law(history, [&](const auto& law) {
      sum = kernels_.losses(displacement, remembered, [&](Index i, Offset bond, double stretch) {
        if (!counts_bond(points_, i, term_.bonds().partner(i, bond))) return 0.0;
        const double ratio = law.of_bond(bond).borne(history[std::size_t(bond)]) / stretch;
        return std::min(ratio * ratio, 1.0);
      });
    });
    return sum;
  }

  [[nodiscard]] double dissipated_by_law(const History& history) const {
    return failure_.dissipated_energy(history.of(slot_), &points_);
  }

  const StateTerm& term_;
  const BondFailure& failure_;
  std::size_t slot_;
  std::unique_ptr<TermPasses> stretches_;  // damage of its bonds; their forces are unused
  const Points& points_;
  const IndexMap& index_map_;
  const BlockPattern& pattern_;
  int threads_, parts_;
  StateKernels<D, Measure> kernels_;
  KeptState found_;  // whose states and integrities the kernels have
};

template <int D>
std::unique_ptr<TermPasses> passes_in(const StateTerm& term, const TermSetting& setting) {
  if (term.extension() == Extension::linear) {
    return std::make_unique<StatePasses<D, LinearLength>>(term, setting);
  }
  return std::make_unique<StatePasses<D, Length>>(term, setting);
}

}  // namespace

StateTerm::StateTerm(std::shared_ptr<const Bonds> bonds, BondPotential potential,
                     std::vector<char> never_fails, StateShares shares, StateRules rules,
                     int threads)
    : extension_(rules.extension),
      failure_(std::make_shared<BondFailure>(std::move(bonds), std::move(potential),
                                             std::move(never_fails), rules.drive,
                                             std::move(rules.onsets))),
      shares_(std::move(shares)),
      reaches_twice_(std::ranges::any_of(shares_.constants,
                                         [](const LamePair& of) { return of.lambda != of.mu; })),
      threads_(threads) {
  const auto points = std::size_t(this->bonds().points());
  if (shares_.whole.size() != std::size_t(this->bonds().count()) ||
      shares_.moment.size() != points || shares_.constants.size() != points) {
    throw std::logic_error("states have a share of every bond and a moment of every point");
  }
}

StateRatios state_ratios(std::span<const LamePair> constants, int dimension) {
  const double d = dimension;
  StateRatios of;
  for (const auto& [lambda, mu] : constants) {
    const double ratio = (d * lambda + 2.0 * mu) / ((d + 2.0) * mu);
    of.most = std::max(of.most, ratio);
    of.least = std::min(of.least, ratio);
  }
  return of;
}

const StateNetwork& StateTerm::network() const {
  std::call_once(finds_network_, [&] { network_.emplace(bonds(), reaches_twice_, threads_); });
  return *network_;
}

BlockCount StateTerm::block_count(int dimension) const {
  const double bonds = double(this->bonds().count()), points = double(this->bonds().points());
  BlockCount count{bonds, 0.0};
  if (reaches_twice_) {
    const bool is_quick = bonds < most_bonds_to_count;
    count.blocks = is_quick ? double(network().partner.size())
                            : std::min(std::ldexp(bonds, dimension), 0.5 * points * points);
  }
  // Their partners; per bond its lower point with its number, and, while the tangent is written,
  // its direction and block; per point and thread a block's place.
  const double d = dimension;
  count.bytes_beside = sizeof(Index) * count.blocks +
                       (sizeof(Index) + sizeof(Offset) + sizeof(double) * d * (d + 1.0)) * bonds +
                       sizeof(Offset) * (2.0 + threads_) * points;
  return count;
}

double StateTerm::stored_bytes() const {
  const double bonds = double(shares_.whole.size()), points = double(shares_.moment.size());
  // Per bond its share, and its integrity in the passes; per point moment, constants and results.
  return failure_->bytes() +
         (double(shares_.whole.bytes_per_bond()) + (failure_->can_fail() ? 8.0 : 0.0)) * bonds +
         8.0 * 10.0 * points;
}

std::unique_ptr<TermPasses> StateTerm::passes(const TermSetting& setting) const {
  switch (setting.points.dimension) {
    case 2:
      return passes_in<2>(*this, setting);
    case 3:
      return passes_in<3>(*this, setting);
    default:
      throw std::logic_error("states are of dimension 2 or 3");
  }
}

}  // namespace peristat
