#pragma once

#include <vector>

#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"
#include "src/neighbourhood/bulk_neighbourhood.hpp"
#include "src/neighbourhood/interactions.hpp"

namespace peristat {

/// How the weights of interactions near surfaces follow from those of their points.
enum class InteractionWeights {
  mean,  ///< mean over the interaction's points
  bulk,  ///< every point counts as if it were far from all surfaces
};

/// Effective volume of one neighbour, V1 = V_H / #N1 [m3] (eq. 29 of [CPD]). The volume of a
/// point's neighbourhood is V_H = V_H,bulk #N1 / #N1,bulk, truncated at surfaces as the neighbours
/// are, so that V1 is the same for all points.
[[nodiscard]] double effective_neighbour_volume(const BulkNeighbourhood& bulk);

/// Weights of bonds as one-neighbour interactions: w = (V_i + V_j)/2 V1 [m6].
void set_one_neighbour_weights(Bonds& bonds, const Points& points, const BulkNeighbourhood& bulk);

/// Effective volumes V2 = V_H^2 / #N2 [m6] of a pair and V3 = V_H^3 / #N3 [m9] of a triplet of
/// every point (eqs. 32 and 34 of [CPD]), with ordered counts: 2 for every triangle of the point, 6
/// for every tetrahedron, each times its flatness factor. Points with a sum of factors below 1 get
/// less than these, continuously.
template <class Measure>
[[nodiscard]] std::vector<double> effective_volumes(const Interactions<Measure>& interactions,
                                                    const std::vector<std::int32_t>& neighbours,
                                                    const BulkNeighbourhood& bulk,
                                                    InteractionWeights weights);

/// Contribution of each point to the weight of an interaction,
///
///   2/3 V^a V2^a [m9] for triangles,  6/4 V^a V3^a [m12] for tetrahedra,
///
/// so that w = sum over its points = 2 or 6 times the mean of V^a Vn^a: the unique interaction
/// replaces the ordered ones of eq. 14, whose factors 1/3 and 1/4 make the mean. Where V^a Vn^a is
/// the same at all points, -dE/dx^a is the point's volume times the paper's residual (eqs. 53, 58,
/// 61). Elsewhere that residual does not derive from an energy: its tangent is unsymmetric by some
/// per cent and its forces do not add up to zero.
template <class Measure>
[[nodiscard]] std::vector<double> weight_shares(const Points& points,
                                                const std::vector<double>& effective_volume);

}  // namespace peristat
