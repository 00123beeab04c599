#pragma once

#include <cstddef>

#include "src/core/aligned_vector.hpp"
#include "src/core/lanes.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {

/// Number of blocks of lane_count lanes for `count` entries.
constexpr int block_count(int count) { return (count + lane_count - 1) / lane_count; }

/// A vector per local number, component by component, so that four consecutive neighbours load as
/// lanes. Entries that pad the last block are zero.
template <int D>
class LocalVectors {
 public:
  explicit LocalVectors(int most)
      : stride_(std::size_t(block_count(most)) * lane_count), values_(D * stride_, 0.0) {}

  /// Sets component c of entry a to vector(a, c), for the local numbers a in [0, count).
  template <class VectorOf>
  void assign(int count, const VectorOf& vector) {
    const int end = block_count(count) * lane_count;
    for (int a = 0; a < end; ++a) {
      for (int c = 0; c < D; ++c) values_[c * stride_ + a] = a < count ? vector(a, c) : 0.0;
    }
  }

  /// The vector of one neighbour in all lanes.
  [[nodiscard]] Vector<D, Lanes> one(int a) const {
    Vector<D, Lanes> result;
    for (int c = 0; c < D; ++c) result[c] = values_[c * stride_ + a];
    return result;
  }

  /// The vectors of neighbours first .. first + 3.
  [[nodiscard]] Vector<D, Lanes> block(int first) const {
    Vector<D, Lanes> result;
    for (int c = 0; c < D; ++c) {
      result[c] = Lanes(&values_[c * stride_ + first]);
    }
    return result;
  }

 private:
  std::size_t stride_;
  AlignedVector<double> values_;
};

}  // namespace peristat
