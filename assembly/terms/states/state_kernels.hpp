#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "assembly/operators/block_pattern.hpp"
#include "assembly/terms/bond_drive.hpp"
#include "assembly/terms/bonds/bond_batches.hpp"
#include "assembly/terms/bonds/bond_sums.hpp"
#include "assembly/terms/bonds/bond_workspace.hpp"
#include "assembly/terms/failure/one_by_one.hpp"
#include "assembly/terms/states/state_network.hpp"
#include "src/core/aligned_vector.hpp"
#include "src/core/threads.hpp"
#include "src/geometry/counts_bond.hpp"
#include "src/geometry/gather_images.hpp"
#include "src/measures/linear_length.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {

/// The sums of StateTerm over bonds. Measure is Length or LinearLength; s is the stretch that it
/// finds, n its gradient, and g = T kappa r the share that integrity leaves of a bond. A field of
/// displacements is passed over twice: the first pass finds the dilatations theta_i = b_i sum g r s
/// of all points, the second the forces f n of bonds, f = g [p_i + p_j + (q_i + q_j) s].
template <int D, class Measure>
class StateKernels {
 public:
  using Span = std::span<const double>;

  /// Shares outlive it.
  /// @param along_runs see Model::sums_along_runs
  StateKernels(const Points& points, const Bonds& bonds, const StateShares& shares,
               Workspace& workspace, bool along_runs)
      : buffers_(points, bonds, workspace, along_runs ? &shares.whole : nullptr),
        whole_(shares.whole),
        twins_(shares.twins) {
    const auto count = points.volume.size();
    for (std::vector<double>* per_point :
         {&dilatational_, &per_moment_, &stiffness_, &energy_, &q_, &p_, &rate_}) {
      per_point->assign(count, 0.0);
    }
    const auto own = std::size_t(points.own());
    for (std::size_t i = 0; i < count; ++i) {
      const auto& [lambda, mu] = shares.constants[i];
      // A point without neighbours has no states.
      per_moment_[i] = shares.moment[i] > 0.0 ? D / shares.moment[i] : 0.0;
      dilatational_[i] = points.volume[i] * (lambda - mu);
      stiffness_[i] = dilatational_[i] * per_moment_[i] * per_moment_[i];
      if (i >= own) dilatational_[i] = 0.0;  // an image's dilatation is its source's
      q_[i] = points.volume[i] * (D + 2) * mu * per_moment_[i];
    }
  }

  /// Leaves integrity(bond) of each bond.
  template <class Integrity>
  void scale(const Integrity& integrity) {
    const Offset count = buffers_.bonds.count();
    integrity_.resize(std::size_t(count) + lane_count, 0.0);
#pragma omp parallel for num_threads(threads())
    for (Offset b = 0; b < count; ++b) integrity_[std::size_t(b)] = integrity(b);
    buffers_.runs.note_damage(buffers_.bonds,
                              [&](RunDamage& damage, const BondRun& run, Index of, Offset bond) {
                                const double left = left_of(bond);
                                if (left < 1.0) damage.note(run, of, left == 0.0);
                              });
  }

  /// Finds p_i = V (lambda - mu) b theta and the energy of each point. Returns the sum of the
  /// energies, and whether a bond has no length.
  template <class E>
  Evaluation find_states(Span u, const E& eigenstretch) {
    buffers_.template take<D>({buffers_.points.reference, u});
    struct alignas(64) OfPart {  // threads write to cache lines of their own
      Lanes least = std::numeric_limits<double>::infinity();
    };
    std::vector<OfPart> shortest(static_cast<std::size_t>(buffers_.threads.parts()));
    sum_parts<2, 1>(
        [&](const auto& batch, const Lanes& share, int part) __attribute__((always_inline)) {
          const auto measure = strained(batch, eigenstretch);
          Lanes& least = shortest[std::size_t(part)].least;
          least =
              min(least, within(batch, measure.current, std::numeric_limits<double>::infinity()));
          const Lanes stretched = share * measure.relative_change * lengths_of(batch);
          return Vector<2, Lanes>{stretched, stretched * measure.relative_change};
        },
        [&](Index point, const double* total) {
          const auto i = std::size_t(point);
          rate_[i] = total[0];
          energy_[i] = q_[i] * total[1];
        });
    gather_images(buffers_.points, rate_);
#pragma omp parallel for num_threads(threads())
    for (std::size_t i = 0; i < energy_.size(); ++i) {
      const double theta = per_moment_[i] * rate_[i];
      p_[i] = stiffness_[i] * rate_[i];
      energy_[i] = 0.5 * (dilatational_[i] * theta * theta + energy_[i]);
    }
    Evaluation found;
    for (const double energy : energy_) found.energy += energy;
    found.degenerate = !std::isfinite(found.energy);
    for (const OfPart& one : shortest) found.degenerate |= !(smallest(one.least) > 0.0);
    return found;
  }

  [[nodiscard]] Span energies() const { return energy_; }

  /// dPi/du, after find_states of the same field.
  template <class E>
  void write_forces(const E& eigenstretch, std::span<double> force, Write how) {
    sum_forces(
        force, how, [&](const auto& batch, const Lanes& share, int) __attribute__((always_inline)) {
          const auto measure = strained(batch, eigenstretch);
          const Lanes q = sum_of_ends(q_.data(), batch), p = sum_of_ends(p_.data(), batch);
          return scaled<D>(share * (p + q * measure.relative_change), measure.gradient[0]);
        });
  }

  /// Adds d2Pi/du2 v after find_states of the displacements u.
  template <class E>
  void write_product(Span u, const E& eigenstretch, Span v, double projection,
                     std::span<double> product, Write how) {
    buffers_.template take<D>(current_and(u, v));
    sum_parts<1, 1>(
        [&](const auto& batch, const Lanes& share, int) __attribute__((always_inline)) {
          return Vector<1, Lanes>{share * dot<D>(current(batch).gradient[0], batch.vector1)};
        },
        [&](Index point, const double* total) { rate_[std::size_t(point)] = *total; });
    gather_images(buffers_.points, rate_);
    for (std::size_t i = 0; i < rate_.size(); ++i) rate_[i] *= stiffness_[i];
    sum_forces(
        product,
        how, [&](const auto& batch, const Lanes& share, int) __attribute__((always_inline)) {
          auto measure = current(batch);
          const Lanes q = sum_of_ends(q_.data(), batch), p = sum_of_ends(p_.data(), batch);
          const Lanes rate = sum_of_ends(rate_.data(), batch);
          const Vector<D, Lanes>& n = measure.gradient[0];
          const Lanes along = dot<D>(n, batch.vector1);
          Vector<D, Lanes> force = scaled<D>(share * (rate + q * along * batch.inverse_length), n);
          if constexpr (bends) {
            relieve(measure, eigenstretch, batch);
            const Lanes pull =
                projected_pull(share * (p + q * measure.relative_change), projection);
            const Lanes across = pull * measure.inverse;
            for (int c = 0; c < D; ++c) force[c] += across * (batch.vector1[c] - along * n[c]);
          }
          return force;
        });
  }

  /// Adds V dw/dH of the points, w their energy densities and H a displacement gradient that is
  /// uniform in a neighbourhood, after find_states of the same field: each end of a bond takes
  /// g (p_i + q_i s) n (x) xi.
  template <class E>
  void add_virials(Span u, const E& eigenstretch, std::span<double> virials) {
    const auto packed = buffers_.template pack<D>({buffers_.points.reference, u});
    constexpr int width = vector_width(D);
    for (int row = 0; row < D; ++row) {
      const auto body = [&](int, RowRange range, double* sums) {
        for (Index i = range.first; i < range.last; ++i) {
          Vector<D, Lanes> own;
          own.fill(Lanes(0.0));
          for_each_bond(
              i, [&](const Batch<D>& batch, const Lanes& share) __attribute__((always_inline)) {
                const auto measure = strained(batch, eigenstretch);
                const Lanes& s = measure.relative_change;
                const Lanes along = share * measure.gradient[0][row];
                const Lanes q([&](int l) { return q_[std::size_t(batch.partner[l])]; });
                const Lanes p([&](int l) { return p_[std::size_t(batch.partner[l])]; });
                const auto here =
                    scaled<D>(along * (p_[std::size_t(i)] + q_[std::size_t(i)] * s), batch.vector0);
                for (int c = 0; c < D; ++c) own[c] += here[c];
                add_to_partners<D>(sums, batch.partner,
                                   scaled<D>(along * (p + q * s), batch.vector0));
              });
          for (int c = 0; c < D; ++c) sums[std::ptrdiff_t(i) * width + c] += sum(own[c]);
        }
      };
      buffers_.threads.template sum_rows<width>(body, [&](Index i, const double* total) {
        put<D>(Write::onto, total, &virials[std::size_t(i) * D * D + std::size_t(row) * D]);
      });
    }
  }

  /// Adds d2Pi/du2 after find_states of the displacements u, row by row: two points j and k with a
  /// common neighbour i get the block V (lambda - mu) G_j G_k^T from it, G the gradient of theta_i:
  /// b_i g n for a neighbour and minus the sum of these for i itself.
  template <class E>
  void add_tangent(Span u, const E& eigenstretch, double projection, const StateNetwork& network,
                   const BlockPattern& pattern, std::span<double> off_diagonal,
                   std::span<double> diagonal) {
    const BondBlocks bonds = bond_blocks(u, eigenstretch, projection, diagonal);
    const std::vector<double> own = own_gradients(network, bonds);
    const Index count = Index(energy_.size());
    run_on_threads(threads(), [&](int thread) {
      std::vector<Offset> place(std::size_t(count), -1);
      const Index first = Index(std::int64_t(count) * thread / threads());
      const Index last = Index(std::int64_t(count) * (thread + 1) / threads());
      for (Index j = first; j < last; ++j) {
        for (Offset b = pattern.offset[j]; b < pattern.offset[j + 1]; ++b) {
          place[std::size_t(pattern.partner(j, b))] = b;
        }
        double* const block_of_point = &diagonal[std::size_t(j) * D * D];
        const auto block_with = [&](Index k) {
          return k == j ? block_of_point
                        : &off_diagonal[std::size_t(place[std::size_t(k)]) * D * D];
        };
        add_centre(network, j, j, of(own, j), own, bonds, block_with);
        for_neighbours(network, j, [&](Index i, Offset bond) {
          if (is_broken(bond)) return;
          const double b_i = per_moment_[std::size_t(i)];
          add_centre(network, i, j, scaled<D>(i < j ? b_i : -b_i, of(bonds.direction, bond)), own,
                     bonds, block_with);
          if (i < j) return;
          const double* const block = &bonds.block[std::size_t(bond) * D * D];
          double* const between = block_with(i);
          for (int c = 0; c < D * D; ++c) between[c] += block[c];
        });
      }
    });
  }

  /// Visits the rows of the tangent's part that is the bonds' own, moved to its positive
  /// semidefinite part, after find_states of the displacements u.
  template <class E>
  void visit_bonds(Span u, const E& eigenstretch, const RowVisitor& visit,
                   std::span<double> diagonal) {
    const auto packed = buffers_.template pack<D>(current_and(u, u));
    visit_rows<D>(buffers_, visit, [&](const auto& blocks_of, const auto& done) {
      sum_blocks<D, Tangent::Blocks::whole>(
          buffers_, whole_,
          [&](const Batch<D>& batch) __attribute__((always_inline)) {
            return block_of(batch, share_of(batch), current(batch), eigenstretch, 1.0);
          },
          blocks_of, done, diagonal);
    });
  }

  /// Damage that committing the state would do by release, after find_states of it, of the bonds
  /// that are counted here: they have complete states.
  /// @param visit(part, DrivenBond) called for each bond whose damage would grow; a bond and its
  ///        twin are one
  template <class P, class E, class Visit>
  DamageGrowth growth_by_release(Span u, const P& law, const E& eigenstretch, const double* history,
                                 const Visit& visit) {
    const auto packed = buffers_.template pack<D>({buffers_.points.reference, u});
    const auto body = [&](int part, RowRange range, double*) {
      DamageGrowth found;
      for (Index i = range.first; i < range.last; ++i) {
        for_each_bond(i, [&](const Batch<D>& batch, const Lanes&) {
          const Lanes s = strained(batch, eigenstretch).relative_change;
          const Lanes drop([&](int l) {
            const Offset bond = batch.first + std::min(l, batch.count - 1);
            return law.of_bond(bond).drop_after(history[bond]);
          });
          const Lanes driving = equivalent_stretch(batch, s, drop);
          for (int l = 0; l < batch.count; ++l) {
            const Offset bond = batch.first + l, twin = twin_of(bond).bond;
            if (0 <= twin && twin < bond) continue;
            if (!counts_bond(buffers_.points, i, batch.partner[l])) continue;
            judge_driven(law.of_bond(bond), {0.0, i, bond, s[l], twin > bond ? twin : -1},
                         driving[l], history[bond], found,
                         [&](const DrivenBond& one) { visit(part, one); });
          }
        });
      }
      buffers_.threads.evaluations[std::size_t(part)] = {0.0, false, found};
    };
    buffers_.threads.template sum_rows<1>(body, [](Index, const double*) {});
    return buffers_.threads.total_evaluation().growth;
  }

  /// Adds to squared equivalent stretches what the dilatations of the bonds' ends drive, see
  /// equivalent_stretch. The drives' stretches need not be those of a state that has been found.
  template <class P>
  void add_drive(const P& law, const double* history, std::span<BondDrive> drives) {
    const Bonds& bonds = buffers_.bonds;
    std::vector<std::array<double, 2>> pressure(energy_.size());  // p and its rate
    const auto body = [&](int, RowRange range, double* sums) {
      for (Index i = range.first; i < range.last; ++i) {
        for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
          const BondDrive& drive = drives[std::size_t(bond)];
          const double part = left_of(bond) * whole_[bond].weight * bonds.length(bond);
          for (const Index end : {i, bonds.partner(i, bond)}) {
            sums[std::ptrdiff_t(end) * 2] += part * drive.stretch;
            sums[std::ptrdiff_t(end) * 2 + 1] += part * drive.rate;
          }
        }
      }
    };
    buffers_.threads.template sum_rows<2>(body, [&](Index i, const double* total) {
      const double stiffness = stiffness_[std::size_t(i)];
      pressure[std::size_t(i)] = {stiffness * total[0], stiffness * total[1]};
    });
    gather_images(buffers_.points, pressure, [](std::array<double, 2>& sum, const auto& more) {
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += more[k];
    });
#pragma omp parallel for num_threads(threads())
    for (Index first = 0; first < bonds.points(); ++first) {
      const auto i = std::size_t(first);
      for (Offset bond = bonds.offset[first]; bond < bonds.offset[first + 1]; ++bond) {
        const auto j = std::size_t(bonds.partner(i, bond));
        const double q = q_[i] + q_[j];
        const double lost = law.of_bond(bond).drop_after(history[bond]) * whole_of(bond) *
                            bonds.length(bond) * (stiffness_[i] + stiffness_[j]) / q;
        auto& [s, speed, squared] = drives[std::size_t(bond)];
        const double factor = 2.0 * (pressure[i][0] + pressure[j][0]) / q - lost * s;
        const double rate = 2.0 * (pressure[i][1] + pressure[j][1]) / q - lost * speed;
        squared[0] += s * factor;
        squared[1] += s * rate + speed * factor;
        squared[2] += speed * rate;
      }
    }
  }

  /// The history that a bond and its twin get, 0 for no loss, and what their points lose of
  /// sum g r s.
  using Loss = std::array<double, 2>;

  /// What a bond and its twin lose, if what the ones before have left of the dilatations still
  /// drives them. The states are those of the present displacements and histories.
  template <class OfBond>
  [[nodiscard]] Loss loss_by_release(const DrivenBond& driven, const OfBond& of_bond,
                                     double history) const {
    const auto i = std::size_t(driven.point);
    const auto j =
        std::size_t(buffers_.points.source(buffers_.bonds.partner(driven.point, driven.bond)));
    const double s = driven.stretch, r = buffers_.bonds.length(driven.bond);
    const double q = q_[i] + q_[j], p = p_[i] + p_[j];
    const double drop = of_bond.drop_after(history);
    const double stiffness = stiffness_[i] + stiffness_[j], whole = whole_of(driven.bond);
    const double squared = s * (s + 2.0 * p / q - drop * whole * r * s * stiffness / q);
    const double driving = s > 0.0 && squared > 0.0 ? std::sqrt(squared) : 0.0;
    const std::optional<double> lost = damage_driven(of_bond, driving, history);
    return lost ? Loss{history, *lost * whole * r * s} : Loss{};
  }

  /// Takes a bond's loss from its points; images are left behind.
  void lose(const DrivenBond& driven, const Loss& loss) {
    lose_at(driven.point, loss);
    if (twin_of(driven.bond).bond == driven.bond) return;  // with a point's own mirror image
    lose_at(buffers_.points.source(buffers_.bonds.partner(driven.point, driven.bond)), loss);
  }
  void lose_at(Index point, const Loss& loss) {
    const auto i = std::size_t(point);
    p_[i] -= stiffness_[i] * loss[1];
  }

  /// State before bonds fail, which their losses depend on.
  struct Before {
    std::vector<double> integrity, pressure;
  };
  [[nodiscard]] Before remembered() const {
    Before before{{integrity_.begin(), integrity_.end()}, std::vector<double>(energy_.size())};
    for (std::size_t i = 0; i < energy_.size(); ++i) before.pressure[i] = p_[i];
    return before;
  }

  /// Returns what Pi loses with bonds: the sum of delta g r [(q_i + q_j) s / 2 + p_i + p_j] s,
  /// p the mean of the pressures before and after, each bond weighted by weight(i, bond, stretch).
  /// After find_states of the same field.
  template <class Weight>
  [[nodiscard]] double losses(Span u, const Before& before, const Weight& weight) const {
    const Bonds& bonds = buffers_.bonds;
    double total = 0.0;
    for (Index i = 0; i < bonds.points(); ++i) {
      for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
        const double lost = (before.integrity[std::size_t(bond)] - integrity_[std::size_t(bond)]) *
                            whole_[bond].weight;
        if (lost == 0.0) continue;
        const Index j = bonds.partner(i, bond);
        const std::span<const double> reference = buffers_.points.reference;
        const Arms<1, D, double> xi{minus<D>(of(reference, j), of(reference, i))};
        const Arms<1, D, double> eta{minus<D>(of(u, j), of(u, i))};
        const double inverse_length = 1.0 / bonds.length(bond);
        const double s = Measure::template at<D>(inverse_length, xi, eta).relative_change;
        const double true_s = Length::at<D>(inverse_length, xi, eta).relative_change;
        const double pressure = 0.5 * (before.pressure[std::size_t(i)] + p_[i] +
                                       before.pressure[std::size_t(j)] + p_[j]);
        const double density = 0.5 * (q_[i] + q_[j]) * s;
        total += lost * bonds.length(bond) * (density + pressure) * s * weight(i, bond, true_s);
      }
    }
    return total;
  }

 private:
  /// Equivalent stretches of bonds that would lose `drop` of their integrity,
  ///
  ///   s_eq^2 = s^2 + 2 (p_i + p_j) s / (q_i + q_j)
  ///            - drop kappa r^2 s^2 (D_i b_i^2 + D_j b_j^2) / (q_i + q_j)  if s > 0, else 0.
  [[gnu::always_inline]] Lanes equivalent_stretch(const Batch<D>& batch, const Lanes& s,
                                                  const Lanes& drop) const {
    const Lanes q = sum_of_ends(q_.data(), batch), p = sum_of_ends(p_.data(), batch);
    const Lanes stiffness = sum_of_ends(stiffness_.data(), batch);
    Lanes whole = batch.weight;
    if (!twins_.empty()) {
      whole = Lanes([&](int l) { return l < batch.count ? whole_of(batch.first + l) : 0.0; });
    }
    const Lanes zero = 0.0;
    const Lanes squared =
        s * (s + 2.0 * p / q - drop * whole * s * stiffness / (q * batch.inverse_length));
    return sqrt(max(chosen(s > zero, squared, zero), zero));
  }

  [[nodiscard]] BondTwin twin_of(Offset bond) const {
    return twins_.empty() ? BondTwin() : twins_[std::size_t(bond)];
  }

  /// Share kappa r of a bond together with its twin.
  [[nodiscard]] double whole_of(Offset bond) const {
    return (twin_of(bond).bond < 0 ? 1.0 : 2.0) * whole_[bond].weight;
  }

  /// Whether the direction of a bond changes with displacements.
  static constexpr bool bends = std::is_same_v<Measure, Length>;

  /// Of each bond from its first to its second point: g n, with its twin's g, which has the same
  /// part in the dilatation of the first; and minus the block of the bond alone.
  struct BondBlocks {
    std::vector<double> direction, block;
  };

  [[nodiscard]] int threads() const { return buffers_.threads.threads(); }

  template <class Field>
  [[nodiscard]] static Vector<D, double> of(const Field& field, std::int64_t i) {
    Vector<D, double> at;
    for (int c = 0; c < D; ++c) at[c] = field[std::size_t(i) * D + std::size_t(c)];
    return at;
  }

  /// Calls visit(batch, g) for the bonds of row i; g is zero in lanes past the last bond.
  template <class Visit>
  [[gnu::always_inline]] void for_each_bond(Index i, const Visit& visit) const {
    for_each_batch<D>(
        buffers_.bonds, whole_, buffers_.template rows<D>(),
        i, [&](const Batch<D>& batch) __attribute__((always_inline)) {
          visit(batch, share_of(batch));
        });
  }

  /// g of bonds of a run.
  [[gnu::always_inline]] Lanes share_of(const RunBonds<D>& batch, const RunDamage* damage) const {
    Lanes share = batch.weight;
    if (!damage || !damage->any()) return share;
    if (const unsigned damaged = damage->damaged(batch.number())) {
      for (int l = 0; l < batch.count; ++l) {
        if (!(damaged >> l & 1u)) continue;
        const Index i = batch.run.first + batch.first + l;
        share.set(l, share[l] * left_of(*buffers_.bonds.find(i, i + batch.run.ahead)));
      }
    }
    const unsigned broken = damage->broken(batch.number());
    return broken ? chosen(mask_of(broken), 0.0, share) : share;
  }

  /// g of the bonds of a batch.
  [[gnu::always_inline]] Lanes share_of(const Batch<D>& batch,
                                        const RunDamage* /*none*/ = nullptr) const {
    return integrity_.empty() ? batch.weight
                              : batch.weight * Lanes(&integrity_[std::size_t(batch.first)]);
  }

  /// Measure of rows with the reference and the displacement, less the eigenstretch.
  template <class AnyBatch, class E>
  [[gnu::always_inline]] static auto strained(const AnyBatch& batch, const E& eigenstretch) {
    auto measure =
        Measure::template at<D, Lanes>(batch.inverse_length, {batch.vector0}, {batch.vector1});
    relieve(measure, eigenstretch, batch);
    return measure;
  }

  /// Measure of rows with current_and.
  template <class AnyBatch>
  [[gnu::always_inline]] static auto current(const AnyBatch& batch) {
    if constexpr (bends) {
      return Length::from_current<D, Lanes>(batch.inverse_length, {batch.vector0});
    } else {
      return LinearLength::from_reference<D, Lanes>(batch.inverse_length, {batch.vector0});
    }
  }

  /// The vectors that directions follow from, and v.
  [[nodiscard]] PointVectors current_and(Span u, Span v) const {
    return {buffers_.points.reference, v, bends ? u : Span()};
  }

  /// f moved by a share towards being no compression, in which a bond tends to turn aside.
  [[gnu::always_inline]] static Lanes projected_pull(const Lanes& pull, double projection) {
    return projection > 0.0 ? pull - projection * min(pull, Lanes(0.0)) : pull;
  }

  /// Sums part_of(batch, g, thread) of bonds, see sum_bonds.
  template <int width, int sign, class PartOf, class Done>
  void sum_parts(const PartOf& part_of, const Done& done) {
    sum_bonds<D, width, sign>(
        buffers_, whole_,
        [&](const auto& batch, const RunDamage* damage, int thread) __attribute__((always_inline)) {
          return part_of(batch, share_of(batch, damage), thread);
        },
        done);
  }

  /// Sums force(batch, g, thread) of bonds: plus at their partners, minus at their points.
  template <class Force>
  void sum_forces(std::span<double> result, Write how, const Force& force_of) {
    sum_parts<D, -1>(force_of, [&](Index i, const double* total) {
      put<D>(how, total, &result[std::size_t(i) * D]);
    });
  }

  /// Calls visit(neighbour, bond), neighbours ascending.
  template <class Visit>
  void for_neighbours(const StateNetwork& network, Index i, const Visit& visit) const {
    network.for_each_neighbour(buffers_.bonds, i, visit);
  }

  [[nodiscard]] bool is_broken(Offset bond) const {
    return whole_[bond].weight == 0.0 || left_of(bond) == 0.0;
  }

  /// Integrity of a bond.
  [[nodiscard]] double left_of(Offset bond) const {
    return integrity_.empty() ? 1.0 : integrity_[std::size_t(bond)];
  }

  /// Block of bonds alone, g (q_i + q_j) / r n n^T + f / l (I - n n^T), from a measure by
  /// `current`.
  template <class E, class MeasureAt>
  [[gnu::always_inline]] Matrix<D, Lanes> block_of(const Batch<D>& batch, const Lanes& share,
                                                   MeasureAt measure, const E& eigenstretch,
                                                   double projection) const {
    const Lanes q = sum_of_ends(q_.data(), batch), p = sum_of_ends(p_.data(), batch);
    const Vector<D, Lanes> n = measure.gradient[0];
    relieve(measure, eigenstretch, batch);
    const Lanes across =
        projected_pull(share * (p + q * measure.relative_change), projection) * measure.inverse;
    const Lanes along = share * q * batch.inverse_length - across;
    Matrix<D, Lanes> block;
    for (int r = 0; r < D; ++r) {
      for (int c = 0; c < D; ++c) block[r][c] = along * n[r] * n[c] + (r == c ? across : 0.0);
    }
    return block;
  }

  /// Also adds the blocks to those of their points.
  template <class E>
  [[nodiscard]] BondBlocks bond_blocks(Span u, const E& eigenstretch, double projection,
                                       std::span<double> diagonal) {
    const Bonds& bonds = buffers_.bonds;
    BondBlocks of_bonds{std::vector<double>(std::size_t(bonds.count()) * D),
                        std::vector<double>(std::size_t(bonds.count()) * D * D)};
    std::vector<double> of_points(diagonal.size());
    const auto packed = buffers_.template pack<D>(current_and(u, u));
    sum_blocks<D, Tangent::Blocks::whole>(
        buffers_, whole_,
        [&](const Batch<D>& batch) {
          const Lanes share = share_of(batch);
          const auto measure = current(batch);
          for (int l = 0; l < batch.count; ++l) {
            const double both = twin_of(batch.first + l).bond < 0 ? share[l] : 2.0 * share[l];
            for (int c = 0; c < D; ++c) {
              of_bonds.direction[std::size_t(batch.first + l) * D + std::size_t(c)] =
                  both * measure.gradient[0][c][l];
            }
          }
          return block_of(batch, share, measure, eigenstretch, projection);
        },
        [&](int, Index i) { return &of_bonds.block[std::size_t(bonds.offset[i]) * D * D]; },
        [](int, Index) {}, of_points);
    for (std::size_t k = 0; k < diagonal.size(); ++k) diagonal[k] += of_points[k];
    return of_bonds;
  }

  /// Adds the blocks of theta_i between j and the points k >= j.
  template <class BlockWith>
  void add_centre(const StateNetwork& network, Index i, Index j, const Vector<D, double>& g_j,
                  const std::vector<double>& own, const BondBlocks& bonds,
                  const BlockWith& block_with) const {
    const double stiffness = dilatational_[std::size_t(i)];
    if (stiffness == 0.0) return;
    const auto add = [&](double factor, const Vector<D, double>& g_k, double* block) {
      for (int r = 0; r < D; ++r) {
        for (int c = 0; c < D; ++c) block[r * D + c] += factor * g_j[r] * g_k[c];
      }
    };
    if (i >= j) add(stiffness, of(own, i), block_with(i));
    const double share = stiffness * per_moment_[std::size_t(i)];
    for_neighbours(network, i, [&](Index k, Offset bond) {
      if (k < j || is_broken(bond)) return;
      add(k > i ? share : -share, of(bonds.direction, bond), block_with(k));
    });
  }

  /// dtheta_i/du_i
  [[nodiscard]] std::vector<double> own_gradients(const StateNetwork& network,
                                                  const BondBlocks& bonds) const {
    std::vector<double> own(energy_.size() * D, 0.0);
#pragma omp parallel for num_threads(threads())
    for (Index i = 0; i < Index(energy_.size()); ++i) {
      Vector<D, double> total{};
      for_neighbours(network, i, [&](Index k, Offset bond) {
        const Vector<D, double> part = of(bonds.direction, bond);
        for (int c = 0; c < D; ++c) total[c] += k > i ? -part[c] : part[c];
      });
      for (int c = 0; c < D; ++c) {
        own[std::size_t(i) * D + std::size_t(c)] = per_moment_[std::size_t(i)] * total[c];
      }
    }
    return own;
  }

  BondWorkspace buffers_;
  const BondKinds& whole_;  // per bond kappa r
  const std::vector<BondTwin>& twins_;
  AlignedVector<double> integrity_;   // per bond T, padded by a batch; empty: none fails
  std::vector<double> q_, p_;         // V d (d + 2) mu / M, and p of the last state
  std::vector<double> dilatational_;  // V (lambda - mu) [J]
  std::vector<double> per_moment_;    // b = d / M
  std::vector<double> stiffness_;     // V (lambda - mu) b^2
  std::vector<double> energy_, rate_;
};

}  // namespace peristat
