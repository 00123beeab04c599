#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <span>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// Partners of one point, ascending: a range of points, computed from the steps to them. A view.
class PartnersOfPoint {
 public:
  class Iterator {
   public:
    using iterator_category = std::random_access_iterator_tag;
    using value_type = Index;
    using difference_type = std::ptrdiff_t;
    using pointer = const Index*;
    using reference = Index;

    Iterator() = default;
    Iterator(Index point, const Index* ahead) : point_(point), ahead_(ahead) {}

    Index operator*() const { return point_ + *ahead_; }
    Index operator[](difference_type k) const { return point_ + ahead_[k]; }
    Iterator& operator++() { return *this += 1; }
    Iterator operator++(int) { return {point_, ahead_++}; }
    Iterator& operator--() { return *this -= 1; }
    Iterator operator--(int) { return {point_, ahead_--}; }
    Iterator& operator+=(difference_type k) {
      ahead_ += k;
      return *this;
    }
    Iterator& operator-=(difference_type k) { return *this += -k; }
    friend Iterator operator+(Iterator at, difference_type k) { return at += k; }
    friend Iterator operator+(difference_type k, Iterator at) { return at += k; }
    friend Iterator operator-(Iterator at, difference_type k) { return at -= k; }
    friend difference_type operator-(const Iterator& a, const Iterator& b) {
      return a.ahead_ - b.ahead_;
    }
    friend bool operator==(const Iterator& a, const Iterator& b) { return a.ahead_ == b.ahead_; }
    friend auto operator<=>(const Iterator& a, const Iterator& b) { return a.ahead_ <=> b.ahead_; }

   private:
    Index point_ = 0;
    const Index* ahead_ = nullptr;
  };

  PartnersOfPoint(Index point, std::span<const Index> ahead) : point_(point), ahead_(ahead) {}

  [[nodiscard]] std::size_t size() const { return ahead_.size(); }
  [[nodiscard]] bool empty() const { return ahead_.empty(); }
  [[nodiscard]] Index operator[](std::size_t k) const { return point_ + ahead_[k]; }
  [[nodiscard]] Index back() const { return point_ + ahead_.back(); }
  /// Where j is among them.
  [[nodiscard]] std::optional<Offset> place_of(Index j) const {
    const auto found = std::ranges::lower_bound(ahead_, j - point_);
    if (found == ahead_.end() || *found != j - point_) return std::nullopt;
    return found - ahead_.begin();
  }
  [[nodiscard]] Iterator begin() const { return {point_, ahead_.data()}; }
  [[nodiscard]] Iterator end() const { return {point_, ahead_.data() + ahead_.size()}; }

 private:
  Index point_;
  std::span<const Index> ahead_;
};

/// Partners of all points, see Partners. A view.
class PartnersView {
 public:
  PartnersView() = default;
  PartnersView(Offset bonds, std::span<const Offset> shift, std::span<const Index> ahead)
      : bonds_(bonds), shift_(shift.data()), ahead_(ahead.data()) {}

  /// Upper point of a bond of point i.
  [[nodiscard]] Index operator()(Index i, Offset bond) const {
    return i + ahead_[bond + shift_[i]];
  }
  /// Partners of point i by its bonds first .. last - 1.
  [[nodiscard]] PartnersOfPoint between(Index i, Offset first, Offset last) const {
    if (first == last) return {i, {}};
    return {i, {ahead_ + (first + shift_[i]), std::size_t(last - first)}};
  }
  [[nodiscard]] Offset size() const { return bonds_; }
  [[nodiscard]] bool empty() const { return bonds_ == 0; }
  [[nodiscard]] bool is_same_view(const PartnersView& other) const {
    return shift_ == other.shift_;
  }

 private:
  Offset bonds_ = 0;
  const Offset* shift_ = nullptr;
  const Index* ahead_ = nullptr;
};

/// Upper points of bonds, which are grouped by their lower points: each point has a row of steps to
/// its partners. Rows that are alike are kept once: on a lattice nearly all points share a few
/// rows, and a bond takes no memory of its own; in a cloud of points it takes 4 bytes.
class Partners {
 public:
  Partners() = default;
  /// @param offset the partners of i are upper[offset[i]] .. upper[offset[i+1]-1], ascending
  Partners(std::span<const Offset> offset, std::span<const Index> upper);

  operator PartnersView() const { return {bonds_, shift_, ahead_}; }
  [[nodiscard]] Index operator()(Index i, Offset bond) const {
    return PartnersView(*this)(i, bond);
  }
  [[nodiscard]] PartnersOfPoint between(Index i, Offset first, Offset last) const {
    return PartnersView(*this).between(i, first, last);
  }
  [[nodiscard]] Offset size() const { return bonds_; }
  [[nodiscard]] bool empty() const { return bonds_ == 0; }
  [[nodiscard]] std::size_t bytes() const {
    return ahead_.size() * sizeof(Index) + shift_.size() * sizeof(Offset);
  }

 private:
  friend class PartnersBuilder;

  Offset bonds_ = 0;
  std::vector<Offset> shift_;  // per point: place of its row's first step, minus its first bond
  std::vector<Index> ahead_;   // steps from a point to its partners
};

/// Makes Partners row by row. A row is compared with one earlier row of the same hash, so that time
/// and memory do not grow where no two are alike.
class PartnersBuilder {
 public:
  /// @param first the point of the first row
  explicit PartnersBuilder(Index first = 0) : next_(first), recent_(4096) {}
  void reserve(std::size_t points, std::size_t steps);

  /// Appends the row of the next point.
  /// @param upper its partners, ascending
  template <class Range>
  void add(const Range& upper) {
    row_.clear();
    for (const Index j : upper) row_.push_back(j - next_);
    add_steps();
  }
  /// Appends the rows of others.
  /// @param offset of their first bonds, one more than they have rows; any first value
  void append(const Partners& others, std::span<const Offset> offset);
  /// The partners of all rows.
  [[nodiscard]] Partners take();

 private:
  struct Row {
    std::size_t first = 0, count = 0;
  };
  void add_steps();
  /// Place of a row of steps.
  std::size_t place_of(std::span<const Index> ahead);

  Index next_;
  std::vector<Index> row_;  // steps to the partners of the next point
  Partners made_;
  std::vector<Row> recent_;  // by hash
};

}  // namespace peristat
