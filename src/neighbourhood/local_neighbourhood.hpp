#pragma once

#include "src/geometry/points.hpp"
#include "src/neighbourhood/local_vectors.hpp"
#include "src/neighbourhood/upper_neighbourhood.hpp"

namespace peristat {

/// Neighbourhood of the point that a thread works on: the partners above it with their reference
/// arms (vectors from the point to them) [m].
template <int D>
struct LocalNeighbourhood {
  /// Points and bonds must outlive this.
  LocalNeighbourhood(const Points& of, const Bonds& bonds)
      : points(of), upper(bonds), reference(UpperNeighbourhood::largest(bonds)) {}

  const Points& points;
  UpperNeighbourhood upper;
  LocalVectors<D> reference;

  void move_to(Index i) {
    upper.move_to(i);
    const double* positions = points.reference.data();
    reference.assign(upper.count(), [&](int a, int c) {
      return positions[std::size_t(upper.points()[a]) * D + c] - positions[std::size_t(i) * D + c];
    });
  }
};

}  // namespace peristat
