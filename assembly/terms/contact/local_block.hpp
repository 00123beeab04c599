#pragma once

#include <span>
#include <vector>

#include "assembly/operators/tangent.hpp"
#include "assembly/terms/contact/contact_rows.hpp"

namespace peristat {

/// Dense symmetric matrix of a few points, as the tangent of a contact: row major, places x
/// dimension.
class LocalBlock {
 public:
  LocalBlock(int dimension) : dimension_(std::size_t(dimension)) {}

  void clear() {
    point_.clear();
    entry_.clear();
  }
  /// Place of a point, which is added if it is not there.
  std::size_t place(Index point);
  [[nodiscard]] std::span<const Index> points() const { return point_; }

  /// Entry of two degrees of freedom, which are there.
  [[nodiscard]] double& entry(std::size_t row, std::size_t column) {
    return entry_[row * order() + column];
  }
  [[nodiscard]] double entry(std::size_t row, std::size_t column) const {
    return entry_[row * order() + column];
  }

  /// Moves it by a share towards its positive semidefinite part.
  void project(double share);

  /// Adds it to a tangent of the pattern.
  void add_to(Tangent& tangent, const BlockPattern& pattern) const;
  /// Adds its product with v.
  void add_product(std::span<const double> v, std::span<double> product) const;

 private:
  [[nodiscard]] std::size_t order() const { return point_.size() * dimension_; }

  std::size_t dimension_;
  std::vector<Index> point_;
  std::vector<double> entry_;
};

}  // namespace peristat
