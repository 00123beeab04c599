#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>

#include "assembly/operators/tangent.hpp"
#include "assembly/terms/bonds/bond_workspace.hpp"
#include "assembly/terms/interaction.hpp"
#include "assembly/terms/term.hpp"
#include "src/core/lanes.hpp"
#include "src/geometry/counts_bond.hpp"
#include "src/measures/length.hpp"
#include "src/potentials/potential.hpp"

namespace peristat {

/// Up to lane_count bonds of one row, side by side. Lanes past `count` repeat the last bond with
/// weight zero, so that they add nothing.
template <int D>
struct Batch {
  Index point;
  Offset first;
  int count;
  std::array<Index, lane_count> partner;
  Lanes weight, inverse_length;
  Vector<D, Lanes> vector0, vector1;  // partner's minus the row's own gathered vectors
};

/// Calls visit(batch) for some bonds of a row, with the weights of these kinds.
template <int D, class Visit>
[[gnu::always_inline]] inline void for_each_batch(const Bonds& bonds, const BondKinds& kinds,
                                                  const PointRows<D>& rows, const LooseBonds& of,
                                                  const Visit& visit) {
  constexpr int width = row_width(D);
  std::array<typename PointRows<D>::Scratch, lane_count + 1> scratch;
  const double* const own = rows.of(of.point, scratch[lane_count]);
  Batch<D> batch;
  batch.point = of.point;
  for (Offset first = of.first; first < of.last; first += lane_count) {
    batch.first = first;
    batch.count = static_cast<int>(std::min<Offset>(lane_count, of.last - first));
    std::array<Offset, lane_count> bond;
    if (batch.count == lane_count) {
#pragma GCC unroll 4
      for (int l = 0; l < lane_count; ++l) bond[l] = first + l;
    } else {
#pragma GCC unroll 4
      for (int l = 0; l < lane_count; ++l) bond[l] = first + std::min(l, batch.count - 1);
    }
    std::array<const double*, lane_count> kind;
#pragma GCC unroll 4
    for (int l = 0; l < lane_count; ++l) {
      batch.partner[l] = bonds.partner(of.point, bond[l]);
      kind[l] = &kinds[bond[l]].inverse_length;
    }
    load_transposed_pairs(kind, batch.inverse_length, batch.weight);
    if (batch.count < lane_count) {
      batch.weight = Lanes([&](int l) { return l < batch.count ? batch.weight[l] : 0.0; });
    }
    std::array<const double*, lane_count> row;
#pragma GCC unroll 4
    for (int l = 0; l < lane_count; ++l) row[l] = rows.of(batch.partner[l], scratch[l]);
    Lanes columns[8];
    load_transposed(row[0], row[1], row[2], row[3], columns);
    if constexpr (D == 3) {
      load_transposed(row[0] + 4, row[1] + 4, row[2] + 4, row[3] + 4, columns + 4);
    }
    for (int c = 0; c < D; ++c) {
      batch.vector0[c] = columns[c] - own[c];
      batch.vector1[c] = columns[width / 2 + c] - own[width / 2 + c];
    }
    visit(batch);
  }
}

/// The same for all bonds of row i.
template <int D, class Visit>
[[gnu::always_inline]] inline void for_each_batch(const Bonds& bonds, const BondKinds& kinds,
                                                  const PointRows<D>& rows, Index i,
                                                  const Visit& visit) {
  for_each_batch<D>(bonds, kinds, rows, LooseBonds{i, bonds.offset[i], bonds.offset[i + 1]}, visit);
}
template <int D, class Visit>
[[gnu::always_inline]] inline void for_each_batch(const Bonds& bonds, const PointRows<D>& rows,
                                                  Index i, const Visit& visit) {
  for_each_batch<D>(bonds, bonds.kind, rows, i, visit);
}

/// Adds lane l of a vector to the sum of partner l.
template <int D>
inline void add_to_partners(double* sums, const std::array<Index, lane_count>& partner,
                            const Vector<D, Lanes>& vector) {
  if constexpr (D == 3) {
    lanes_detail::Quad rows[4];
    store_transposed(vector[0], vector[1], vector[2], Lanes(0.0), rows);
#pragma GCC unroll 4
    for (int l = 0; l < lane_count; ++l) add_row(sums + std::ptrdiff_t(partner[l]) * 4, rows[l]);
  } else if constexpr (D == 2) {
    lanes_detail::Pair pairs[4];
    store_transposed(vector[0], vector[1], pairs);
#pragma GCC unroll 4
    for (int l = 0; l < lane_count; ++l) add_row(sums + std::ptrdiff_t(partner[l]) * 2, pairs[l]);
  } else {
#pragma GCC unroll 4
    for (int l = 0; l < lane_count; ++l) sums[partner[l]] += vector[0][l];
  }
}

/// Upper half of a symmetric block as the lanes that are stored: xx xy yy, or xx xy xz yy yz zz.
template <int D>
inline std::array<Lanes, block_width(D)> upper_half(const Matrix<D, Lanes>& block) {
  std::array<Lanes, block_width(D)> half;
  half.fill(Lanes(0.0));
  int k = 0;
  for (int r = 0; r < D; ++r) {
    for (int c = r; c < D; ++c) half[k++] = block[r][c];
  }
  return half;
}

template <int D>
inline void add_to_partners(double* sums, const std::array<Index, lane_count>& partner,
                            const std::array<Lanes, block_width(D)>& half) {
  constexpr int width = block_width(D);
  lanes_detail::Quad head[4];
  store_transposed(half[0], half[1], half[2], half[3], head);
#pragma GCC unroll 4
  for (int l = 0; l < lane_count; ++l) {
    add_row(sums + std::ptrdiff_t(partner[l]) * width, head[l]);
  }
  if constexpr (D == 3) {
    lanes_detail::Pair tail[4];
    store_transposed(half[4], half[5], tail);
#pragma GCC unroll 4
    for (int l = 0; l < lane_count; ++l) {
      add_row(sums + std::ptrdiff_t(partner[l]) * width + 4, tail[l]);
    }
  }
}

/// Writes minus the block of lane l to the off-diagonal block of bond l.
template <int D>
inline void store_blocks(double* blocks, int count, const Matrix<D, Lanes>& block) {
  if constexpr (D == 1) {
    for (int l = 0; l < count; ++l) blocks[l] = -block[0][0][l];
  } else if constexpr (D == 2) {
    lanes_detail::Quad rows[4];
    store_transposed(-block[0][0], -block[0][1], -block[1][0], -block[1][1], rows);
    for (int l = 0; l < count; ++l) store_row(blocks + l * 4, rows[l]);
  } else {
    lanes_detail::Quad head[4], tail[4];
    store_transposed(-block[0][0], -block[0][1], -block[0][2], -block[1][0], head);
    store_transposed(-block[1][1], -block[1][2], -block[2][0], -block[2][1], tail);
    const Lanes last = -block[2][2];
    for (int l = 0; l < count; ++l) {
      store_row(blocks + l * 9, head[l]);
      store_row(blocks + l * 9 + 4, tail[l]);
      blocks[l * 9 + 8] = last[l];
    }
  }
}

/// Writes minus the upper half of the block of lane l for bond l.
template <int D>
inline void store_upper_halves(double* blocks, int count,
                               const std::array<Lanes, block_width(D)>& half) {
  if constexpr (D == 1) {
    for (int l = 0; l < count; ++l) blocks[l] = -half[0][l];
  } else {
    lanes_detail::Quad head[4];
    store_transposed(-half[0], -half[1], -half[2], -half[3], head);
    if constexpr (D == 2) {
      for (int l = 0; l < count; ++l) std::memcpy(blocks + l * 3, &head[l], 3 * sizeof(double));
    } else {
      lanes_detail::Pair tail[4];
      store_transposed(-half[4], -half[5], tail);
      for (int l = 0; l < count; ++l) {
        store_row(blocks + l * 6, head[l]);
        std::memcpy(blocks + l * 6 + 4, &tail[l], sizeof tail[l]);
      }
    }
  }
}

/// Rows and columns of the entries of the upper half of a block, in their order.
struct BlockEntry {
  int row, column;
};
template <int D>
constexpr std::array<BlockEntry, 6> entries_of_upper_half =
    D == 3 ? std::array<BlockEntry, 6>{{{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}}
           : std::array<BlockEntry, 6>{{{0, 0}, {0, 1}, {1, 1}}};

/// Sums the blocks of bonds row by row.
/// @param block_of(batch) of the bonds of a batch between their points, of packed rows
/// @param blocks_of(part, i) where minus the blocks of row i are written
/// @param done(part, i) called once they are
/// @param diagonal blocks of points, overwritten; empty: not wanted
template <int D, Tangent::Blocks stored_as, class BlockOf, class BlocksOf, class Done>
void sum_blocks(BondWorkspace& a, const BondKinds& kinds, const BlockOf& block_of,
                const BlocksOf& blocks_of, const Done& done, std::span<double> diagonal) {
  const Bonds& bonds = a.bonds;
  constexpr int width = block_width(D);
  const auto body = [&](int part, RowRange range, double* sums) {
    for (Index i = range.first; i < range.last; ++i) {
      double* const blocks = blocks_of(part, i);
      std::array<Lanes, width> own;
      own.fill(Lanes(0.0));
      for_each_batch<D>(
          bonds, kinds, a.template rows<D>(),
          i, [&](const Batch<D>& batch) __attribute__((always_inline)) {
            const Matrix<D, Lanes> block = block_of(batch);
            const auto half = upper_half<D>(block);
            const std::ptrdiff_t place = batch.first - bonds.offset[i];
            if constexpr (stored_as == Tangent::Blocks::whole) {
              store_blocks<D>(blocks + place * D * D, batch.count, block);
            } else {
              store_upper_halves<D>(blocks + place * (D * (D + 1) / 2), batch.count, half);
            }
            if (!sums) return;
            for (int c = 0; c < width; ++c) own[c] += half[c];
            add_to_partners<D>(sums, batch.partner, half);
          });
      for (int c = 0; sums && c < D * (D + 1) / 2; ++c) {
        sums[std::ptrdiff_t(i) * width + c] += sum(own[c]);
      }
      done(part, i);
    }
  };
  if (diagonal.empty()) {
    run_on_parts(a.threads.threads(), a.threads.parts(),
                 [&](int part) { body(part, a.threads.ranges[part], nullptr); });
    return;
  }
  a.threads.template sum_rows<width>(body, [&](Index i, const double* total) {
    double* block = &diagonal[std::size_t(i) * D * D];
    int k = 0;
    for (int r = 0; r < D; ++r) {
      for (int c = r; c < D; ++c) block[r * D + c] = block[c * D + r] = total[k++];
    }
  });
}

/// Calls compute(blocks_of, done) for sum_blocks with room for one row per part, and visits each
/// row when it is done.
template <int D, class Compute>
void visit_rows(const BondWorkspace& a, const RowVisitor& visit, const Compute& compute) {
  const std::vector<Offset>& offset = a.bonds.offset;
  Offset longest = 0;
  for (std::size_t i = 1; i < offset.size(); ++i) {
    longest = std::max(longest, offset[i] - offset[i - 1]);
  }
  constexpr std::size_t entries = D * D;
  std::vector<std::vector<double>> rows(std::size_t(a.threads.parts()),
                                        std::vector<double>(std::size_t(longest) * entries));
  compute([&](int part, Index) { return rows[std::size_t(part)].data(); },
          [&](int part, Index i) {
            const auto bonds = std::size_t(offset[i + 1] - offset[i]);
            visit(part, i, std::span(rows[std::size_t(part)]).first(bonds * entries));
          });
}

/// Stress-free stretch of each bond: the mean of its points' eigenstretches.
struct Eigenstretch {
  const double* of_point;
};
struct NoEigenstretch {};

/// The lanes of a batch: those past its bonds repeat the last of them.
template <int D>
[[gnu::always_inline]] inline Lanes within(const Batch<D>&, const Lanes& lanes, double) {
  return lanes;
}

template <int D>
[[gnu::always_inline]] inline Lanes lengths_of(const Batch<D>& batch) {
  return 1.0 / batch.inverse_length;
}

/// Values of points that bonds have at their ends, added.
template <int D>
[[gnu::always_inline]] inline Lanes sum_of_ends(const double* of_point, const Batch<D>& batch) {
  const double own = of_point[batch.point];
  return Lanes([&](int l) { return own + of_point[batch.partner[l]]; });
}

/// Subtracts the stress-free stretches of a batch of bonds.
template <class E, class MeasureAt, class AnyBatch>
[[gnu::always_inline]] inline void relieve(MeasureAt& measure, const E& eigenstretch,
                                           const AnyBatch& batch) {
  if constexpr (std::is_same_v<E, Eigenstretch>) {
    measure.relative_change -= 0.5 * sum_of_ends(eigenstretch.of_point, batch);
  }
}

/// A potential evaluated at the histories of a batch of bonds.
template <class P>
struct AtHistory {
  const P& potential;
  Lanes largest_stretch;
  Offset first_bond;
  [[nodiscard, gnu::always_inline]] PotentialDensity<Lanes> operator()(const Lanes& e) const {
    return potential(e, largest_stretch, first_bond);
  }
};

/// The potential as a function of the stretch alone: at the bonds' histories, if it has one.
template <class P>
[[gnu::always_inline]] inline auto at_history(const double* largest_stretch, const P& potential,
                                              Offset first_bond) {
  if constexpr (PotentialWithHistory<P>) {
    return AtHistory<P>{potential, Lanes(largest_stretch + first_bond), first_bond};
  } else {
    return potential;
  }
}

/// The potential of undamaged bonds.
template <class P>
auto whole_potential(const P& potential) {
  if constexpr (PotentialWithHistory<P>) {
    auto whole = potential.shape;
    whole.modulus = potential.modulus;
    return whole;
  } else {
    return potential;
  }
}

/// The potential's first derivative alone, at the bonds' histories if it has one. The result of
/// at_history passes through memory, which takes as long as the rest of a pass.
template <class P>
[[gnu::always_inline]] inline Lanes tension(const double* largest_stretch, const P& potential,
                                            Offset first_bond, const Lanes& e) {
  if constexpr (PotentialWithHistory<P>) {
    const Lanes largest(largest_stretch + first_bond);
    const auto range = potential.ranges(first_bond);
    const auto broken = largest >= range.critical;
    const auto degraded = max(e, largest) > range.onset;
    if (any_of(degraded && !broken)) {
      return Lanes([&](int l) {
        return potential.of_bond(first_bond + l)(double(e[l]), double(largest[l])).first;
      });
    }
    Lanes first = whole_potential(potential)(e).first;
    first = chosen(broken, 0.0, first);
    return first;
  } else {
    return potential(e).first;
  }
}

/// Moves the history of the bond i-j to its stretch if that damages it.
template <class P>
inline void commit_bond(const Points& points, const P& of_bond, Index i, Index j, double stretch,
                        double& largest_stretch, DamageGrowth& growth) {
  if (!of_bond.is_loading(stretch, largest_stretch)) return;
  largest_stretch = stretch;
  if (!counts_bond(points, i, j)) return;
  ++growth.degrading;
  growth.breaking += of_bond.is_broken(stretch);
}

/// Moves the histories of a batch of row i to its stretches where these damage the bonds.
template <int D, class P>
inline void commit(const Points& points, const P& potential, Index i, const Batch<D>& batch,
                   const Lanes& stretch, double* largest_stretch, DamageGrowth& growth) {
  const Lanes before(largest_stretch + batch.first);
  const auto range = potential.ranges(batch.first);
  const auto may_grow = stretch > range.onset && before < range.critical;
  if (none_of(may_grow)) return;
  for (int l = 0; l < batch.count; ++l) {
    commit_bond(points, potential.of_bond(batch.first + l), i, batch.partner[l], stretch[l],
                largest_stretch[batch.first + l], growth);
  }
}

/// Damage that committing a batch of row i would cause.
template <int D, class P>
inline void look_at(const Points& points, const P& potential, Index i, const Batch<D>& batch,
                    const Lanes& stretch, const double* largest_stretch, DamageGrowth& growth) {
  const auto range = potential.ranges(batch.first);
  if (none_of(stretch > std::min(growth.utilisation, 1.0) * range.onset)) return;
  for (int l = 0; l < batch.count; ++l) {
    const double before = largest_stretch[batch.first + l], s = stretch[l];
    const auto& of_bond = potential.of_bond(batch.first + l);
    growth.utilisation = std::max(growth.utilisation, of_bond.utilisation(s, before));
    if (!of_bond.is_loading(s, before) || !counts_bond(points, i, batch.partner[l])) continue;
    ++growth.degrading;
    growth.breaking += of_bond.is_broken(s);
  }
}

/// Share of each bond between row i and these partners that this rank counts: half per owned end.
inline Lanes share_of_owned(const Points& points, Index i,
                            const std::array<Index, lane_count>& partner) {
  const double own = points.owns(i) ? 0.5 : 0.0;
  return Lanes([&](int l) { return own + (points.owns(partner[l]) ? 0.5 : 0.0); });
}

/// A bond's Hessian psi'' n n^T + psi'/l (I - n n^T) moved by a share towards its positive
/// semidefinite part: its eigenvalues are psi'' and psi'/l.
template <class Real>
InteractionEnergy<Real> projected(const InteractionEnergy<Real>& psi, double share) {
  const Real zero = 0.0;
  return {psi.value, psi.first - share * min(psi.first, zero),
          psi.second - share * min(psi.second, zero)};
}

/// Writes a row's total over what is there, or adds it.
template <int width>
inline void put(Write how, const double* total, double* to) {
  for (int c = 0; c < width; ++c) to[c] = how == Write::over ? total[c] : to[c] + total[c];
}

}  // namespace peristat
