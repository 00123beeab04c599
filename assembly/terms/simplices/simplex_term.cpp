#include "assembly/terms/simplices/simplex_term.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "assembly/terms/bonds/bond_look.hpp"
#include "assembly/terms/failure/one_by_one.hpp"
#include "assembly/terms/failure/shared_bonds.hpp"
#include "assembly/terms/model.hpp"
#include "assembly/terms/simplices/bond_simplices.hpp"
#include "assembly/terms/simplices/simplex_kernels.hpp"
#include "src/core/vector_verbs.hpp"
#include "src/geometry/counts_bond.hpp"

namespace peristat {
namespace {

void clear(std::span<double> result) { std::fill(result.begin(), result.end(), 0.0); }

template <int D>
class SimplexPasses : public TermPasses, BlockTangent {
 public:
  SimplexPasses(const SimplexTerm& term, const TermSetting& setting)
      : term_(term),
        failure_(term.bond_failure()),
        setting_(setting),
        slot_(setting.model.slot_of(term)),
        slot_of_bonds_(failure_.fails_by_release() ? setting.model.slot_of(failure_) : 0),
        workspace_(term, setting) {}

  Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) override {
    if (how == Write::over) clear(gradient);
    return Kernels::gradient(workspace_, at.displacement, influences_at(at), gradient);
  }

  Evaluation commit(std::span<const double> displacement, const SharedEnvironment& environment,
                    History& history, std::span<double> gradient, Write how) override {
    if (failure_.fails_in_avalanches()) {
      return this->gradient({displacement, history, Damage::grows, environment}, gradient, how);
    }
    const History before = history;
    term_.follow(setting_.model, history);
    const auto after = [&](const History& past) {
      return StateView{displacement, past, Damage::grows, environment};
    };
    Evaluation found = this->gradient(after(history), gradient, how);
    found.moves_equilibrium = !std::ranges::equal(before.of(slot_), history.of(slot_));
    if (found.moves_equilibrium) {
      const double left = setting_.points.owned ? owned_energy(after(history)) : found.energy;
      const double energy = setting_.points.owned ? owned_energy(after(before))
                                                  : this->gradient(after(before), {}, how).energy;
      // No integrity rises in a commit, but for the last digit of an exponential.
      found.released = std::max(energy - left, 0.0);
    }
    return found;
  }

  DamageGrowth growth(const StateView& at) override {
    if (!failure_.fails_by_release()) return {};
    return visit_driven(at, influences_at(at), [](int, const DrivenBond&) {});
  }

  std::optional<DamageGrowth> release(const StateView& at, History& history) override {
    if (!failure_.fails_by_release()) return std::nullopt;
    std::vector<double> left = integrities(at.history);
    DamageGrowth growth;
    bool is_changed = false;
    const auto find = [&](const auto& visit) { visit_driven(at, influences_of(left, at), visit); };
    const auto decide = [&](const DrivenBond& one, DamageGrowth& counted) {
      return decide_on(one, at, influences_of(left, at), counted);
    };
    const auto take = [&](Offset bond, const Loss& loss) {
      is_changed = true;
      const std::span<double> stretches = history.change(slot_of_bonds_);
      failure_.with_damage_law(stretches, [&](const auto& law) {
        term_.alike().for_each(bond, [&](Offset one) {
          stretches[std::size_t(one)] = loss[0];
          leave(law.of_bond(one).integrity_after(loss[0]), one, left);
        });
      });
    };
    const int parts = workspace_.threads.parts();
    if (setting_.index_map.is_whole()) {
      growth = damage_one_by_one(parts, find, [&](const DrivenBond& one, DamageGrowth& counted) {
        const Loss loss = decide(one, counted);
        if (loss[0] > 0.0) take(one.bond, loss);
      });
    } else {
      // Bonds of a tetrahedron need not share a point.
      damage_on_ranks(
          setting_.index_map, term_.bonds(),
          term_.tetrahedra() ? LossReaches::any_bond : LossReaches::bonds_of_points, parts, find,
          [&](const DrivenBond& one) { return decide(one, growth); },
          [&](const auto&, const auto& bond, const Loss& loss) {
            if (bond) take(*bond, loss);
          });
    }
    if (is_changed) history.replace(slot_, std::move(left));
    return growth;
  }

  /// Slope and curvature along the line by central differences: they only predict where a bond
  /// reaches what it bears.
  void add_drive(const StateView& at, const StateLine& line, std::span<BondDrive> drives) override {
    const std::span<const double> rate = line.rate;
    const Influences influences = influences_at(at);
    find_releases(at.displacement, influences, releases_);
    std::vector<double> ahead = releases_, behind = releases_;
    const double fastest = std::transform_reduce(
        rate.begin(), rate.end(), 0.0, [](double a, double b) { return std::max(a, b); },
        [](double component) { return std::abs(component); });
    const double step =
        fastest > 0.0 ? difference_step * double(setting_.points.spacing) / fastest : 1.0;
    if (fastest > 0.0) {
      find_releases(moved(at.displacement, step, rate), influences, ahead);
      find_releases(moved(at.displacement, -step, rate), influences, behind);
    }
    const Bonds& bonds = term_.bonds();
    failure_.with_damage_law(at.history.of(slot_of_bonds_), [&](const auto& law) {
      for (Offset bond = 0; bond < bonds.count(); ++bond) {
        const auto b = std::size_t(bond);
        if (bonds.weight(bond) == 0.0) continue;
        const double per_energy = 2.0 / stiffness_of(law.of_bond(bond), bond);
        std::array<double, 3>& squared = drives[b].squared;
        squared[0] += per_energy * releases_[b];
        squared[1] += per_energy * (ahead[b] - behind[b]) / (2.0 * step);
        squared[2] +=
            per_energy * (ahead[b] - 2.0 * releases_[b] + behind[b]) / (2.0 * step * step);
      }
    });
  }

  [[nodiscard]] TangentForms forms() override { return {.blocks = this}; }

  void tangent(const StateView& at, Tangent& tangent, double projection, Write how) override {
    if (tangent.blocks != Tangent::Blocks::whole) {
      throw std::logic_error("the blocks of triangles and tetrahedra are not symmetric");
    }
    if (how == Write::over) tangent.clear();
    Kernels::tangent(workspace_, at.displacement, influences_at(at), projection, tangent);
  }

  void product(const StateView& at, std::span<const double> v, double projection,
               std::span<double> product, Write how) override {
    if (projection != 0.0) {
      throw std::logic_error("triangles and tetrahedra have no projected product");
    }
    if (how == Write::over) clear(product);
    Kernels::product(workspace_, at.displacement, influences_at(at), v, product);
  }

  void point_energies(const StateView& at, std::span<double> energies, Write how) override {
    if (how == Write::over) clear(energies);
    Kernels::point_energies(workspace_, at.displacement, influences_at(at), energies);
  }

  void add_virials(const StateView& at, std::span<double> virials) override {
    Kernels::add_virials(workspace_, at.displacement, influences_at(at), virials);
  }

 private:
  using Kernels = SimplexKernels<D>;

  /// Largest displacement of a difference along a line, over the spacing: its square is far above
  /// round-off and far below 1.
  static constexpr double difference_step = 1e-4;

  [[nodiscard]] Influences influences_at(const StateView& at) const {
    return influences_of(at.history.of(slot_), at);
  }
  /// @param integrity of bonds and points; empty: the history's
  [[nodiscard]] Influences influences_of(std::span<const double> integrity,
                                         const StateView& at) const {
    if (integrity.empty()) integrity = at.history.of(slot_);
    if (integrity.empty()) return {{}, {}, at.eigenstretch()};
    const auto bonds = std::size_t(term_.bonds().count());
    return {integrity.first(bonds), integrity.subspan(bonds), at.eigenstretch()};
  }

  [[nodiscard]] std::vector<double> integrities(const History& history) const {
    const std::span<const double> known = history.of(slot_);
    if (!known.empty()) return {known.begin(), known.end()};
    const Bonds& bonds = term_.bonds();
    return std::vector<double>(std::size_t(bonds.count()) + std::size_t(bonds.points()), 1.0);
  }

  /// The history that a bond gets; 0: what the ones before it have left does not drive it.
  using Loss = std::array<double, 1>;

  /// What a bond loses; counts it.
  Loss decide_on(const DrivenBond& one, const StateView& at, const Influences& influences,
                 DamageGrowth& growth) {
    double release = 0.0;
    term_.alike().for_each(one.bond, [&](Offset bond) {
      const auto [i, j] = ends_of(bond);
      release += simplices_of_bond().release(i, j, at.displacement, influences);
    });
    Loss loss{};
    const std::span<const double> history = at.history.of(slot_of_bonds_);
    failure_.with_damage_law(history, [&](const auto& law) {
      const auto& of_bond = law.of_bond(one.bond);
      double stretch = history[std::size_t(one.bond)];
      const double driving = equivalent_stretch(of_bond, one.bond, one.stretch, release);
      if (!damage_driven(of_bond, driving, stretch)) return;
      loss = {stretch};
      growth.degrading += one.bonds();
      growth.breaking += of_bond.is_broken(stretch) ? one.bonds() : 0;
    });
    return loss;
  }

  /// Points of a bond.
  [[nodiscard]] BondEnds ends_of(Offset bond) const {
    const std::vector<Offset>& offset = term_.bonds().offset;
    const auto above = std::upper_bound(offset.begin(), offset.end(), bond);
    const Index lower = Index(above - offset.begin()) - 1;
    return {lower, term_.bonds().partner(lower, bond)};
  }

  /// Leaves this integrity to a bond, in those of bonds and points.
  void leave(double integrity, Offset bond, std::vector<double>& left) const {
    left[std::size_t(bond)] = integrity;
    for (const Index point : ends_of(bond)) {
      double& least = left[std::size_t(term_.bonds().count()) + std::size_t(point)];
      least = std::min(least, integrity);
    }
  }

  /// What bonds would set free by their triangles and tetrahedra, with the bonds that are one.
  void find_releases(std::span<const double> displacement, const Influences& influences,
                     std::vector<double>& of_bond) {
    Kernels::releases(workspace_, displacement, influences, of_bond);
    if (term_.alike().none()) return;
    const auto count = Offset(of_bond.size());
    for (Offset bond = 0; bond < count; ++bond) {
      const Offset first = term_.alike().first(bond);
      if (first < bond) of_bond[std::size_t(first)] += of_bond[std::size_t(bond)];
    }
    for (Offset bond = 0; bond < count; ++bond) {
      of_bond[std::size_t(bond)] = of_bond[std::size_t(term_.alike().first(bond))];
    }
  }

  BondSimplices<D>& simplices_of_bond() {
    if (!simplices_of_bond_) simplices_of_bond_.emplace(term_, setting_.points);
    return *simplices_of_bond_;
  }

  /// s_eq of a bond of stretch s whose triangles and tetrahedra would set so much free [J].
  template <class OfBond>
  [[nodiscard]] double equivalent_stretch(const OfBond& of_bond, Offset bond, double stretch,
                                          double release) const {
    if (!(stretch > 0.0)) return 0.0;
    const double per_energy = 2.0 / stiffness_of(of_bond, bond);
    return std::sqrt(std::max(stretch * stretch + per_energy * release, 0.0));
  }

  /// w L C1 of a bond, with the bonds that are one.
  template <class OfBond>
  [[nodiscard]] double stiffness_of(const OfBond& of_bond, Offset bond) const {
    static_assert(std::is_same_v<decltype(OfBond::shape), Harmonic>);
    double weight = 0.0;
    term_.alike().for_each(bond, [&](Offset one) { weight += term_.bonds().weight(one); });
    return weight * term_.bonds().length(bond) * of_bond.modulus;
  }

  [[nodiscard]] static std::vector<double> moved(std::span<const double> displacement, double step,
                                                 std::span<const double> rate) {
    std::vector<double> there(displacement.begin(), displacement.end());
    add_scaled(there, step, rate);
    return there;
  }

  /// The other half of a bond with an image; -1: it has none.
  [[nodiscard]] Offset other_half(Offset bond) const {
    Offset other = -1;
    term_.alike().for_each(bond, [&](Offset one) {
      if (one != bond && term_.bonds().weight(one) != 0.0) other = one;
    });
    return other;
  }

  /// Damage that committing the state would do by release.
  /// @param visit(part, DrivenBond) called for each bond whose damage would grow
  template <class Visit>
  DamageGrowth visit_driven(const StateView& at, const Influences& influences, const Visit& visit) {
    find_releases(at.displacement, influences, releases_);
    const Bonds& bonds = term_.bonds();
    const BondLook<D> look(setting_.points, bonds, at);
    const std::span<const double> history = at.history.of(slot_of_bonds_);
    std::vector<Evaluation> found(workspace_.threads.ranges.size());
    failure_.with_damage_law(history, [&](const auto& law) {
      run_on_parts(workspace_.threads.threads(), workspace_.threads.parts(), [&](int part) {
        const RowRange range = workspace_.threads.ranges[std::size_t(part)];
        DamageGrowth growth;
        for (Index i = range.first; i < range.last; ++i) {
          for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
            if (bonds.weight(bond) == 0.0 || term_.alike().first(bond) < bond) continue;
            if (!counts_bond(setting_.points, i, bonds.partner(i, bond))) continue;
            const auto& of_bond = law.of_bond(bond);
            const double s = look.stretch(i, bond);
            const double driving =
                equivalent_stretch(of_bond, bond, s, releases_[std::size_t(bond)]);
            judge_driven(of_bond, {0.0, i, bond, s, other_half(bond)}, driving,
                         history[std::size_t(bond)], growth,
                         [&](const DrivenBond& one) { visit(part, one); });
          }
        }
        found[std::size_t(part)].growth = growth;
      });
    });
    Evaluation all;
    for (const Evaluation& of_part : found) all += of_part;
    return all.growth;
  }

  /// Energy of the owned points of a part: summed over the ranks it counts each interaction once.
  double owned_energy(const StateView& at) {
    std::vector<double> energies(setting_.points.volume.size());
    point_energies(at, energies, Write::over);
    double energy = 0.0;
    for (Index i = 0; i < setting_.points.count(); ++i) {
      if (setting_.points.owns(i)) energy += energies[std::size_t(i)];
    }
    return energy;
  }

  const SimplexTerm& term_;
  const BondFailure& failure_;
  const TermSetting setting_;
  std::size_t slot_, slot_of_bonds_;
  SimplexWorkspace<D> workspace_;
  std::vector<double> releases_;                         // of bonds, by release
  std::optional<BondSimplices<D>> simplices_of_bond_{};  // from the first driven bond on
};

/// True if some of them may store negative energy.
template <class Kind>
bool is_negative(const std::optional<Kind>& kind) {
  if (!kind) return false;
  const bool is_reversed =
      std::visit([](const auto& law) { return law.modulus < 0.0; }, kind->potential);
  return is_reversed || kind->interactions.has_negative_factors();
}

/// Names and counts of one kind of simplices.
template <class Measure>
InteractionCount count_of(const Simplices<Measure>& kind) {
  constexpr bool is_triangle = Measure::arms == 2;
  const auto& interactions = kind.interactions;
  if constexpr (is_triangle) {
    return {"triangles",
            interactions.count(),
            "neighbour_pairs",
            "contributing ordered pairs of neighbours, #N2",
            interactions.per_point(),
            2};
  } else {
    return {"tetrahedra",
            interactions.count(),
            "neighbour_triplets",
            "contributing ordered triplets of neighbours, #N3",
            interactions.per_point(),
            6};
  }
}

}  // namespace

SimplexTerm::SimplexTerm(std::shared_ptr<const BondFailure> bonds,
                         std::optional<Simplices<Area>> triangles,
                         std::optional<Simplices<Volume>> tetrahedra, PointNumbers numbers,
                         AlikeBonds alike)
    : bonds_(std::move(bonds)),
      triangles_(std::move(triangles)),
      tetrahedra_(std::move(tetrahedra)),
      numbers_(std::move(numbers)),
      alike_(std::move(alike)) {
  if (bonds_->can_fail() && !bonds_->fails_in_avalanches() &&
      (is_negative(triangles_) || is_negative(tetrahedra_))) {
    throw std::logic_error("what is lost with a bond must not hold negative energy");
  }
}

Balances SimplexTerm::balances() const {
  Balances balances;
  // No loss by release creates energy, so that it stays positive where it is at rest.
  balances.positive_energy =
      bonds_->fails_by_release() || (!is_negative(triangles_) && !is_negative(tetrahedra_));
  return balances;
}

/// Gives bonds between images, which have no weight, the history of the bond that they show.
void SimplexTerm::show(std::size_t slot_of_bonds, History& history) const {
  if (alike_.none()) return;
  for (Offset bond = 0; bond < bonds().count(); ++bond) {
    const auto here = std::size_t(bond), first = std::size_t(alike_.first(bond));
    const std::span<const double> stretches = history.of(slot_of_bonds);
    if (bonds().weight(bond) != 0.0 || stretches[here] == stretches[first]) continue;
    history.change(slot_of_bonds)[here] = stretches[first];
  }
}

/// Takes the integrity of bonds and points from the histories of the bonds.
void SimplexTerm::follow(const Model& model, History& history) const {
  const auto count = std::size_t(bonds().count());
  if (!bonds_->can_fail()) return;
  show(model.slot_of(*bonds_), history);
  const std::span<const double> largest_stretch = history.of(model.slot_of(*bonds_));
  bonds_->with_damage_law(largest_stretch, [&](const auto& law) {
    std::vector<double> integrity(count + std::size_t(bonds().points()), 1.0);
    double* const of_point = integrity.data() + count;
    for (Index i = 0; i < bonds().points(); ++i) {
      for (Offset bond = bonds().offset[i]; bond < bonds().offset[i + 1]; ++bond) {
        integrity[bond] = law.of_bond(bond).integrity_after(largest_stretch[bond]);
        for (const Index point : {i, bonds().partner(i, bond)}) {
          of_point[point] = std::min(of_point[point], integrity[bond]);
        }
      }
    }
    const std::size_t slot = model.slot_of(*this);
    const std::span<const double> before = history.of(slot);
    const bool is_whole = std::ranges::all_of(integrity, [](double left) { return left == 1.0; });
    const bool is_known = before.empty() ? is_whole : std::ranges::equal(integrity, before);
    if (!is_known) history.replace(slot, std::move(integrity));
  });
}

std::vector<InteractionCount> SimplexTerm::counts() const {
  std::vector<InteractionCount> counts;
  for_each_kind([&](const auto& kind) { counts.push_back(count_of(kind)); });
  return counts;
}

double SimplexTerm::bytes_to_store() const {
  double bytes = 0.0;
  for_each_kind([&](const auto& kind) { bytes += kind.interactions.stored_bytes(); });
  return bytes;
}

double SimplexTerm::stored_bytes() const {
  double bytes = 0.0;
  for_each_kind([&](const auto& kind) {
    if (kind.interactions.is_stored()) bytes += kind.interactions.stored_bytes();
  });
  if (bonds_->fails_by_release()) {
    // What bonds would set free, with the parts beyond threads' rows, and their lower neighbours.
    bytes += double(bonds().count()) * (3.0 * sizeof(double) + sizeof(Index));
  }
  return bytes;
}

void SimplexTerm::store(const Points& points, int threads) {
  if (triangles_) triangles_->interactions.store(points, bonds(), threads);
  if (tetrahedra_) tetrahedra_->interactions.store(points, bonds(), threads);
}

std::unique_ptr<TermPasses> SimplexTerm::passes(const TermSetting& setting) const {
  if (setting.points.dimension == 2) return std::make_unique<SimplexPasses<2>>(*this, setting);
  return std::make_unique<SimplexPasses<3>>(*this, setting);
}

}  // namespace peristat
