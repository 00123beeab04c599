#pragma once

#include <array>

#include "assembly/terms/bonds/bond_batches.hpp"
#include "assembly/terms/bonds/bond_workspace.hpp"
#include "assembly/terms/bonds/run_batches.hpp"
#include "assembly/terms/bonds/run_damage.hpp"

namespace peristat {

/// Sums parts of bonds at their partners and, times `sign`, at their points, along runs where there
/// are any; the workspace has packed two vectors per point.
/// @param kinds the bonds' weights
/// @param part_of(batch, damage, part) `width` numbers of the bonds of a Batch<D>, without
///        damage, or of RunBonds<D>, with that of their run
/// @param done(point, total) called in the end
template <int D, int width, int sign, class PartOf, class Done>
void sum_bonds(BondWorkspace& a, const BondKinds& kinds, const PartOf& part_of, const Done& done) {
  constexpr int stride = vector_width(width);
  const auto body = [&](int part, RowRange range, double* all) __attribute__((flatten)) {
    const auto on_run = [&](const BondRun& run, const RunDamage* damage, RunWindow& window) {
      std::array<RunRow, width> parts;
      with_kinds(
          a.bonds, kinds, run, [&](const auto& kinds_of_run) __attribute__((always_inline)) {
            for_each_batch(
                run, [&](const RunBatch& batch) __attribute__((always_inline)) {
                  const OneKind<Lanes> kind = kinds_of_run.of(batch);
                  const RunBonds<D> bonds{batch,
                                          run,
                                          kind.weight,
                                          kind.length,
                                          kind.inverse_length,
                                          difference<D>(window.vectors, 0, run, batch),
                                          difference<D>(window.vectors, D, run, batch)};
                  const Vector<width, Lanes> numbers = part_of(bonds, damage, part);
                  for (int c = 0; c < width; ++c) {
                    parts[std::size_t(c)][batch.number()] = within(batch, numbers[c], 0.0);
                  }
                });
          });
      add_to_ends<width, sign>(
          run, window.sums, [&](int c, std::size_t b) __attribute__((always_inline)) {
            return parts[std::size_t(c)][b];
          });
    };
    const auto on_loose = [&](const LooseBonds& loose, double* sums) {
      Vector<width, Lanes> own;
      own.fill(Lanes(0.0));
      for_each_batch<D>(
          a.bonds, kinds, a.template rows<D>(),
          loose, [&](const Batch<D>& batch) __attribute__((always_inline)) {
            const RunDamage* const none = nullptr;
            const Vector<width, Lanes> numbers = part_of(batch, none, part);
            for (int c = 0; c < width; ++c) own[c] += numbers[c];
            add_to_partners<width>(sums, batch.partner, numbers);
          });
      double* const total = sums + std::ptrdiff_t(loose.point) * stride;
      for (int c = 0; c < width; ++c) total[c] += sign * sum(own[c]);
    };
    a.template sum_range<D, stride, width>(part, range, all, on_run, on_loose);
  };
  a.threads.template sum_rows<stride>(body, done);
}

}  // namespace peristat
