#pragma once

#include <array>

#include "assembly/terms/bonds/point_columns.hpp"
#include "src/core/lanes.hpp"
#include "src/measures/small_algebra.hpp"
#include "src/neighbourhood/bond_runs.hpp"

namespace peristat {

/// Consecutive bonds of a run, side by side.
struct RunBatch {
  Index first;  ///< number of lane 0 in the run
  int count;    ///< lanes past it belong to no bond

  [[nodiscard]] std::size_t number() const { return std::size_t(first) / lane_count; }
};

/// Values of points that the bonds of a batch have at their ends, added; 0 in lanes past them.
[[gnu::always_inline]] inline Lanes sum_of_ends(const double* of_point, const BondRun& run,
                                                const RunBatch& batch) {
  const double* const own = of_point + (run.first + batch.first);
  if (batch.count == lane_count) return Lanes(own) + Lanes(own + run.ahead);
  return Lanes([&](int l) { return l < batch.count ? own[l] + own[l + run.ahead] : 0.0; });
}

/// A batch of a run with its kinds and vectors, as Batch is for bonds of one point.
template <int D>
struct RunBonds : RunBatch {
  const BondRun& run;
  Lanes weight, length, inverse_length;
  Vector<D, Lanes> vector0, vector1;
};

template <int D>
[[gnu::always_inline]] inline Lanes sum_of_ends(const double* of_point, const RunBonds<D>& bonds) {
  return sum_of_ends(of_point, bonds.run, bonds);
}

template <int D>
[[gnu::always_inline]] inline const Lanes& lengths_of(const RunBonds<D>& bonds) {
  return bonds.length;
}

/// A number of each bond of a run, by batches.
using RunRow = std::array<Lanes, (BondRuns::longest + lane_count - 1) / lane_count>;

template <class Visit>
[[gnu::always_inline]] inline void for_each_batch(const BondRun& run, const Visit& visit) {
  Index first = 0;
  for (; first + lane_count <= run.points; first += lane_count) visit(RunBatch{first, lane_count});
  if (first < run.points) visit(RunBatch{first, run.points - first});
}

/// The kind of all bonds of a run. Their energy has a common weight, which is applied to the sum.
struct OneKind {
  Lanes inverse_length, weight, length;

  [[nodiscard, gnu::always_inline]] const OneKind& of(const RunBatch& /*batch*/) const {
    return *this;
  }
  [[nodiscard, gnu::always_inline]] double common_energy_weight() const {
    return weight[0] * length[0];
  }
  [[nodiscard, gnu::always_inline]] double energy_weight(const OneKind& /*kind*/) const {
    return 1.0;
  }
};

/// The kinds of a run's bonds where they differ.
struct SeveralKinds {
  const std::uint16_t* numbers;
  const BondKind* table;

  [[nodiscard, gnu::always_inline]] OneKind of(const RunBatch& batch) const {
    const std::uint16_t* const number = numbers + batch.first;
    std::array<const double*, lane_count> kind;
#pragma GCC unroll 4
    for (int l = 0; l < lane_count; ++l) kind[l] = &table[number[l]].inverse_length;
    OneKind result;
    load_transposed_pairs(kind, result.inverse_length, result.weight);
    result.length = 1.0 / result.inverse_length;
    return result;
  }
  [[nodiscard, gnu::always_inline]] double common_energy_weight() const { return 1.0; }
  [[nodiscard, gnu::always_inline]] Lanes energy_weight(const OneKind& kind) const {
    return kind.weight * kind.length;
  }
};

/// Calls visit(OneKind or SeveralKinds) with those of a run. Each has its own loops, which choose
/// nothing.
template <class Visit>
[[gnu::always_inline]] inline void with_kinds(const Bonds& bonds, const BondKinds& kinds,
                                              const BondRun& run, const Visit& visit) {
  if (run.kinds) {
    visit(SeveralKinds{run.kinds, kinds.table()});
  } else {
    const BondKind& all = kinds[run.first_bond(bonds)];
    visit(OneKind{all.inverse_length, all.weight, 1.0 / all.inverse_length});
  }
}

/// The lanes of a batch; `none` past them.
[[nodiscard, gnu::always_inline]] inline Lanes within(const RunBatch& batch, const Lanes& lanes,
                                                      double none) {
  if (batch.count == lane_count) return lanes;
  return chosen(mask_of((1u << batch.count) - 1), lanes, none);
}

/// Vectors of a batch's partners minus those of its points.
/// @param component of the columns, the first one of the vectors
template <int D>
[[nodiscard, gnu::always_inline]] inline Vector<D, Lanes> difference(const PointColumns& columns,
                                                                     int component,
                                                                     const BondRun& run,
                                                                     const RunBatch& batch) {
  Vector<D, Lanes> result;
  for (int c = 0; c < D; ++c) {
    const double* const own = columns[component + c] + (run.first + batch.first);
    result[c] = Lanes(own + run.ahead) - Lanes(own);
  }
  return result;
}

/// Adds part(column, batch's number) to the partners of a run's bonds and, times `sign`, to their
/// points.
template <int width, int sign, class Part>
[[gnu::always_inline]] inline void add_to_ends(const BondRun& run, PointColumns& sums,
                                               const Part& part) {
  const auto add = [](double* to, int times, const Lanes& value) {
    (times > 0 ? Lanes(to) + value : Lanes(to) - value).copy_to(to);
  };
  const auto add_at = [&](Index ahead, int times) __attribute__((always_inline)) {
    for_each_batch(
        run, [&](const RunBatch& batch) __attribute__((always_inline)) {
          for (int c = 0; c < width; ++c) {
            add(sums[c] + (run.first + batch.first + ahead), times, part(c, batch.number()));
          }
        });
  };
  // A load that overlaps a store of just before waits for it.
  constexpr Index close = 4 * lane_count;
  if (run.ahead < close) {
    add_at(0, sign);
    add_at(run.ahead, 1);
    return;
  }
  for_each_batch(
      run, [&](const RunBatch& batch) __attribute__((always_inline)) {
        for (int c = 0; c < width; ++c) {
          double* const own = sums[c] + (run.first + batch.first);
          const Lanes value = part(c, batch.number());
          add(own, sign, value);
          add(own + run.ahead, 1, value);
        }
      });
}

}  // namespace peristat
