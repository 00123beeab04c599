#include "src/materials/effective_volumes.hpp"

#include <cmath>

namespace peristat {
namespace {

/// Ordered neighbour sets per unique interaction of a point: 2 pairs, 6 triplets.
template <class Measure>
constexpr double orders = Measure::arms == 2 ? 2.0 : 6.0;

/// The count n that effective volumes are divided by: n itself from n = 1 on, so that they add up
/// to the neighbourhood's volume. Below, where the last interactions of a point are nearly flat, it
/// is (1 + n^2)/2: their weights vanish with them instead of index_map the whole volume.
double divisor(double count) { return count >= 1.0 ? count : 0.5 * (1.0 + count * count); }

/// Volume with which a point contributes; 0 beyond a plane of symmetry, where it belongs to the
/// twin.
double own_volume(const Points& points, Index point) {
  return points.is_image(point) ? 0.0 : points.volume[std::size_t(point)];
}

}  // namespace

double effective_neighbour_volume(const BulkNeighbourhood& bulk) {
  return bulk.volume / double(bulk.neighbours);
}

void set_one_neighbour_weights(Bonds& bonds, const Points& points, const BulkNeighbourhood& bulk) {
  const double v1 = effective_neighbour_volume(bulk);
  bonds.set_weights([&](Index i, Offset bond) {
    return 0.5 * (own_volume(points, i) + own_volume(points, bonds.partner(i, bond))) * v1;
  });
}

template <class Measure>
std::vector<double> effective_volumes(const Interactions<Measure>& interactions,
                                      const std::vector<std::int32_t>& neighbours,
                                      const BulkNeighbourhood& bulk, InteractionWeights weights) {
  const std::vector<double>& count = interactions.effective_counts();
  const double in_bulk = double(Measure::arms == 2 ? bulk.pairs : bulk.triplets);
  std::vector<double> volume(count.size(), 0.0);
  for (std::size_t a = 0; a < volume.size(); ++a) {
    if (weights == InteractionWeights::bulk) {
      volume[a] = std::pow(bulk.volume, Measure::arms) / in_bulk;
    } else {
      const double neighbourhood = effective_neighbour_volume(bulk) * neighbours[a];
      volume[a] = std::pow(neighbourhood, Measure::arms) / (orders<Measure> * divisor(count[a]));
    }
  }
  return volume;
}

template <class Measure>
std::vector<double> weight_shares(const Points& points,
                                  const std::vector<double>& effective_volume) {
  std::vector<double> shares(effective_volume.size());
  for (std::size_t a = 0; a < shares.size(); ++a) {
    shares[a] =
        orders<Measure> / (Measure::arms + 1) * own_volume(points, Index(a)) * effective_volume[a];
  }
  return shares;
}

template std::vector<double> effective_volumes(const Triangles&, const std::vector<std::int32_t>&,
                                               const BulkNeighbourhood&, InteractionWeights);
template std::vector<double> effective_volumes(const Tetrahedra&, const std::vector<std::int32_t>&,
                                               const BulkNeighbourhood&, InteractionWeights);
template std::vector<double> weight_shares<Area>(const Points&, const std::vector<double>&);
template std::vector<double> weight_shares<Volume>(const Points&, const std::vector<double>&);

}  // namespace peristat
