#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "assembly/operators/block_pattern.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Pairs of points that contacts couple.
class ContactRows {
 public:
  using Pair = std::pair<Index, Index>;

  explicit ContactRows(Index points) : offset_(std::size_t(points) + 1, 0) {}

  [[nodiscard]] std::optional<Couplings> couplings() const {
    if (partner_.empty()) return std::nullopt;
    return Couplings(offset_, partner_);
  }
  [[nodiscard]] bool has(Index one, Index other) const {
    const auto [i, j] = std::minmax(one, other);
    const auto first = partner_.begin() + offset_[std::size_t(i)],
               last = partner_.begin() + offset_[std::size_t(i) + 1];
    return std::binary_search(first, last, j);
  }
  /// Adds its pairs to others.
  void add_to(std::vector<Pair>& pairs) const {
    for (std::size_t i = 0; i + 1 < offset_.size(); ++i) {
      for (Offset k = offset_[i]; k < offset_[i + 1]; ++k) {
        pairs.emplace_back(Index(i), partner_[std::size_t(k)]);
      }
    }
  }
  /// Takes the pairs instead of its own, in any order, and each as often as it likes.
  void take(std::vector<Pair> pairs) {
    for (auto& [i, j] : pairs) {
      if (i > j) std::swap(i, j);
    }
    std::ranges::sort(pairs);
    pairs.erase(std::ranges::unique(pairs).begin(), pairs.end());
    std::ranges::fill(offset_, 0);
    partner_.clear();
    for (const auto& [i, j] : pairs) {
      ++offset_[std::size_t(i) + 1];
      partner_.push_back(j);
    }
    for (std::size_t i = 1; i < offset_.size(); ++i) offset_[i] += offset_[i - 1];
  }

 private:
  std::vector<Offset> offset_;
  std::vector<Index> partner_;
};

/// Number of the block of two points, i < j, in the pattern of a tangent.
[[nodiscard]] inline Offset place_of_contact(const BlockPattern& pattern, Index i, Index j) {
  const std::span<const Index> row = pattern.of(i);
  const auto found = std::lower_bound(row.begin(), row.end(), j);
  if (found == row.end() || *found != j) {
    throw std::logic_error("the pattern of the tangent lacks points in contact");
  }
  return pattern.offset[std::size_t(i)] + (found - row.begin());
}

/// True if the displacement of all points is finite.
[[nodiscard]] inline bool is_finite_at(const Points& points, std::span<const double> displacement) {
  const auto of_points = displacement.first(points.reference.size());
  return std::ranges::all_of(of_points, [](double u) { return std::isfinite(u); });
}

}  // namespace peristat
