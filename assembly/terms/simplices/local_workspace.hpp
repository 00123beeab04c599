#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <span>
#include <tuple>
#include <vector>

#include "src/core/aligned_vector.hpp"
#include "src/core/lanes.hpp"
#include "src/neighbourhood/interactions.hpp"

namespace peristat {

/// Data that the energies of triangles and tetrahedra depend on beside positions; empty: none.
struct Influences {
  std::span<const double> of_bond;       ///< integrity of bonds
  std::span<const double> of_point;      ///< smallest integrity of a point's bonds
  std::span<const double> eigenstretch;  ///< of points
};

/// Relative change m/M - 1 of an area or a volume whose points grow freely by this eigenstretch.
template <int arms, class Real>
[[nodiscard]] Real free_growth(const Real& stretch) {
  return arms == 2 ? stretch * (2.0 + stretch) : stretch * (3.0 + stretch * (3.0 + stretch));
}

/// Sums of one thread over the interactions of one point with the partners above it. Everything is
/// a function of the arms alone: sums belong to partners, and the point's own part follows from
/// them, since an interaction does not change when all of its points move together.
///
/// Interactions come as a group of fixed partners and blocks of four last partners side by side
/// (see InteractionGroup). Contributions to a last partner are added at its place in its block;
/// those to a fixed partner are added lane by lane, and the lanes are summed at the end.
template <int D>
struct LocalWorkspace {
  /// Most doubles that are added up per partner: the upper half of a symmetric block.
  static constexpr int most_width = D * (D + 1) / 2;
  static constexpr int entries = D * D;

  LocalWorkspace(const Points& points, const Bonds& bonds)
      : LocalWorkspace(points, bonds, UpperNeighbourhood::largest(bonds)) {}

  LocalNeighbourhood<D> local;
  LocalVectors<D> displacement;  ///< of the partners relative to the point [m]
  LocalVectors<D> vector;        ///< another such field, for the product
  InteractionScratch scratch;

  /// Looks up the integrities of the bonds among the point and its partners.
  void find_integrity(const Influences& integrity, Offset first_bond, bool pairs_are_known) {
    const std::span<const Index> partners = local.upper.points();
    const std::span<const double> of_bond = integrity.of_bond, of_point = integrity.of_point;
    is_degraded_ =
        !of_bond.empty() && (of_point[local.upper.own()] < 1.0 ||
                             std::any_of(partners.begin(), partners.end(),
                                         [&](Index partner) { return of_point[partner] < 1.0; }));
    if (!is_degraded_) return;
    if (!pairs_are_known) local.upper.find_pairs();
    std::copy_n(of_bond.begin() + first_bond, partners.size(), own_integrity_.begin());
    for (const UpperNeighbourhood::Pair& pair : local.upper.pairs()) {
      pair_integrity_[std::size_t(pair.a) * stride_ + std::size_t(pair.b)] = of_bond[pair.bond];
    }
  }

  /// Integrities of a block's interactions: products over the bonds that are their edges.
  template <class Group>
  [[nodiscard]] Lanes integrity_of(const Group& group, const InteractionBlock& block) const {
    if (!is_degraded_) return 1.0;
    const auto lanes_at = [](const double* from) { return Lanes(from); };
    Lanes product = lanes_at(&own_integrity_[std::size_t(block.first)]);
    const auto& fixed = group.partners;
    for (std::size_t p = 0; p < fixed.size(); ++p) {
      const double* row = &pair_integrity_[std::size_t(fixed[p]) * stride_];
      product *= own_integrity_[std::size_t(fixed[p])] * lanes_at(row + block.first);
      for (std::size_t q = p + 1; q < fixed.size(); ++q) product *= row[fixed[q]];
    }
    return product;
  }

  /// Looks up the eigenstretches of the point and its partners.
  void find_eigenstretch(std::span<const double> of_point) {
    has_eigenstretch_ = !of_point.empty();
    if (!has_eigenstretch_) return;
    const std::span<const Index> partners = local.upper.points();
    own_eigenstretch_ = of_point[std::size_t(local.upper.own())];
    eigenstretch_.resize(stride_, 0.0);
    for (std::size_t k = 0; k < partners.size(); ++k) eigenstretch_[k] = of_point[partners[k]];
  }

  /// Subtracts the stress-free growth of a block's interactions: from m to m (1 + s)^n, s the mean
  /// of their points' eigenstretches.
  template <class MeasureAt, class Fixed>
  void relieve(MeasureAt& measure, const Fixed& fixed, const InteractionBlock& block) const {
    if (!has_eigenstretch_) return;
    double known = own_eigenstretch_;
    for (const int partner : fixed) known += eigenstretch_[std::size_t(partner)];
    const Lanes last(&eigenstretch_[std::size_t(block.first)]);
    constexpr int arms = MeasureAt::arms;
    measure.relative_change -= free_growth<arms>((known + last) / double(arms + 1));
  }

  /// Clears what bonds would set free.
  void clear_releases() {
    const std::size_t count = std::size_t(local.upper.count());
    own_release_.resize(own_integrity_.size());
    pair_release_.resize(pair_integrity_.size());
    std::fill_n(own_release_.begin(), stride_, 0.0);
    std::fill_n(pair_release_.begin(), count * stride_, 0.0);
  }

  /// Adds to each edge of a block's interactions their energies, these without integrities, times
  /// the integrities of the other edges.
  template <class Group>
  void add_releases(const Group& group, const InteractionBlock& block, const Lanes& energy) {
    constexpr std::size_t fixed = std::tuple_size_v<decltype(group.partners)>;
    constexpr std::size_t edges = fixed == 1 ? 3 : 6;
    struct Edge {
      std::size_t place;  // of the first lane in the point's own bonds or in those of pairs
      bool is_own, is_fixed;
    };
    std::array<Edge, edges> edge;
    std::size_t count = 0;
    const auto last = std::size_t(block.first);
    edge[count++] = {last, true, false};
    for (std::size_t p = 0; p < fixed; ++p) {
      const std::size_t row = std::size_t(group.partners[p]) * stride_;
      edge[count++] = {std::size_t(group.partners[p]), true, true};
      edge[count++] = {row + last, false, false};
      for (std::size_t q = p + 1; q < fixed; ++q) {
        edge[count++] = {row + std::size_t(group.partners[q]), false, true};
      }
    }
    std::array<Lanes, edges> integrity{};
    for (std::size_t k = 0; k < edges && is_degraded_; ++k) {
      const double* at = &(edge[k].is_own ? own_integrity_ : pair_integrity_)[edge[k].place];
      integrity[k] = edge[k].is_fixed ? Lanes(*at) : Lanes(at);
    }
    for (std::size_t k = 0; k < edges; ++k) {
      Lanes release = energy;
      for (std::size_t other = 0; other < edges && is_degraded_; ++other) {
        if (other != k) release *= integrity[other];
      }
      double* to = &(edge[k].is_own ? own_release_ : pair_release_)[edge[k].place];
      if (edge[k].is_fixed) {
        *to += sum(release);
      } else {
        add_lanes(to, release);
      }
    }
  }

  [[nodiscard]] double own_release(int a) const { return own_release_[std::size_t(a)]; }
  [[nodiscard]] double pair_release(int a, int b) const {
    return pair_release_[std::size_t(a) * stride_ + std::size_t(b)];
  }

  void clear(int width) {
    const std::size_t count = std::size_t(local.upper.count());
    std::fill_n(of_fixed_.begin(), count * width * lane_count, 0.0);
    std::fill_n(of_last_.begin(), std::size_t(block_count(int(count))) * width * lane_count, 0.0);
  }

  template <int width>
  void add_to_fixed(int partner, const std::array<Lanes, width>& value) {
    add<width>(&of_fixed_[std::size_t(partner) * width * lane_count], value);
  }

  /// Adds to the partners first .. first + 3, a lane each.
  template <int width>
  void add_to_last(int first, const std::array<Lanes, width>& value) {
    add<width>(&of_last_[std::size_t(first) * width], value);
  }

  template <int width>
  [[nodiscard]] std::array<double, width> total_of(int partner) const {
    std::array<double, width> total;
    const double* fixed = &of_fixed_[std::size_t(partner) * width * lane_count];
    const double* last = &of_last_[std::size_t(partner / lane_count) * lane_count * width +
                                   std::size_t(partner % lane_count)];
    for (int c = 0; c < width; ++c) {
      const double* lane = fixed + c * lane_count;
      total[c] = ((lane[0] + lane[1]) + (lane[2] + lane[3])) + last[c * lane_count];
    }
    return total;
  }

  /// Relative Hessian: blocks of partners a < b, four b side by side.
  [[nodiscard]] double* hessian(int a, int first) {
    return &hessian_[(std::size_t(a) * stride_ + std::size_t(first)) * entries];
  }
  void clear_hessian() {
    const int count = local.upper.count();
    for (int a = 0; a < count; ++a) {
      // Partners above a only; their first block may start below it.
      const int first = a / lane_count * lane_count;
      std::fill_n(hessian(a, first), std::size_t(block_count(count) * lane_count - first) * entries,
                  0.0);
    }
  }
  void add_to_hessian(int a, int first, const Matrix<D, Lanes>& block) {
    add_block(hessian(a, first), block);
  }
  /// Adds the sum of a block's lanes to one pair.
  void add_to_pair(int a, int b, const Matrix<D, Lanes>& block) {
    double* place = hessian(a, b / lane_count * lane_count) + b % lane_count;
    for (int r = 0; r < D; ++r) {
      for (int c = 0; c < D; ++c) place[(r * D + c) * lane_count] += sum(block[r][c]);
    }
  }
  [[nodiscard]] Matrix<D, double> pair(int a, int b) {
    const double* place = hessian(a, b / lane_count * lane_count) + b % lane_count;
    Matrix<D, double> block;
    for (int r = 0; r < D; ++r) {
      for (int c = 0; c < D; ++c) block[r][c] = place[(r * D + c) * lane_count];
    }
    return block;
  }

 private:
  LocalWorkspace(const Points& points, const Bonds& bonds, int most)
      : local(points, bonds),
        displacement(most),
        vector(most),
        scratch(most),
        stride_(std::size_t(block_count(most)) * lane_count),
        own_integrity_(stride_, 1.0),
        pair_integrity_(std::size_t(most) * stride_, 1.0),
        of_fixed_(std::size_t(most) * most_width * lane_count),
        of_last_(stride_ * most_width),
        hessian_(std::size_t(most) * stride_ * entries) {}

  static void add_lanes(double* to, const Lanes& value) {
    Lanes total(to);
    total += value;
    total.copy_to(to);
  }
  template <int width>
  static void add(double* to, const std::array<Lanes, width>& value) {
    for (int c = 0; c < width; ++c) add_lanes(to + c * lane_count, value[c]);
  }
  static void add_block(double* to, const Matrix<D, Lanes>& block) {
    for (int r = 0; r < D; ++r) {
      for (int c = 0; c < D; ++c) add_lanes(to + (r * D + c) * lane_count, block[r][c]);
    }
  }

  std::size_t stride_;
  bool is_degraded_ = false, has_eigenstretch_ = false;
  double own_eigenstretch_ = 0.0;
  std::vector<double> eigenstretch_;                // of the partners
  std::vector<double> own_integrity_;               // of the bonds to the partners
  std::vector<double> pair_integrity_;              // of those between partners a < b
  std::vector<double> own_release_, pair_release_;  // what these would set free
  AlignedVector<double> of_fixed_;                  // [partner][width][lane]
  AlignedVector<double> of_last_;                   // [block][width][lane]
  AlignedVector<double> hessian_;                   // [partner][block][entry][lane]
};

}  // namespace peristat
