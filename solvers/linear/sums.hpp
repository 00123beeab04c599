#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "solvers/linear/vector_verbs.hpp"
#include "src/core/sharing.hpp"

namespace peristat {

/// Sums over the vectors of a body that is whole, or that ranks have parts of: what ghosts have
/// does not count, and all ranks get the same bits.
class Sums {
 public:
  /// @param sharing null: the body is whole
  Sums(const Sharing* sharing, int dimension)
      : ranks_(sharing ? &sharing->ranks() : nullptr),
        own_(sharing ? std::size_t(sharing->owned()) * std::size_t(dimension) : 0) {}

  /// How many of the entries of a vector count here: the first ones.
  [[nodiscard]] std::size_t own(std::size_t entries) const {
    return ranks_ ? std::min(own_, entries) : entries;
  }

  [[nodiscard]] double of_all(double mine) const { return ranks_ ? ranks_->sum(mine) : mine; }
  [[nodiscard]] double largest_of_all(double mine) const {
    return ranks_ ? ranks_->max(mine) : mine;
  }
  [[nodiscard]] std::vector<double> of_all(std::vector<double> mine) const {
    return ranks_ ? ranks_->sum(mine) : mine;
  }

  [[nodiscard]] double dot(std::span<const double> a, std::span<const double> b) const {
    const std::size_t count = own(a.size());
    return of_all(peristat::dot(a.first(count), b.first(count)));
  }

  /// See vector_verbs.
  /// @param count of entries that are this rank's
  template <class Entry>
  [[nodiscard]] double norm_of(std::size_t count, const Entry& entry) const {
    const double mine = peristat::norm_of(count, entry);
    if (!ranks_) return mine;
    const std::vector<double> norms = ranks_->all_of({mine});
    return peristat::norm(norms);
  }
  [[nodiscard]] double norm(std::span<const double> a) const {
    return norm_of(own(a.size()), [&](std::size_t k) { return a[k]; });
  }

 private:
  const Communicator* ranks_;
  std::size_t own_;
};

}  // namespace peristat
