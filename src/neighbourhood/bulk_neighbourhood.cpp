#include "src/neighbourhood/bulk_neighbourhood.hpp"

#include <numbers>

#include "src/neighbourhood/lattice_ball.hpp"

namespace peristat {

BulkNeighbourhood bulk_neighbourhood(int dimension, double spacing, double horizon,
                                     double cross_section) {
  constexpr double pi = std::numbers::pi;
  BulkNeighbourhood bulk;
  bulk.volume = cross_section * (dimension == 1   ? 2.0 * horizon
                                 : dimension == 2 ? pi * horizon * horizon
                                                  : 4.0 / 3.0 * pi * horizon * horizon * horizon);
  const LatticeBall ball(dimension, spacing, horizon);
  bulk.neighbours = static_cast<std::int64_t>(ball.arms().size());
  ball.for_each_pair([&](const Coordinates&, const Coordinates&, double) { bulk.pairs += 2; });
  ball.for_each_triplet([&](double) { bulk.triplets += 6; });
  return bulk;
}

}  // namespace peristat
