#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "src/core/lanes.hpp"
#include "src/measures/area.hpp"
#include "src/measures/volume.hpp"
#include "src/neighbourhood/flatness.hpp"
#include "src/neighbourhood/local_neighbourhood.hpp"
#include "src/neighbourhood/point_kinds.hpp"
#include "src/neighbourhood/side_influence.hpp"

namespace peristat {

/// Four consecutive partners of a point, each of which may complete an interaction.
struct InteractionBlock {
  double inverse_reference[lane_count];  ///< 1/M, signed as the measure is; 1 in empty lanes
  /// w times the flatness factor [m9 or m12], negative where M is, so that w M > 0; 0 if empty
  double weight[lane_count];
  std::int32_t first;    ///< local number of the first
  std::uint32_t active;  ///< bit l: lane l holds an interaction
};

/// Interactions of a point that share all of their points but the last.
template <int Fixed>
struct InteractionGroup {
  std::array<std::int32_t, Fixed> partners;  ///< local numbers, ascending
  std::span<const InteractionBlock> blocks;  ///< of the last point, above all partners
};

/// Scratch memory for the interactions found at one point.
struct InteractionScratch {
  explicit InteractionScratch(int most_partners)
      : of_partners(most_partners), blocks(std::size_t(block_count(most_partners))) {}
  LocalVectors<2> of_partners;  ///< shares of weight and cell measure
  std::vector<InteractionBlock> blocks;
};

/// Unique triangles (Measure = Area) or tetrahedra (Volume) of a body: points with all mutual
/// distances within the horizon ([CPD] sec. 3.1 after eqs. 32 and 34), unless they are flat: each
/// is weighted by its flatness_factor. Each is visited once, at its lowest point, with its other
/// points in ascending order. Interactions of images alone belong to others.
///
/// They are found again at every visit from the bond graph or, once stored, read back: 72 bytes for
/// a block of up to four.
template <class Measure>
class Interactions {
 public:
  static constexpr int fixed = Measure::arms - 1;
  using Group = InteractionGroup<fixed>;

  /// Counts the interactions.
  /// @param cross_section thickness in 2D [m], 1 in 3D
  Interactions(const Points& points, const Bonds& bonds, double cross_section, int threads);

  [[nodiscard]] Offset count() const { return count_; }

  /// Interactions that each point takes part in.
  [[nodiscard]] const std::vector<std::int32_t>& per_point() const { return per_point_; }

  /// Sum of the flatness factors of each point's interactions: their number on a lattice, and a
  /// continuous function of the points' positions everywhere.
  [[nodiscard]] const std::vector<double>& effective_counts() const { return effective_counts_; }

  /// An interaction's weight is the sum of its points' shares [m9 or m12] times its flatness
  /// factor. Until shares are set it is the factor alone.
  void set_shares(std::vector<double> shares) { shares_ = std::move(shares); }
  /// Multiplies the weights by the product of influences of the sides, see influence_of_sides.
  void set_influence(const Kernel& kernel) { kernel_ = kernel; }
  /// Further factors of the weights, by the kinds of the points.
  void set_factors(FactorsOfKinds factors) { factors_ = std::move(factors); }
  /// True if any of them is negative: such interactions have energy of the opposite sign.
  [[nodiscard]] bool has_negative_factors() const {
    return std::any_of(factors_.factor.begin(), factors_.factor.end(),
                       [](double factor) { return factor < 0.0; });
  }

  /// Memory that storing them takes [bytes].
  [[nodiscard]] double stored_bytes() const;
  [[nodiscard]] bool is_stored() const { return !chunks_.empty(); }
  void store(const Points& points, const Bonds& bonds, int threads);

  /// Calls visit(group) for the interactions whose lowest point is the one that `local` has moved
  /// to. Unless they are stored, the pairs of `local` must have been found.
  template <int D, class Visit>
  void for_each_group(const LocalNeighbourhood<D>& local, InteractionScratch& scratch,
                      const Visit& visit) const;

  /// The interaction of these points, ascending, as the first lane of a block; without weight if
  /// they have none.
  template <int D>
  [[nodiscard]] InteractionBlock of_points(
      const Points& points, const std::array<Index, Measure::arms + 1>& ascending) const;

 private:
  struct StoredGroup {
    std::array<std::int32_t, fixed> partners;
    std::int32_t blocks;
  };
  /// Stored interactions of points first, first + 1, …
  struct Chunk {
    Index first;
    std::vector<Offset> groups_before, blocks_before;  // per point, and the totals
    std::vector<StoredGroup> groups;
    std::vector<InteractionBlock> blocks;
  };

  template <int D>
  void count_in(const Points& points, const Bonds& bonds, int threads);
  template <int D>
  void store_in(const Points& points, const Bonds& bonds, int threads);
  template <int D, class Visit>
  void find_groups(const LocalNeighbourhood<D>& local, InteractionScratch& scratch,
                   const Visit& visit) const;
  template <int D>
  static bool make_block(const Arms<Measure::arms, D, Lanes>& arms, const Vector<2, Lanes>& shares,
                         std::uint32_t candidates, InteractionBlock& block);
  template <int D>
  void apply_influence(const Arms<Measure::arms, D, Lanes>& arms, InteractionBlock& block) const;
  void apply_factors(const UpperNeighbourhood& upper, const Group& group,
                     InteractionBlock& block) const;

  Index own_ = 0;  // points that are no images, the lowest ones
  Offset count_ = 0;
  Offset blocks_ = 0, groups_ = 0;
  std::vector<std::int32_t> per_point_;
  std::vector<double> effective_counts_;
  std::vector<double> shares_;
  Kernel kernel_;
  FactorsOfKinds factors_;
  std::vector<double> cell_shares_;  // an interaction's cell measure M0 is their sum [m2 or m3]
  std::vector<Chunk> chunks_;
};

using Triangles = Interactions<Area>;
using Tetrahedra = Interactions<Volume>;

namespace interactions_detail {

/// 1 in the lanes of the set bits, 0 elsewhere.
inline constexpr auto lanes_of_bits = [] {
  std::array<std::array<double, lane_count>, 1 << lane_count> table{};
  for (std::size_t bits = 0; bits < table.size(); ++bits) {
    for (std::size_t l = 0; l < lane_count; ++l) table[bits][l] = bits >> l & 1U ? 1.0 : 0.0;
  }
  return table;
}();

}  // namespace interactions_detail

/// Fills a block from those of its four partners that are candidates (bits).
/// @param arms from the point; the last arm is that of the four
/// @param shares sums of the points' shares of weight and of cell measure
/// @return whether it holds any interaction
template <class Measure>
template <int D>
bool Interactions<Measure>::make_block(const Arms<Measure::arms, D, Lanes>& arms,
                                       const Vector<2, Lanes>& shares, std::uint32_t candidates,
                                       InteractionBlock& block) {
  const Lanes reference = Measure::template value<D>(arms);
  const Lanes candidate(interactions_detail::lanes_of_bits[candidates].data());
  const Lanes size = abs(reference), &cell = shares[1];
  const auto active = candidate * size > flat_measure * cell;
  if (none_of(active)) return false;
  Lanes inverse = 1.0 / reference;
  inverse = chosen(active, inverse, 1.0);
  Lanes weight = shares[0];
  if (any_of(active && size < full_measure * cell)) {
    weight *= flatness_factor(Lanes(size / cell));
  }
  weight = chosen(reference < 0.0, -weight, weight);
  weight = chosen(active, weight, 0.0);
  inverse.copy_to(block.inverse_reference);
  weight.copy_to(block.weight);
  block.active = candidates;
  if (any_of(!active && candidate > 0.0)) {  // some are flat
    for (int l = 0; l < lane_count; ++l) {
      if (!active[l]) block.active &= ~(std::uint32_t(1) << l);
    }
  }
  return true;
}

/// Multiplies the weights of a block's interactions by the influences of their sides.
template <class Measure>
template <int D>
void Interactions<Measure>::apply_influence(const Arms<Measure::arms, D, Lanes>& arms,
                                            InteractionBlock& block) const {
  for (int l = 0; l < lane_count; ++l) {
    if ((block.active >> l & 1U) == 0) continue;
    std::array<Coordinates, Measure::arms + 1> at{};
    for (std::size_t a = 0; a < Measure::arms; ++a) {
      for (std::size_t c = 0; c < D; ++c) at[a + 1][c] = arms[a][c][l];
    }
    block.weight[l] *= influence_of_sides(kernel_, at);
  }
}

/// Multiplies the weights of a block's interactions by the factors of their points' kinds.
template <class Measure>
void Interactions<Measure>::apply_factors(const UpperNeighbourhood& upper, const Group& group,
                                          InteractionBlock& block) const {
  const std::size_t kinds = factors_.kinds;
  std::size_t row = factors_.of_point[std::size_t(upper.own())];
  for (const std::int32_t a : group.partners) {
    row = row * kinds + factors_.of_point[std::size_t(upper.points()[std::size_t(a)])];
  }
  for (int l = 0; l < lane_count; ++l) {
    if ((block.active >> l & 1U) == 0) continue;
    const Index last = upper.points()[std::size_t(block.first + l)];
    block.weight[l] *= factors_.factor[row * kinds + factors_.of_point[std::size_t(last)]];
  }
}

template <class Measure>
template <int D>
InteractionBlock Interactions<Measure>::of_points(
    const Points& points, const std::array<Index, Measure::arms + 1>& ascending) const {
  InteractionBlock block{{1.0, 1.0, 1.0, 1.0}, {}, 0, 0};
  const Index own = ascending.front();
  if (own >= own_) return block;
  Arms<Measure::arms, D, Lanes> arms;
  Vector<2, Lanes> shares{shares_[own], cell_shares_[own]};
  for (std::size_t a = 0; a < Measure::arms; ++a) {
    const Index partner = ascending[a + 1];
    shares = plus<2>(shares, {shares_[partner], cell_shares_[partner]});
    for (int c = 0; c < D; ++c) {
      arms[a][c] = points.reference[std::size_t(partner) * D + c] -
                   points.reference[std::size_t(own) * D + c];
    }
  }
  InteractionBlock found = block;
  if (!make_block<D>(arms, shares, 1U, found)) return block;
  if (kernel_.influence) apply_influence<D>(arms, found);
  if (factors_.factor.empty()) return found;
  std::size_t row = 0;
  for (const Index point : ascending) {
    row = row * factors_.kinds + factors_.of_point[std::size_t(point)];
  }
  found.weight[0] *= factors_.factor[row];
  return found;
}

template <class Measure>
template <int D, class Visit>
void Interactions<Measure>::find_groups(const LocalNeighbourhood<D>& local,
                                        InteractionScratch& scratch, const Visit& visit) const {
  const UpperNeighbourhood& upper = local.upper;
  if (upper.own() >= own_) return;
  scratch.of_partners.assign(upper.count(), [&](int a, int c) {
    return (c == 0 ? shares_ : cell_shares_)[upper.points()[a]];
  });
  const Vector<2, Lanes> own{shares_[upper.own()], cell_shares_[upper.own()]};
  Group group;
  Arms<Measure::arms, D, Lanes> arms;
  Vector<2, Lanes> of_fixed;  // sums of shares of the points but the last

  // Fills blocks from the bits of partners that are bonded to all fixed ones.
  const auto complete = [&](const auto& word_of) {
    std::size_t count = 0;
    for (int w = 0; w < upper.words(); ++w) {
      std::uint64_t word = word_of(w);
      while (word != 0) {
        const int nibble = std::countr_zero(word) / lane_count * lane_count;
        const auto candidates = static_cast<std::uint32_t>(word >> nibble) & 0xFU;
        word &= ~(std::uint64_t(0xF) << nibble);
        InteractionBlock& block = scratch.blocks[count];
        block.first = w * 64 + nibble;
        arms[fixed] = local.reference.block(block.first);
        const Vector<2, Lanes> shares = plus<2>(of_fixed, scratch.of_partners.block(block.first));
        if (!make_block<D>(arms, shares, candidates, block)) continue;
        if (kernel_.influence) apply_influence<D>(arms, block);
        if (!factors_.factor.empty()) apply_factors(upper, group, block);
        ++count;
      }
    }
    group.blocks = {scratch.blocks.data(), count};
    if (count > 0) visit(group);
  };
  if constexpr (fixed == 1) {
    for (int a = 0; a < upper.count(); ++a) {
      group.partners = {a};
      arms[0] = local.reference.one(a);
      of_fixed = plus<2>(own, scratch.of_partners.one(a));
      complete([bits = upper.mutual(a)](int w) { return bits[w]; });
    }
  } else {
    for (const UpperNeighbourhood::Pair& pair : upper.pairs()) {
      group.partners = {pair.a, pair.b};
      arms[0] = local.reference.one(pair.a);
      arms[1] = local.reference.one(pair.b);
      of_fixed =
          plus<2>(plus<2>(own, scratch.of_partners.one(pair.a)), scratch.of_partners.one(pair.b));
      const std::uint64_t *a = upper.mutual(pair.a), *b = upper.mutual(pair.b);
      complete([a, b](int w) { return a[w] & b[w]; });
    }
  }
}

template <class Measure>
template <int D, class Visit>
void Interactions<Measure>::for_each_group(const LocalNeighbourhood<D>& local,
                                           InteractionScratch& scratch, const Visit& visit) const {
  if (chunks_.empty()) return find_groups<D>(local, scratch, visit);
  const Index i = local.upper.own();
  const Chunk* chunk = &chunks_.back();
  while (i < chunk->first) --chunk;
  const std::size_t row = std::size_t(i - chunk->first);
  const InteractionBlock* block = chunk->blocks.data() + chunk->blocks_before[row];
  for (Offset g = chunk->groups_before[row]; g < chunk->groups_before[row + 1]; ++g) {
    const StoredGroup& stored = chunk->groups[std::size_t(g)];
    visit(Group{stored.partners, {block, std::size_t(stored.blocks)}});
    block += stored.blocks;
  }
}

}  // namespace peristat
