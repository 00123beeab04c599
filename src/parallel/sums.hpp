#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "src/core/vector_verbs.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Sums over vectors of a body, partitioned or not. Ghosts and their images do not count,
/// generalised degrees of freedom ("handles") count at rank 0, and all ranks get the same bits.
/// Collective.
class Sums {
 public:
  Sums(const IndexMap& index_map, int dimension)
      : index_map_(index_map), dimension_(std::size_t(dimension)) {}

  /// Returns how many entries of a vector belong to this rank's points: the first ones.
  [[nodiscard]] std::size_t own(std::size_t entries) const {
    const Range owned = counted(entries).front();
    return owned.last;
  }

  [[nodiscard]] double of_all(double mine) const { return ranks().sum(mine); }
  [[nodiscard]] std::vector<double> of_all(const std::vector<double>& mine) const {
    return ranks().sum(mine);
  }
  /// Replaces the shares of the ranks by their sums.
  void add_up(std::span<double> shares) const { peristat::add_up(ranks(), shares); }
  [[nodiscard]] double largest_of_all(double mine) const { return ranks().max(mine); }

  [[nodiscard]] double dot(std::span<const double> a, std::span<const double> b) const {
    double mine = 0.0;
    for (const auto& [first, last] : counted(a.size())) {
      mine += peristat::dot(a.subspan(first, last - first), b.subspan(first, last - first));
    }
    return ranks().sum(mine);
  }

  /// 2-norm of entry(0), …, entry(count - 1) of all ranks; see norm_of in vector_verbs.hpp.
  /// @param count number of values of this rank
  template <class Entry>
  [[nodiscard]] double norm_of(std::size_t count, const Entry& entry) const {
    return norm_of_all(ranks(), peristat::norm_of(count, entry));
  }
  /// 2-norm of entry(k) over those entries k of a vector that count, of all ranks.
  template <class Entry>
  [[nodiscard]] double norm_of_entries(std::size_t entries, const Entry& entry) const {
    const Ranges ranges = counted(entries);
    std::size_t count = 0;
    for (const auto& [first, last] : ranges) count += last - first;
    return norm_of(count, [&](std::size_t k) {
      auto range = ranges.begin();
      for (; k >= range->last - range->first; ++range) k -= range->last - range->first;
      return entry(range->first + k);
    });
  }
  [[nodiscard]] double norm(std::span<const double> a) const {
    return norm_of_entries(a.size(), [&](std::size_t k) { return a[k]; });
  }

  /// Calls visit(k) for those entries of a vector that count on this rank.
  template <class Visit>
  void for_each_entry(std::size_t entries, const Visit& visit) const {
    for (const auto& [first, last] : counted(entries)) {
      for (std::size_t k = first; k < last; ++k) visit(k);
    }
  }

 private:
  struct Range {
    std::size_t first = 0, last = 0;
  };
  using Ranges = std::array<Range, 3>;

  [[nodiscard]] const Communicator& ranks() const { return index_map_.ranks(); }

  /// Ranges of owned points, of their images, and of generalised degrees of freedom.
  [[nodiscard]] Ranges counted(std::size_t entries) const {
    if (index_map_.is_whole()) return {Range{0, entries}, {}, {}};
    const auto range = [&](Index first, Index points) {
      const std::size_t begin = std::size_t(first) * dimension_;
      return Range{std::min(begin, entries),
                   std::min(begin + std::size_t(points) * dimension_, entries)};
    };
    const std::size_t handles = std::min(std::size_t(index_map_.count()) * dimension_, entries);
    return {range(0, index_map_.owned()),
            range(index_map_.first_image(), index_map_.owned_images()),
            index_map_.is_first_rank() ? Range{handles, entries} : Range{}};
  }

  const IndexMap& index_map_;
  std::size_t dimension_;
};

}  // namespace peristat
