#pragma once

#include <array>
#include <limits>
#include <type_traits>

#include "assembly/terms/bonds/bond_batches.hpp"
#include "assembly/terms/bonds/point_columns.hpp"
#include "assembly/terms/bonds/run_damage.hpp"

namespace peristat {

/// Consecutive bonds of a run, side by side.
struct RunBatch {
  Index first;  ///< number of lane 0 in the run
  int count;    ///< lanes past it belong to no bond

  [[nodiscard]] std::size_t number() const { return std::size_t(first) / lane_count; }
};

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

/// The lanes of a batch; `none` past them.
[[nodiscard, gnu::always_inline]] inline Lanes within(const RunBatch& batch, const Lanes& lanes,
                                                      double none) {
  if (batch.count == lane_count) return lanes;
  return chosen(mask_of((1u << batch.count) - 1), lanes, none);
}

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
    Vector<D, Row> arm;
    Row squared, change, tension;
    for_each_batch(
        run, [&](const RunBatch& batch) __attribute__((always_inline)) {
          const std::size_t b = batch.number();
          const Vector<D, Lanes> reference = difference(run, batch, 0),
                                 displacement = difference(run, batch, D);
          const Vector<D, Lanes> current = plus<D>(reference, displacement);
          for (int c = 0; c < D; ++c) arm[c][b] = current[c];
          squared[b] = dot<D>(current, current);
          change[b] = dot<D>(displacement, plus<D>(reference, current));
        });
    const BondKind& kind = bonds_.kind[run.first_bond(bonds_)];
    const Lanes inverse_length = kind.inverse_length, weight = kind.weight;
    Lanes total = 0.0, least = shortest;
    with_densities(
        run, damage, [&](const auto& density) __attribute__((always_inline)) {
          total = 0.0;
          for_each_batch(
              run, [&](const RunBatch& batch) __attribute__((always_inline)) {
                const std::size_t b = batch.number();
                auto measure = Length::from_squares(inverse_length, squared[b], change[b]);
                relieve(measure, run, batch);
                least = min(
                    least, within(batch, measure.current, std::numeric_limits<double>::infinity()));
                const auto phi = density(batch, measure.relative_change);
                if constexpr (with_energy) total += within(batch, phi.value, 0.0);
                tension[b] = within(batch, weight * phi.first * measure.inverse, 0.0);
              });
        });
    energy += sum(total) * (kind.weight / kind.inverse_length);
    shortest = least;
    if (!sums) return;
    add_to_ends(
        run, *sums, [&](int c, std::size_t b) __attribute__((always_inline)) {
          return tension[b] * arm[c][b];
        });
  }

  /// Adds the tangent's product with v; the columns are positions and v. A bond adds psi'' n (n.v)
  /// + psi'/l (v - n (n.v)).
  /// @param damage as above
  [[gnu::noinline]] void add_products(const BondRun& run, RunDamage* damage, double projection,
                                      PointColumns& sums) const {
    Vector<D, Row> arm, along;
    Row squared, product, of_arm, of_along;
    for_each_batch(
        run, [&](const RunBatch& batch) __attribute__((always_inline)) {
          const std::size_t b = batch.number();
          const Vector<D, Lanes> current = difference(run, batch, 0), v = difference(run, batch, D);
          for (int c = 0; c < D; ++c) {
            arm[c][b] = current[c];
            along[c][b] = v[c];
          }
          squared[b] = dot<D>(current, current);
          product[b] = dot<D>(current, v);
        });
    const BondKind& kind = bonds_.kind[run.first_bond(bonds_)];
    const Lanes inverse_length = kind.inverse_length, weight = kind.weight;
    const Lanes of_second = kind.weight * kind.inverse_length;
    with_densities(
        run, damage, [&](const auto& density) __attribute__((always_inline)) {
          for_each_batch(
              run, [&](const RunBatch& batch) __attribute__((always_inline)) {
                const std::size_t b = batch.number();
                auto measure = Length::from_square(inverse_length, squared[b]);
                relieve(measure, run, batch);
                const auto phi = density(batch, measure.relative_change);
                InteractionEnergy<Lanes> psi{0.0, weight * phi.first, of_second * phi.second};
                if (projection > 0.0) psi = projected(psi, projection);
                const Lanes across = psi.first * measure.inverse;
                of_along[b] = within(batch, across, 0.0);
                of_arm[b] = within(
                    batch, (psi.second - across) * (measure.inverse * measure.inverse) * product[b],
                    0.0);
              });
        });
    add_to_ends(
        run, sums, [&](int c, std::size_t b) __attribute__((always_inline)) {
          return of_arm[b] * arm[c][b] + of_along[b] * along[c][b];
        });
  }

 private:
  using Row = std::array<Lanes, (BondRuns::longest + lane_count - 1) / lane_count>;

  template <class Visit>
  [[gnu::always_inline]] static void for_each_batch(const BondRun& run, const Visit& visit) {
    const Index points = run.points;
    Index first = 0;
    for (; first + lane_count <= points; first += lane_count) visit(RunBatch{first, lane_count});
    if (first < points) visit(RunBatch{first, points - first});
  }

  /// Vectors of a batch's partners minus those of its points.
  [[nodiscard, gnu::always_inline]] Vector<D, Lanes> difference(const BondRun& run,
                                                                const RunBatch& batch,
                                                                int component) const {
    Vector<D, Lanes> result;
    for (int c = 0; c < D; ++c) {
      const double* const own = columns_[component + c] + (run.first + batch.first);
      result[c] = Lanes(own + run.ahead) - Lanes(own);
    }
    return result;
  }

  template <class MeasureAt>
  [[gnu::always_inline]] void relieve(MeasureAt& measure, const BondRun& run,
                                      const RunBatch& batch) const {
    if constexpr (std::is_same_v<E, Eigenstretch>) {
      const double* const own = eigenstretch_.of_point + (run.first + batch.first);
      measure.relative_change -=
          0.5 * (Lanes([&](int l) { return l < batch.count ? own[l] + own[l + run.ahead] : 0.0; }));
    }
  }

  /// Calls loop(density), where density(batch, stretch) is that of the bonds; again, from the
  /// start, if a bond fails that it has taken for undamaged.
  template <class Loop>
  [[gnu::always_inline]] void with_densities(const BondRun& run, RunDamage* damage,
                                             const Loop& loop) const {
    if (!damage || !damage->any()) {
      Lanes largest = -std::numeric_limits<double>::infinity();
      loop([&](const RunBatch& batch, const Lanes& stretch) __attribute__((always_inline)) {
        largest = max(largest, within(batch, stretch, -std::numeric_limits<double>::infinity()));
        return whole_(stretch);
      });
      if (!damage || none_of(largest > damage->free_below)) return;
    }
    loop([&](const RunBatch& batch, const Lanes& stretch)
             __attribute__((always_inline)) { return density(run, *damage, batch, stretch); });
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

  /// Adds force(component, batch's number) to the partners and takes it from the points.
  template <class Force>
  [[gnu::always_inline]] static void add_to_ends(const BondRun& run, PointColumns& sums,
                                                 const Force& force) {
    const auto add = [&](Index ahead, double sign) __attribute__((always_inline)) {
      for_each_batch(
          run, [&](const RunBatch& batch) __attribute__((always_inline)) {
            for (int c = 0; c < D; ++c) {
              double* const to = sums[c] + (run.first + batch.first + ahead);
              (Lanes(to) + sign * force(c, batch.number())).copy_to(to);
            }
          });
    };
    // A load that overlaps a store of just before waits for it.
    constexpr Index close = 4 * lane_count;
    if (run.ahead < close) {
      add(0, -1.0);
      add(run.ahead, 1.0);
      return;
    }
    for_each_batch(
        run, [&](const RunBatch& batch) __attribute__((always_inline)) {
          for (int c = 0; c < D; ++c) {
            double* const own = sums[c] + (run.first + batch.first);
            const Lanes added = force(c, batch.number());
            (Lanes(own) - added).copy_to(own);
            (Lanes(own + run.ahead) + added).copy_to(own + run.ahead);
          }
        });
  }

  const Bonds& bonds_;
  const PointColumns& columns_;
  const Whole& whole_;
  const E& eigenstretch_;
  FailingBonds* failing_;
};

}  // namespace peristat
