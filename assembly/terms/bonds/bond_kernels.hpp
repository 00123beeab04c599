#pragma once

#include <limits>
#include <span>
#include <type_traits>

#include "assembly/terms/bonds/bond_batches.hpp"
#include "assembly/terms/bonds/run_kernels.hpp"

namespace peristat {

/// Calls visit(pass) with the pass over runs of bonds with a potential.
/// @param largest_stretch history of the bonds, which moves if it is not const
template <int D, class P, class E, class Stretch, class Visit>
void with_pass(const BondWorkspace& a, const RunWindow& window, const P& potential,
               const E& eigenstretch, Stretch* largest_stretch, DamageGrowth& growth,
               const Visit& visit) {
  const auto whole = whole_potential(potential);
  using Pass = RunPass<D, std::remove_const_t<decltype(whole)>, E>;
  if constexpr (PotentialWithHistory<P>) {
    double* changing = nullptr;
    if constexpr (!std::is_const_v<Stretch>) changing = largest_stretch;
    FailingBondsOf<P> failing(potential, a.points, a.bonds, largest_stretch, changing, growth);
    visit(Pass(a.bonds, window.vectors, whole, eigenstretch, &failing));
  } else {
    visit(Pass(a.bonds, window.vectors, whole, eigenstretch, nullptr));
  }
}

/// The passes over the bonds, for one dimension; the potential is chosen once, outside the loops.
/// `largest_stretch` is the bonds' history, padded by a batch; null for a potential without one.
template <int D>
struct BondKernels {
  using Span = std::span<const double>;

  /// @tparam commits updates the histories first: the energy is then what is stored after that
  /// @tparam with_energy false leaves the energy out, which takes a division per bond
  template <bool commits, bool with_energy = true, class P, class E>
  static Evaluation gradient(BondWorkspace& a, const P& potential, const E& eigenstretch,
                             Span displacement,
                             std::conditional_t<commits, double*, const double*> largest_stretch,
                             std::span<double> result, Write how) {
    a.template take<D>({a.points.reference, displacement});
    std::vector<Evaluation>& parts = a.threads.evaluations;
    const Bonds& bonds = a.bonds;
    const bool energy_only = result.empty();
    const Index owned = a.points.owned.value_or(a.points.count());
    constexpr int width = vector_width(D);
    const auto body = [&](int part, RowRange range, double* sums) __attribute__((flatten)) {
      Lanes shortest = std::numeric_limits<double>::infinity();
      double energy = 0.0;
      DamageGrowth growth;
      const auto on_run = [&](const BondRun& run, RunDamage* damage, RunWindow& window) {
        with_pass<D>(a, window, potential, eigenstretch, largest_stretch, growth,
                     [&](const auto& pass) {
                       pass.template add_forces<with_energy>(
                           run, damage, energy_only ? nullptr : &window.sums, energy, shortest);
                     });
      };
      const auto on_loose = [&](const LooseBonds& loose, double* to) {
        const Index i = loose.point;
        const Index whole_below = i < owned ? owned : 0;
        Lanes row_energy = 0.0;
        Vector<D, Lanes> own;
        own.fill(Lanes(0.0));
        for_each_batch<D>(
            bonds, bonds.kind, a.template rows<D>(),
            loose, [&](const Batch<D>& batch) __attribute__((always_inline)) {
              auto measure =
                  Length::at<D, Lanes>(batch.inverse_length, {batch.vector0}, {batch.vector1});
              relieve(measure, eigenstretch, batch);
              if constexpr (commits) {
                commit<D>(a.points, potential, i, batch, measure.relative_change, largest_stretch,
                          growth);
              }
              shortest = min(shortest, measure.current);
              Vector<D, Lanes> force;
              if constexpr (with_energy) {
                const auto psi = interaction_energy(
                    batch.weight, at_history(largest_stretch, potential, batch.first), measure);
                row_energy += batch.partner.back() < whole_below
                                  ? psi.value
                                  : psi.value * share_of_owned(a.points, i, batch.partner);
                if (energy_only) return;
                force = energy_gradient(psi, measure)[0];
              } else {
                force = scaled<D>(batch.weight * tension(largest_stretch, potential, batch.first,
                                                         measure.relative_change),
                                  measure.gradient[0]);
              }
              for (int c = 0; c < D; ++c) own[c] -= force[c];
              add_to_partners<D>(to, batch.partner, force);
            });
        energy += sum(row_energy);
        for (int c = 0; c < D; ++c) to[std::ptrdiff_t(i) * width + c] += sum(own[c]);
      };
      a.sum_range<D, width>(part, range, sums, on_run, on_loose);
      parts[part] = {energy, !(smallest(shortest) > 0.0), growth};
    };
    a.threads.sum_rows<width>(body, [&](Index i, const double* total) {
      if (!energy_only) put<D>(how, total, &result[std::size_t(i) * D]);
    });
    return a.threads.total_evaluation();
  }

  template <class P, class E>
  static DamageGrowth growth(BondWorkspace& a, const P& potential, const E& eigenstretch,
                             Span displacement, const double* largest_stretch) {
    const auto packed = a.template pack<D>({a.points.reference, displacement});
    const auto body = [&](int part, RowRange range, double*) {
      DamageGrowth found;
      for (Index i = range.first; i < range.last; ++i) {
        for_each_batch<D>(a.bonds, a.template rows<D>(), i, [&](const Batch<D>& batch) {
          auto measure =
              Length::at<D, Lanes>(batch.inverse_length, {batch.vector0}, {batch.vector1});
          relieve(measure, eigenstretch, batch);
          look_at<D>(a.points, potential, i, batch, measure.relative_change, largest_stretch,
                     found);
        });
      }
      a.threads.evaluations[part] = {0.0, false, found};
    };
    a.threads.sum_rows<1>(body, [](Index, const double*) {});
    return a.threads.total_evaluation().growth;
  }

  /// Hessians of a batch's bonds; the rows have reference positions and displacements.
  template <class P, class E>
  [[gnu::always_inline]] static Matrix<D, Lanes> block_of(const Batch<D>& batch, const P& potential,
                                                          const E& eigenstretch,
                                                          const double* largest_stretch,
                                                          double projection) {
    auto measure = Length::at<D, Lanes>(batch.inverse_length, {batch.vector0}, {batch.vector1});
    relieve(measure, eigenstretch, batch);
    auto psi = interaction_energy(batch.weight, at_history(largest_stretch, potential, batch.first),
                                  measure);
    if (projection > 0.0) psi = projected(psi, projection);
    return energy_hessian<0, 0>(psi, measure);
  }

  /// @param blocks_of(part, i) where the off-diagonal blocks of row i go
  /// @param done(part, i) called after these are written
  /// @param diagonal blocks; empty: not wanted
  template <Tangent::Blocks stored_as, class P, class E, class BlocksOf, class Done>
  static void tangent(BondWorkspace& a, const P& potential, const E& eigenstretch,
                      Span displacement, const double* largest_stretch, double projection,
                      const BlocksOf& blocks_of, const Done& done, std::span<double> diagonal) {
    const auto packed = a.template pack<D>({a.points.reference, displacement});
    sum_blocks<D, stored_as>(
        a, a.bonds.kind,
        [&](const Batch<D>& batch) __attribute__((always_inline)) {
          return block_of(batch, potential, eigenstretch, largest_stretch, projection);
        },
        blocks_of, done, diagonal);
  }

  /// Diagonal blocks of the tangent, D entries of their upper halves in each pass: these fit into
  /// the sums of forces.
  template <class P, class E>
  static void diagonal(BondWorkspace& a, const P& potential, const E& eigenstretch,
                       Span displacement, const double* largest_stretch, double projection,
                       std::span<double> diagonal) {
    a.template take<D>({a.points.reference, displacement});
    constexpr int width = vector_width(D), all = D * (D + 1) / 2;
    for (int first = 0; first < all; first += D) {
      const auto body = [&](int part, RowRange range, double* sums) {
        DamageGrowth none;
        const auto on_run = [&](const BondRun& run, RunDamage* damage, RunWindow& window) {
          with_pass<D>(a, window, potential, eigenstretch, largest_stretch, none,
                       [&](const auto& pass) {
                         pass.add_diagonals(run, damage, projection, first, window.sums);
                       });
        };
        const auto on_loose = [&](const LooseBonds& loose, double* to) {
          Vector<D, Lanes> own, entries;
          own.fill(Lanes(0.0));
          for_each_batch<D>(
              a.bonds, a.bonds.kind, a.template rows<D>(),
              loose, [&](const Batch<D>& batch) __attribute__((always_inline)) {
                const Matrix<D, Lanes> block =
                    block_of(batch, potential, eigenstretch, largest_stretch, projection);
                for (int k = 0; k < D; ++k) {
                  const auto [r, c] = entries_of_upper_half<D>[std::size_t(first + k)];
                  entries[k] = block[r][c];
                  own[k] += entries[k];
                }
                add_to_partners<D>(to, batch.partner, entries);
              });
          for (int k = 0; k < D; ++k) {
            to[std::ptrdiff_t(loose.point) * width + k] += sum(own[k]);
          }
        };
        a.sum_range<D, width>(part, range, sums, on_run, on_loose);
      };
      a.threads.sum_rows<width>(body, [&](Index i, const double* total) {
        double* const block = &diagonal[std::size_t(i) * D * D];
        for (int k = 0; k < D && first + k < all; ++k) {
          const auto [r, c] = entries_of_upper_half<D>[std::size_t(first + k)];
          block[r * D + c] = block[c * D + r] = total[k];
        }
      });
    }
  }

  template <class P, class E>
  static void product(BondWorkspace& a, const P& potential, const E& eigenstretch,
                      Span displacement, const double* largest_stretch, Span v, double projection,
                      Precision precision, std::span<double> result, Write how) {
    a.template take<D>({displacement, v, a.points.reference});
    const Bonds& bonds = a.bonds;
    constexpr int width = vector_width(D);
    const auto body = [&](int part, RowRange range, double* sums) {
      DamageGrowth none;
      const auto on_run = [&](const BondRun& run, RunDamage* damage, RunWindow& window) {
        with_pass<D>(a, window, potential, eigenstretch, largest_stretch, none,
                     [&](const auto& pass) {
                       pass.add_products(run, damage, projection, precision, window.sums);
                     });
      };
      const auto on_loose = [&](const LooseBonds& loose, double* to) {
        const Index i = loose.point;
        Vector<D, Lanes> own;
        own.fill(Lanes(0.0));
        for_each_batch<D>(
            bonds, bonds.kind, a.template rows<D>(),
            loose, [&](const Batch<D>& batch) __attribute__((always_inline)) {
              auto measure = Length::from_current<D, Lanes>(batch.inverse_length, {batch.vector0});
              relieve(measure, eigenstretch, batch);
              auto psi = interaction_energy(
                  batch.weight, at_history(largest_stretch, potential, batch.first), measure);
              if (projection > 0.0) psi = projected(psi, projection);
              const Vector<D, Lanes> force =
                  energy_hessian_times(psi, measure, Arms<1, D, Lanes>{batch.vector1})[0];
              for (int c = 0; c < D; ++c) own[c] -= force[c];
              add_to_partners<D>(to, batch.partner, force);
            });
        for (int c = 0; c < D; ++c) to[std::ptrdiff_t(i) * width + c] += sum(own[c]);
      };
      a.sum_range<D, width>(part, range, sums, on_run, on_loose);
    };
    a.threads.sum_rows<width>(body, [&](Index i, const double* total) {
      put<D>(how, total, &result[std::size_t(i) * D]);
    });
  }

  template <class P, class E>
  static void point_energies(BondWorkspace& a, const P& potential, const E& eigenstretch,
                             Span displacement, const double* largest_stretch,
                             std::span<double> energies, Write how) {
    const auto packed = a.template pack<D>({a.points.reference, displacement});
    const Bonds& bonds = a.bonds;
    const auto body = [&](int, RowRange range, double* sums) {
      for (Index i = range.first; i < range.last; ++i) {
        Lanes own = 0.0;
        for_each_batch<D>(
            bonds, a.template rows<D>(),
            i, [&](const Batch<D>& batch) __attribute__((always_inline)) {
              auto measure =
                  Length::at<D, Lanes>(batch.inverse_length, {batch.vector0}, {batch.vector1});
              relieve(measure, eigenstretch, batch);
              const Lanes half =
                  0.5 * interaction_energy(batch.weight,
                                           at_history(largest_stretch, potential, batch.first),
                                           measure)
                            .value;
              own += half;
              add_to_partners<1>(sums, batch.partner, Vector<1, Lanes>{half});
            });
        sums[i] += sum(own);
      }
    };
    a.threads.sum_rows<1>(body,
                          [&](Index i, const double* total) { put<1>(how, total, &energies[i]); });
  }

  /// Adds half of every bond's force (x) reference arm to each of its ends, in one pass per
  /// component of the force: its rows then fit into the sums of forces.
  template <class P, class E>
  static void add_virials(BondWorkspace& a, const P& potential, const E& eigenstretch,
                          Span displacement, const double* largest_stretch,
                          std::span<double> virials) {
    const auto packed = a.template pack<D>({a.points.reference, displacement});
    constexpr int width = vector_width(D);
    for (int component = 0; component < D; ++component) {
      const auto body = [&](int, RowRange range, double* sums) {
        for (Index i = range.first; i < range.last; ++i) {
          Vector<D, Lanes> own;
          own.fill(Lanes(0.0));
          for_each_batch<D>(
              a.bonds, a.template rows<D>(),
              i, [&](const Batch<D>& batch) __attribute__((always_inline)) {
                auto measure =
                    Length::at<D, Lanes>(batch.inverse_length, {batch.vector0}, {batch.vector1});
                relieve(measure, eigenstretch, batch);
                const auto psi = interaction_energy(
                    batch.weight, at_history(largest_stretch, potential, batch.first), measure);
                const Lanes half = 0.5 * energy_gradient(psi, measure)[0][component];
                const Vector<D, Lanes> row = scaled<D>(half, batch.vector0);
                for (int c = 0; c < D; ++c) own[c] += row[c];
                add_to_partners<D>(sums, batch.partner, row);
              });
          for (int c = 0; c < D; ++c) sums[std::ptrdiff_t(i) * width + c] += sum(own[c]);
        }
      };
      a.threads.sum_rows<width>(body, [&](Index i, const double* total) {
        put<D>(Write::onto, total, &virials[std::size_t(i) * D * D + std::size_t(component) * D]);
      });
    }
  }
};

}  // namespace peristat
