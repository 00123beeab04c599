#pragma once

#include <array>
#include <type_traits>

#include "assembly/terms/bonds/point_columns.hpp"
#include "src/core/lanes.hpp"
#include "src/measures/small_algebra.hpp"
#include "src/neighbourhood/bond_runs.hpp"

namespace peristat {

/// Consecutive bonds of a run, side by side in the lanes of L.
template <class L>
struct RunBatchOf {
  Index first;  ///< number of lane 0 in the run
  int count;    ///< lanes past it belong to no bond

  [[nodiscard]] std::size_t number() const { return std::size_t(first) / L::count; }
};

using RunBatch = RunBatchOf<Lanes>;

/// Numbers in a row, rounded to the precision of L.
template <class L>
[[nodiscard, gnu::always_inline]] inline L lanes_from(const double* from) {
  if constexpr (std::is_same_v<L, Lanes>) {
    return Lanes(from);
  } else {
    return rounded(Lanes(from), Lanes(from + lane_count));
  }
}

/// The same for differences, which are rounded last.
template <class L>
[[nodiscard, gnu::always_inline]] inline L difference_of(const double* of, const double* from) {
  if constexpr (std::is_same_v<L, Lanes>) {
    return Lanes(of) - Lanes(from);
  } else {
    return rounded(Lanes(of) - Lanes(from), Lanes(of + lane_count) - Lanes(from + lane_count));
  }
}

/// Values of points that the bonds of a batch have at their ends, added; 0 in lanes past them.
template <class L>
[[gnu::always_inline]] inline L sum_of_ends(const double* of_point, const BondRun& run,
                                            const RunBatchOf<L>& batch) {
  const double* const own = of_point + (run.first + batch.first);
  if (batch.count == L::count) return lanes_from<L>(own) + lanes_from<L>(own + run.ahead);
  return L([&](int l) { return l < batch.count ? own[l] + own[l + run.ahead] : 0.0; });
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
template <class L>
using RunRowOf = std::array<L, (BondRuns::longest + L::count - 1) / L::count>;

using RunRow = RunRowOf<Lanes>;

template <class L = Lanes, class Visit>
[[gnu::always_inline]] inline void for_each_batch(const BondRun& run, const Visit& visit) {
  Index first = 0;
  for (; first + L::count <= run.points; first += L::count) visit(RunBatchOf<L>{first, L::count});
  if (first < run.points) visit(RunBatchOf<L>{first, run.points - first});
}

/// The kind of all bonds of a run. Their energy has a common weight, which is applied to the sum.
template <class L>
struct OneKind {
  L inverse_length, weight, length;

  [[nodiscard, gnu::always_inline]] const OneKind& of(const RunBatchOf<L>& /*batch*/) const {
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
template <class L>
struct SeveralKinds {
  const std::uint16_t* numbers;
  const BondKind* table;
  double modulus;  ///< that the weights are multiplied by, in single precision

  [[nodiscard, gnu::always_inline]] OneKind<L> of(const RunBatchOf<L>& batch) const {
    OneKind<L> result;
    if constexpr (std::is_same_v<L, Lanes>) {
      read(batch.first, result.inverse_length, result.weight);
    } else {
      Lanes inverse_lengths[2], weights[2];
      for (int h = 0; h < 2; ++h) {
        read(batch.first + h * lane_count, inverse_lengths[h], weights[h]);
      }
      result.inverse_length = rounded(inverse_lengths[0], inverse_lengths[1]);
      result.weight = rounded(modulus * weights[0], modulus * weights[1]);
    }
    result.length = 1.0 / result.inverse_length;
    return result;
  }
  [[nodiscard, gnu::always_inline]] double common_energy_weight() const { return 1.0; }
  [[nodiscard, gnu::always_inline]] L energy_weight(const OneKind<L>& kind) const {
    return kind.weight * kind.length;
  }

 private:
  [[gnu::always_inline]] void read(Index first, Lanes& inverse_length, Lanes& weight) const {
    const std::uint16_t* const number = numbers + first;
    std::array<const double*, lane_count> kind;
#pragma GCC unroll 4
    for (int l = 0; l < lane_count; ++l) kind[l] = &table[number[l]].inverse_length;
    load_transposed_pairs(kind, inverse_length, weight);
  }
};

/// Calls visit(OneKind or SeveralKinds) with those of a run. Each has its own loops, which choose
/// nothing.
/// @param modulus that weights in single precision are multiplied by: the range of single precision
///        holds neither products of small volumes nor the modulus of a small horizon
template <class L = Lanes, class Visit>
[[gnu::always_inline]] inline void with_kinds(const Bonds& bonds, const BondKinds& kinds,
                                              const BondRun& run, const Visit& visit,
                                              double modulus = 1.0) {
  if (run.kinds) {
    visit(SeveralKinds<L>{run.kinds, kinds.table(), modulus});
  } else {
    const BondKind& all = kinds[run.first_bond(bonds)];
    const double weight = std::is_same_v<L, Lanes> ? all.weight : modulus * all.weight;
    visit(OneKind<L>{all.inverse_length, weight, 1.0 / all.inverse_length});
  }
}

/// The lanes of a batch; `none` past them.
template <class L>
[[nodiscard, gnu::always_inline]] inline L within(const RunBatchOf<L>& batch, const L& lanes,
                                                  double none) {
  if (batch.count == L::count) return lanes;
  return chosen(L([](int l) { return l; }) < L(batch.count), lanes, none);
}

/// Vectors of a batch's partners minus those of its points.
/// @param component of the columns, the first one of the vectors
template <int D, class L>
[[nodiscard, gnu::always_inline]] inline Vector<D, L> difference(const PointColumns& columns,
                                                                 int component, const BondRun& run,
                                                                 const RunBatchOf<L>& batch) {
  Vector<D, L> result;
  for (int c = 0; c < D; ++c) {
    const double* const own = columns[component + c] + (run.first + batch.first);
    result[c] = difference_of<L>(own + run.ahead, own);
  }
  return result;
}

/// Adds numbers in a row to others, or subtracts them.
template <int sign>
[[gnu::always_inline]] inline void add_lanes(double* to, const Lanes& value) {
  (sign > 0 ? Lanes(to) + value : Lanes(to) - value).copy_to(to);
}
template <int sign>
[[gnu::always_inline]] inline void add_lanes(double* to, const SingleLanes& value) {
  add_lanes<sign>(to, half_of<0>(value));
  add_lanes<sign>(to + lane_count, half_of<1>(value));
}

/// Adds part(column, batch's number) to the partners of a run's bonds and, times `sign`, to their
/// points.
/// @tparam L of the parts
template <int width, int sign, class L = Lanes, class Part>
[[gnu::always_inline]] inline void add_to_ends(const BondRun& run, PointColumns& sums,
                                               const Part& part) {
  const auto add_at = [&]<int times>(Index ahead) __attribute__((always_inline)) {
    for_each_batch<L>(
        run, [&](const RunBatchOf<L>& batch) __attribute__((always_inline)) {
          for (int c = 0; c < width; ++c) {
            add_lanes<times>(sums[c] + (run.first + batch.first + ahead), part(c, batch.number()));
          }
        });
  };
  // A load that overlaps a store of just before waits for it.
  constexpr Index close = 4 * L::count;
  if (run.ahead < close) {
    add_at.template operator()<sign>(0);
    add_at.template operator()<1>(run.ahead);
    return;
  }
  for_each_batch<L>(
      run, [&](const RunBatchOf<L>& batch) __attribute__((always_inline)) {
        for (int c = 0; c < width; ++c) {
          double* const own = sums[c] + (run.first + batch.first);
          const L value = part(c, batch.number());
          add_lanes<sign>(own, value);
          add_lanes<1>(own + run.ahead, value);
        }
      });
}

}  // namespace peristat
