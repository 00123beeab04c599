#include "src/neighbourhood/bulk_neighbourhood.hpp"

#include "src/neighbourhood/kernel.hpp"
#include "src/neighbourhood/lattice_ball.hpp"

namespace peristat {

BulkNeighbourhood bulk_neighbourhood(int dimension, double spacing, double horizon,
                                     double cross_section) {
  BulkNeighbourhood bulk;
  bulk.volume = Kernel{dimension, horizon, cross_section}.moment(0);
  const LatticeBall ball(dimension, spacing, horizon);
  bulk.neighbours = static_cast<std::int64_t>(ball.arms().size());
  ball.for_each_pair([&](const Coordinates&, const Coordinates&, double) { bulk.pairs += 2; });
  ball.for_each_triplet([&](const Coordinates&, const Coordinates&, const Coordinates&, double) {
    bulk.triplets += 6;
  });
  return bulk;
}

}  // namespace peristat
