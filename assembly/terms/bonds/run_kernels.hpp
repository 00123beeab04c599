#pragma once

#include <limits>
#include <span>
#include <type_traits>

#include "assembly/terms/bonds/bond_batches.hpp"
#include "assembly/terms/bonds/point_columns.hpp"
#include "assembly/terms/bonds/run_pieces.hpp"

namespace peristat {

/// A batch of bonds of consecutive points: those that are k-th of their points.
struct RunBatch {
  Index point;       ///< of lane 0
  Index ahead;       ///< from a point to its partner
  Offset bond;       ///< of lane 0
  Offset per_point;  ///< from the bond of a lane to that of the next
  Offset k;
  int count;  ///< lanes past it belong to no bond
};

/// Densities of a batch of which some bonds are damaged or start to fail.
class FailingBatch {
 public:
  /// @param damaged flags of the lanes
  virtual PotentialDensity<Lanes> operator()(const RunPiece& piece, const RunBatch& batch,
                                             unsigned damaged, const Lanes& stretch) = 0;

 protected:
  ~FailingBatch() = default;
};

/// The same for bonds with a potential P and a history.
template <class P>
class FailingBatchOf final : public FailingBatch {
 public:
  /// @param changing null: the history does not change. Otherwise it moves to the stretches first,
  /// and the damage is added to `growth`
  FailingBatchOf(const P& potential, const Points& points, const double* largest_stretch,
                 double* changing, DamageGrowth& growth)
      : potential_(potential),
        points_(points),
        largest_stretch_(largest_stretch),
        changing_(changing),
        growth_(growth) {}

  PotentialDensity<Lanes> operator()(const RunPiece& piece, const RunBatch& batch, unsigned damaged,
                                     const Lanes& stretch) override {
    PotentialDensity<Lanes> all = whole_potential(potential_)(stretch);
    for (int l = 0; l < batch.count; ++l) {
      if (!(damaged >> l & 1u) && !(stretch[l] > piece.free_below)) continue;
      const Offset bond = batch.bond + l * batch.per_point;
      if (changing_) commit(piece, batch, l, stretch[l]);
      const PotentialDensity<double> one = density(potential_.of_bond(bond), bond, stretch[l]);
      all.value.set(l, one.value);
      all.first.set(l, one.first);
      all.second.set(l, one.second);
    }
    return all;
  }

 private:
  /// Most damaged bonds are broken: they need no law.
  template <class OfBond>
  [[nodiscard]] PotentialDensity<double> density(const OfBond& of_bond, Offset bond,
                                                 double stretch) const {
    const double largest = largest_stretch_[bond];
    const bool is_closed = of_bond.closes && !(stretch > 0.0);
    if (of_bond.is_broken(largest) && !is_closed) return {0.0, 0.0, 0.0};
    return of_bond(stretch, largest);
  }

  void commit(const RunPiece& piece, const RunBatch& batch, int l, double stretch) {
    const Offset bond = batch.bond + l * batch.per_point;
    const Index i = batch.point + l;
    const double before = changing_[bond];
    commit_bond(points_, potential_.of_bond(bond), i, i + batch.ahead, stretch, changing_[bond],
                growth_);
    if (changing_[bond] == before) return;
    piece.damaged->raise(batch.k, i - piece.first_of_run);
  }

  const P& potential_;
  const Points& points_;
  const double* largest_stretch_;
  double* changing_;
  DamageGrowth& growth_;
};

/// The lanes of a batch; `none` past them.
[[nodiscard, gnu::always_inline]] inline Lanes within(const RunBatch& batch, const Lanes& lanes,
                                                      double none) {
  if (batch.count == lane_count) [[likely]]
    return lanes;
  return Lanes([&](int l) { return l < batch.count ? lanes[l] : none; });
}

/// Sums over the bonds of a piece of a run. All points have alike bonds, so the passes go through
/// the k-th bonds of all points before the next ones, with one kind. Each goes thrice through the
/// piece: differences between points, then square roots and divisions, then sums. One loop with all
/// three waits for the roots of each batch: processors do not look far enough ahead. The passes are
/// compiled once for all laws of damage: they are not inlined.
template <int D, class Whole, class E>
class RunPass {
 public:
  /// @param columns what is read, see the passes
  /// @param whole potential of the undamaged bonds
  /// @param failing null: none can
  RunPass(const Bonds& bonds, const PointColumns& columns, const Whole& whole,
          const E& eigenstretch, FailingBatch* failing)
      : bonds_(bonds),
        columns_(columns),
        whole_(whole),
        eigenstretch_(eigenstretch),
        failing_(failing) {}

  /// Adds forces and energy; the columns are reference positions and displacements.
  /// @param sums of forces; null: not wanted
  template <bool with_energy>
  [[gnu::noinline]] void add_forces(const RunPiece& piece, PointColumns* sums, double& energy,
                                    Lanes& shortest) const {
    Vector<D, Row> arm;
    Row squared, change, tension;
    Lanes total = 0.0, least = shortest;
    for_each_bond(piece, [&](const Bond& bond) {
      for_each_batch(piece, [&](int b, Index i) {
        const Vector<D, Lanes> reference = difference(i, bond.ahead, 0),
                               displacement = difference(i, bond.ahead, D);
        const Vector<D, Lanes> current = plus<D>(reference, displacement);
        for (int c = 0; c < D; ++c) arm[c][b] = current[c];
        squared[b] = dot<D>(current, current);
        change[b] = dot<D>(displacement, plus<D>(reference, current));
      });
      const Lanes inverse_length = bond.kind.inverse_length, weight = bond.kind.weight;
      const Lanes of_energy = bond.kind.weight / bond.kind.inverse_length;
      for_each_batch(piece, [&](int b, Index i) {
        auto measure = Length::from_squares(inverse_length, squared[b], change[b]);
        const RunBatch batch = batch_of(piece, bond, i);
        relieve(measure, batch);
        least = min(least, within(batch, measure.current, std::numeric_limits<double>::infinity()));
        const auto phi = density(piece, batch, measure.relative_change);
        if constexpr (with_energy) total += within(batch, phi.value, 0.0) * of_energy;
        tension[b] = within(batch, weight * phi.first * measure.inverse, 0.0);
      });
      if (!sums) return;
      for_each_batch(piece, [&](int b, Index i) {
        for (int c = 0; c < D; ++c) add_to_both(*sums, c, i, bond.ahead, tension[b] * arm[c][b]);
      });
    });
    energy += sum(total);
    shortest = least;
  }

  /// Adds the tangent's product with v; the columns are positions and v. A bond adds psi'' n (n.v)
  /// + psi'/l (v - n (n.v)).
  [[gnu::noinline]] void add_products(const RunPiece& piece, double projection,
                                      PointColumns& sums) const {
    Vector<D, Row> arm, along;
    Row squared, product, of_arm, of_along;
    for_each_bond(piece, [&](const Bond& bond) {
      for_each_batch(piece, [&](int b, Index i) {
        const Vector<D, Lanes> current = difference(i, bond.ahead, 0),
                               v = difference(i, bond.ahead, D);
        for (int c = 0; c < D; ++c) {
          arm[c][b] = current[c];
          along[c][b] = v[c];
        }
        squared[b] = dot<D>(current, current);
        product[b] = dot<D>(current, v);
      });
      const Lanes inverse_length = bond.kind.inverse_length, weight = bond.kind.weight;
      const Lanes of_second = bond.kind.weight * bond.kind.inverse_length;
      for_each_batch(piece, [&](int b, Index i) {
        auto measure = Length::from_square(inverse_length, squared[b]);
        const RunBatch batch = batch_of(piece, bond, i);
        relieve(measure, batch);
        const auto phi = density(piece, batch, measure.relative_change);
        InteractionEnergy<Lanes> psi{0.0, weight * phi.first, of_second * phi.second};
        if (projection > 0.0) psi = projected(psi, projection);
        const Lanes across = psi.first * measure.inverse;
        of_along[b] = within(batch, across, 0.0);
        of_arm[b] = within(
            batch, (psi.second - across) * (measure.inverse * measure.inverse) * product[b], 0.0);
      });
      for_each_batch(piece, [&](int b, Index i) {
        for (int c = 0; c < D; ++c)
          add_to_both(sums, c, i, bond.ahead, of_arm[b] * arm[c][b] + of_along[b] * along[c][b]);
      });
    });
  }

 private:
  using Row = std::array<Lanes, (RunPieces::longest + lane_count - 1) / lane_count>;

  /// The k-th bonds of the points.
  struct Bond {
    Index ahead;
    Offset first, per_point, k;
    BondKind kind;
  };

  template <class Visit>
  [[gnu::always_inline]] void for_each_bond(const RunPiece& piece, const Visit& visit) const {
    const Offset first = bonds_.offset[piece.first];
    const Offset per_point = bonds_.offset[piece.first + 1] - first;
    for (Offset bond = first; bond < first + per_point; ++bond) {
      visit(Bond{bonds_.partner[bond] - piece.first, bond, per_point, bond - first,
                 bonds_.kind[bond]});
    }
  }

  /// Calls visit(number, first point) for the batches of a piece.
  template <class Visit>
  [[gnu::always_inline]] static void for_each_batch(const RunPiece& piece, const Visit& visit) {
    int b = 0;
    for (Index i = piece.first; i < piece.last; i += lane_count) visit(b++, i);
  }

  /// Vectors of a batch's partners minus those of its points.
  [[nodiscard, gnu::always_inline]] Vector<D, Lanes> difference(Index i, Index ahead,
                                                                int component) const {
    Vector<D, Lanes> result;
    for (int c = 0; c < D; ++c) {
      const double* const own = columns_[component + c] + i;
      result[c] = Lanes(own + ahead) - Lanes(own);
    }
    return result;
  }

  [[nodiscard, gnu::always_inline]] static RunBatch batch_of(const RunPiece& piece,
                                                             const Bond& bond, Index i) {
    return {i,
            bond.ahead,
            bond.first + (i - piece.first) * bond.per_point,
            bond.per_point,
            bond.k,
            std::min<int>(lane_count, piece.last - i)};
  }

  template <class MeasureAt>
  [[gnu::always_inline]] void relieve(MeasureAt& measure, const RunBatch& batch) const {
    if constexpr (std::is_same_v<E, Eigenstretch>) {
      const double* const own = eigenstretch_.of_point + batch.point;
      measure.relative_change -=
          0.5 *
          (Lanes([&](int l) { return l < batch.count ? own[l] + own[l + batch.ahead] : 0.0; }));
    }
  }

  [[nodiscard, gnu::always_inline]] PotentialDensity<Lanes> density(const RunPiece& piece,
                                                                    const RunBatch& batch,
                                                                    const Lanes& stretch) const {
    if (piece.damaged) {
      const unsigned damaged = piece.damaged->of(batch.k, batch.point - piece.first_of_run);
      if (damaged != 0 || any_of(stretch > piece.free_below)) [[unlikely]] {
        return (*failing_)(piece, batch, damaged, stretch);
      }
    }
    return whole_(stretch);
  }

  [[gnu::always_inline]] static void add_to_both(PointColumns& sums, int component, Index i,
                                                 Index ahead, const Lanes& force) {
    double* const own = sums[component] + i;
    (Lanes(own) - force).copy_to(own);
    (Lanes(own + ahead) + force).copy_to(own + ahead);
  }

  const Bonds& bonds_;
  const PointColumns& columns_;
  const Whole& whole_;
  const E& eigenstretch_;
  FailingBatch* failing_;
};

}  // namespace peristat
