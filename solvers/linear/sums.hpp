#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "solvers/linear/vector_verbs.hpp"
#include "src/core/sharing.hpp"

namespace peristat {

/// Sums over vectors of a body, partitioned or not. Ghosts and their images do not count,
/// generalised degrees of freedom ("handles") count at rank 0, and all ranks get the same bits.
/// Collective if the body is partitioned.
class Sums {
 public:
  /// @param sharing partition of the body; null: the body is not partitioned
  Sums(const Sharing* sharing, int dimension)
      : ranks_(sharing ? &sharing->ranks() : nullptr),
        own_(sharing ? std::size_t(sharing->owned()) * std::size_t(dimension) : 0) {
    if (!sharing) return;
    const auto d = std::size_t(dimension);
    const auto first_image = std::size_t(sharing->first_image());
    images_ = {first_image * d, (first_image + std::size_t(sharing->owned_images())) * d};
    handles_ = std::size_t(sharing->count()) * d;
  }

  /// Returns how many entries of a vector belong to this rank's points: the first ones.
  [[nodiscard]] std::size_t own(std::size_t entries) const {
    return ranks_ ? std::min(own_, entries) : entries;
  }

  [[nodiscard]] double of_all(double mine) const { return ranks_ ? ranks_->sum(mine) : mine; }
  /// Replaces the shares of the ranks by their sums.
  void add_up(std::span<double> shares) const {
    if (ranks_) peristat::add_up(*ranks_, shares);
  }
  [[nodiscard]] double largest_of_all(double mine) const {
    return ranks_ ? ranks_->max(mine) : mine;
  }
  [[nodiscard]] std::vector<double> of_all(std::vector<double> mine) const {
    return ranks_ ? ranks_->sum(mine) : mine;
  }

  [[nodiscard]] double dot(std::span<const double> a, std::span<const double> b) const {
    if (!ranks_) return peristat::dot(a, b);
    double mine = 0.0;
    for (const auto& [first, last] : counted(a.size())) {
      mine += peristat::dot(a.subspan(first, last - first), b.subspan(first, last - first));
    }
    return ranks_->sum(mine);
  }

  /// 2-norm of entry(0), …, entry(count - 1) of all ranks; see norm_of in vector_verbs.hpp.
  /// @param count number of values of this rank
  template <class Entry>
  [[nodiscard]] double norm_of(std::size_t count, const Entry& entry) const {
    const double mine = peristat::norm_of(count, entry);
    if (!ranks_) return mine;
    const std::vector<double> norms = ranks_->all_of({mine});
    return peristat::norm(norms);
  }
  /// 2-norm of entry(k) over those entries k of a vector that count, of all ranks.
  template <class Entry>
  [[nodiscard]] double norm_of_entries(std::size_t entries, const Entry& entry) const {
    if (!ranks_) return peristat::norm_of(entries, entry);
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

  /// Ranges of owned points, of their images, and of generalised degrees of freedom.
  [[nodiscard]] Ranges counted(std::size_t entries) const {
    if (!ranks_) return {Range{0, entries}, {}, {}};
    const auto within = [&](std::size_t first, std::size_t last) {
      return Range{std::min(first, entries), std::min(last, entries)};
    };
    const bool owns_handles = ranks_->rank() == 0;
    return {within(0, own_), within(images_.first, images_.last),
            owns_handles ? within(handles_, entries) : Range{}};
  }

  const Communicator* ranks_;
  std::size_t own_;
  Range images_{};
  std::size_t handles_ = 0;
};

}  // namespace peristat
