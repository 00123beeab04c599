#pragma once

#include <array>
#include <limits>
#include <type_traits>

#include "assembly/terms/bonds/bond_batches.hpp"
#include "assembly/terms/bonds/run_batches.hpp"
#include "assembly/terms/bonds/run_damage.hpp"

namespace peristat {

/// Densities of bonds that are damaged or start to fail.
class FailingBonds {
 public:
  /// Replaces the densities of these lanes.
  virtual void evaluate(const BondRun& run, RunDamage& damage, const RunBatch& batch,
                        unsigned lanes, const Lanes& stretch, PotentialDensity<Lanes>& all) = 0;

 protected:
  ~FailingBonds() = default;
};

/// The same for bonds with a potential P and a history.
template <class P>
class FailingBondsOf final : public FailingBonds {
 public:
  /// @param changing null: the history does not change. Otherwise it moves to the stretches first,
  /// and the damage is added to `growth`
  FailingBondsOf(const P& potential, const Points& points, const Bonds& bonds,
                 const double* largest_stretch, double* changing, DamageGrowth& growth)
      : potential_(potential),
        points_(points),
        bonds_(bonds),
        largest_stretch_(largest_stretch),
        changing_(changing),
        growth_(growth) {}

  void evaluate(const BondRun& run, RunDamage& damage, const RunBatch& batch, unsigned lanes,
                const Lanes& stretch, PotentialDensity<Lanes>& all) override {
    for (int l = 0; l < batch.count; ++l) {
      if (!(lanes >> l & 1u)) continue;
      const Index of = batch.first + l, i = run.first + of;
      const Offset bond = *bonds_.find(i, i + run.ahead);
      const auto& of_bond = potential_.of_bond(bond);
      if (changing_) {
        double& largest = changing_[bond];
        const double before = largest;
        commit_bond(points_, of_bond, i, i + run.ahead, stretch[l], largest, growth_);
        if (largest != before) damage.note(run, of, bears_nothing(of_bond, largest));
      }
      const PotentialDensity<double> one = of_bond(stretch[l], largest_stretch_[bond]);
      all.value.set(l, one.value);
      all.first.set(l, one.first);
      all.second.set(l, one.second);
    }
  }

 private:
  const P& potential_;
  const Points& points_;
  const Bonds& bonds_;
  const double* largest_stretch_;
  double* changing_;
  DamageGrowth& growth_;
};

/// Sums over the bonds of a run, in loops over its points: differences between points, then square
/// roots and divisions, then sums. One loop with all of that waits for the roots of each batch:
/// processors do not look far enough ahead. Where no bond is damaged, the second loop takes all
/// bonds for undamaged, and is repeated if one of them turns out to fail. The passes are compiled
/// once for all laws of damage: they are not inlined.
template <int D, class Whole, class E>
class RunPass {
 public:
  /// @param columns what is read, see the passes
  /// @param whole potential of the undamaged bonds
  /// @param failing null: none can
  RunPass(const Bonds& bonds, const PointColumns& columns, const Whole& whole,
          const E& eigenstretch, FailingBonds* failing)
      : bonds_(bonds),
        columns_(columns),
        whole_(whole),
        eigenstretch_(eigenstretch),
        failing_(failing) {}

  /// Adds forces and energy; the columns are reference positions and displacements.
  /// @param damage of the run; null: no bond can fail
  /// @param sums of forces; null: not wanted
  template <bool with_energy>
  [[gnu::noinline]] void add_forces(const BondRun& run, RunDamage* damage, PointColumns* sums,
                                    double& energy, Lanes& shortest) const {
    Vector<D, RunRow> arm;
    RunRow squared, change, tension;
    find_arms(run, arm, squared, change);
    Lanes total = 0.0, least = shortest;
    double common = 0.0;
    with_kinds_and_densities<Lanes>(
        run, damage, [&](const auto& kinds, const auto& density) __attribute__((always_inline)) {
          total = 0.0;
          common = kinds.common_energy_weight();
          for_each_batch(
              run, [&](const RunBatch& batch) __attribute__((always_inline)) {
                const std::size_t b = batch.number();
                const OneKind<Lanes> kind = kinds.of(batch);
                auto measure = Length::from_squares(kind.inverse_length, squared[b], change[b]);
                relieve(measure, run, batch);
                least = min(
                    least, within(batch, measure.current, std::numeric_limits<double>::infinity()));
                const auto phi = density(batch, measure.relative_change);
                if constexpr (with_energy) {
                  total += within(batch, kinds.energy_weight(kind) * phi.value, 0.0);
                }
                tension[b] = within(batch, kind.weight * phi.first * measure.inverse, 0.0);
              });
        });
    energy += sum(total) * common;
    shortest = least;
    if (!sums) return;
    add_to_ends<D, -1>(
        run, *sums, [&](int c, std::size_t b) __attribute__((always_inline)) {
          return tension[b] * arm[c][b];
        });
  }

  /// Adds D entries of the upper halves of the bonds' Hessians to both of their ends; the columns
  /// are as for forces.
  /// @param damage as above
  /// @param first entry
  [[gnu::noinline]] void add_diagonals(const BondRun& run, RunDamage* damage, double projection,
                                       int first, PointColumns& sums) const {
    Vector<D, RunRow> arm;
    RunRow squared, change, of_arms, of_unit;
    find_arms(run, arm, squared, change);
    with_kinds_and_densities<Lanes>(
        run, damage, [&](const auto& kinds, const auto& density) __attribute__((always_inline)) {
          for_each_batch(
              run, [&](const RunBatch& batch) __attribute__((always_inline)) {
                const std::size_t b = batch.number();
                const OneKind<Lanes> kind = kinds.of(batch);
                auto measure = Length::from_squares(kind.inverse_length, squared[b], change[b]);
                relieve(measure, run, batch);
                const auto [along, across] =
                    stiffness(kind, density(batch, measure.relative_change), measure, projection);
                of_unit[b] = within(batch, across, 0.0);
                of_arms[b] =
                    within(batch, (along - across) * (measure.inverse * measure.inverse), 0.0);
              });
        });
    add_to_ends<D, 1>(
        run, sums, [&](int k, std::size_t b) __attribute__((always_inline)) {
          const auto [r, c] = entries_of_upper_half<D>[std::size_t(first + k)];
          const Lanes entry = of_arms[b] * arm[r][b] * arm[c][b];
          return r == c ? entry + of_unit[b] : entry;
        });
  }

  /// Adds the tangent's product with v; the columns are positions and v. A bond adds psi'' n (n.v)
  /// + psi'/l (v - n (n.v)).
  /// @param damage as above
  /// @param precision of the bonds' parts where none is damaged; differences between points and
  ///        sums are in double precision
  void add_products(const BondRun& run, RunDamage* damage, double projection, Precision precision,
                    PointColumns& sums) const {
    const bool in_single = precision == Precision::single && !(damage && damage->any());
    if (in_single && add_products_in<SingleLanes>(run, damage, projection, sums)) return;
    add_products_in<Lanes>(run, damage, projection, sums);
  }

 private:
  /// @return false if a bond needs double precision; nothing has then been added
  template <class L>
  [[gnu::noinline]] bool add_products_in(const BondRun& run, RunDamage* damage, double projection,
                                         PointColumns& sums) const {
    Vector<D, RunRowOf<L>> arm, along;
    RunRowOf<L> squared, product, of_arm, of_along;
    for_each_batch<L>(
        run, [&](const RunBatchOf<L>& batch) __attribute__((always_inline)) {
          const std::size_t b = batch.number();
          const Vector<D, L> current = difference<D>(columns_, 0, run, batch),
                             v = difference<D>(columns_, D, run, batch);
          for (int c = 0; c < D; ++c) {
            arm[c][b] = current[c];
            along[c][b] = v[c];
          }
          squared[b] = dot<D>(current, current);
          product[b] = dot<D>(current, v);
        });
    const bool holds = with_kinds_and_densities<L>(
        run, damage, [&](const auto& kinds, const auto& density) __attribute__((always_inline)) {
          for_each_batch<L>(
              run, [&](const RunBatchOf<L>& batch) __attribute__((always_inline)) {
                const std::size_t b = batch.number();
                const OneKind<L> kind = kinds.of(batch);
                auto measure = Length::from_square(kind.inverse_length, squared[b]);
                relieve(measure, run, batch);
                const auto phi = density(batch, measure.relative_change);
                const auto [along_bond, across] = stiffness(kind, phi, measure, projection);
                of_along[b] = within(batch, across, 0.0);
                of_arm[b] = within(
                    batch, (along_bond - across) * (measure.inverse * measure.inverse) * product[b],
                    0.0);
              });
        });
    if (!holds) return false;
    add_to_ends<D, -1, L>(
        run, sums, [&](int c, std::size_t b) __attribute__((always_inline)) {
          return of_arm[b] * arm[c][b] + of_along[b] * along[c][b];
        });
    return true;
  }

 private:
  /// Current vectors of the bonds with their squares, and these minus the squares in the reference.
  [[gnu::always_inline]] void find_arms(const BondRun& run, Vector<D, RunRow>& arm, RunRow& squared,
                                        RunRow& change) const {
    for_each_batch(
        run, [&](const RunBatch& batch) __attribute__((always_inline)) {
          const std::size_t b = batch.number();
          const Vector<D, Lanes> reference = difference<D>(columns_, 0, run, batch),
                                 displacement = difference<D>(columns_, D, run, batch);
          const Vector<D, Lanes> current = plus<D>(reference, displacement);
          for (int c = 0; c < D; ++c) arm[c][b] = current[c];
          squared[b] = dot<D>(current, current);
          change[b] = dot<D>(displacement, plus<D>(reference, current));
        });
  }

  /// Eigenvalues of the bonds' Hessians, psi'' along them and psi'/l across.
  template <class L>
  struct Stiffness {
    L along, across;
  };
  template <class L, class MeasureAt>
  [[gnu::always_inline]] static Stiffness<L> stiffness(const OneKind<L>& kind,
                                                       const PotentialDensity<L>& phi,
                                                       const MeasureAt& measure,
                                                       double projection) {
    InteractionEnergy<L> psi{0.0, kind.weight * phi.first,
                             kind.weight * kind.inverse_length * phi.second};
    if (projection > 0.0) psi = projected(psi, projection);
    return {psi.second, psi.first * measure.inverse};
  }

  template <class MeasureAt, class L>
  [[gnu::always_inline]] void relieve(MeasureAt& measure, const BondRun& run,
                                      const RunBatchOf<L>& batch) const {
    if constexpr (std::is_same_v<E, Eigenstretch>) {
      measure.relative_change -= 0.5 * sum_of_ends(eigenstretch_.of_point, run, batch);
    }
  }

  /// The potential of undamaged bonds; in single precision its modulus is among the weights.
  template <class L>
  [[nodiscard, gnu::always_inline]] Whole whole() const {
    Whole result = whole_;
    if constexpr (!std::is_same_v<L, Lanes>) result.modulus = 1.0;
    return result;
  }

  /// Calls loop(kinds, density), see with_kinds and with_densities.
  template <class L, class Loop>
  [[gnu::always_inline]] bool with_kinds_and_densities(const BondRun& run, RunDamage* damage,
                                                       const Loop& loop) const {
    bool holds = true;
    with_kinds<L>(
        bonds_, bonds_.kind, run,
        [&](const auto& kinds) __attribute__((always_inline)) {
          holds = with_densities<L>(
              run, damage, [&](const auto& density) __attribute__((always_inline)) {
                loop(kinds, density);
              });
        },
        whole_.modulus);
    return holds;
  }

  /// Calls loop(density), where density(batch, stretch) is that of the bonds; again, from the
  /// start, if a bond fails that it has taken for undamaged.
  /// @return false if it had to, and L is too rough for bonds that fail
  template <class L, class Loop>
  [[gnu::always_inline]] bool with_densities(const BondRun& run, RunDamage* damage,
                                             const Loop& loop) const {
    if (!damage || !damage->any()) {
      L largest = -std::numeric_limits<double>::infinity();
      loop([&](const RunBatchOf<L>& batch, const L& stretch) __attribute__((always_inline)) {
        largest = max(largest, within(batch, stretch, -std::numeric_limits<double>::infinity()));
        return whole<L>()(stretch);
      });
      if (!damage || none_of(largest > damage->free_below)) return true;
    }
    if constexpr (std::is_same_v<L, Lanes>) {
      loop([&](const RunBatch& batch, const Lanes& stretch)
               __attribute__((always_inline)) { return density(run, *damage, batch, stretch); });
      return true;
    }
    return false;
  }

  [[nodiscard, gnu::always_inline]] PotentialDensity<Lanes> density(const BondRun& run,
                                                                    RunDamage& damage,
                                                                    const RunBatch& batch,
                                                                    const Lanes& stretch) const {
    PotentialDensity<Lanes> all = whole_(stretch);
    unsigned failing = bits_of(stretch > damage.free_below), broken = 0;
    if (damage.any()) {
      broken = damage.broken(batch.number());
      failing = (failing | damage.damaged(batch.number())) & ~broken;
    }
    if (failing != 0) [[unlikely]]
      failing_->evaluate(run, damage, batch, failing, stretch, all);
    if (broken != 0) {
      const LaneMask none = mask_of(broken);
      all.value = chosen(none, 0.0, all.value);
      all.first = chosen(none, 0.0, all.first);
      all.second = chosen(none, 0.0, all.second);
    }
    return all;
  }

  const Bonds& bonds_;
  const PointColumns& columns_;
  const Whole& whole_;
  const E& eigenstretch_;
  FailingBonds* failing_;
};

}  // namespace peristat
