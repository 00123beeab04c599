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
    return of(i).place_of(j).has_value();
  }
  /// Adds its pairs to others.
  void add_to(std::vector<Pair>& pairs) const {
    for (std::size_t i = 0; i + 1 < offset_.size(); ++i) {
      for (const Index j : of(Index(i))) pairs.emplace_back(Index(i), j);
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
    std::vector<Index> upper;
    for (const auto& [i, j] : pairs) {
      ++offset_[std::size_t(i) + 1];
      upper.push_back(j);
    }
    for (std::size_t i = 1; i < offset_.size(); ++i) offset_[i] += offset_[i - 1];
    partner_ = Partners(offset_, upper);
  }

 private:
  [[nodiscard]] PartnersOfPoint of(Index i) const {
    return partner_.between(i, offset_[std::size_t(i)], offset_[std::size_t(i) + 1]);
  }

  std::vector<Offset> offset_;
  Partners partner_;
};

/// Number of the block of two points, i < j, in the pattern of a tangent.
[[nodiscard]] inline Offset place_of_contact(const BlockPattern& pattern, Index i, Index j) {
  const std::optional<Offset> found = pattern.find(i, j);
  if (!found) throw std::logic_error("the pattern of the tangent lacks points in contact");
  return *found;
}

/// True if the displacement of all points is finite.
[[nodiscard]] inline bool is_finite_at(const Points& points, std::span<const double> displacement) {
  const auto of_points = displacement.first(points.reference.size());
  return std::ranges::all_of(of_points, [](double u) { return std::isfinite(u); });
}

}  // namespace peristat
