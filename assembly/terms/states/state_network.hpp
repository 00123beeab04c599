#pragma once

#include <vector>

#include "src/geometry/points.hpp"
#include "src/materials/lame_constants.hpp"
#include "src/neighbourhood/bonds.hpp"
#include "src/neighbourhood/lower_neighbours.hpp"

namespace peristat {

/// The other half of a bond i-j' with an image j' of j: the bond of j with the image i' of i that
/// lies to j as i lies to j'. For a bond of a point with its own mirror image it is the bond
/// itself.
struct BondTwin {
  Index point = 0;   ///< j
  Offset bond = -1;  ///< -1: the bond is whole
};

/// Constants of the energy of states, frozen in the reference configuration.
struct StateShares {
  /// Weights kappa_ij r, kappa_ij = K(r) V_i V_j nu_ij of the bonds that are left, half of it with
  /// an image.
  BondKinds whole;
  std::vector<double> moment;  ///< per point M_i = sum_j kappa_ij r^2 over whole neighbourhoods
  std::vector<LamePair> constants{};  ///< per point [Pa]
  std::vector<BondTwin> twins{};      ///< per bond; empty: there are no images
};

/// Twins of bonds; empty without images.
/// @throws std::logic_error if a bond has none
[[nodiscard]] std::vector<BondTwin> twins_of(const Points& points, const Bonds& bonds);

/// sum_j kappa_ij r_ij^2 per point with the actual distances r: with these moments the dilatation
/// of a uniform dilation is right at every point, however few neighbours it has. Images have those
/// of their sources.
/// @param bonds with weights kappa_ij r, up to a factor that all of them have
[[nodiscard]] std::vector<double> moments_of(const Points& points, const Bonds& bonds);

/// Lower neighbours of each point, and pairs of points with a common neighbour: connectivity that
/// the bonds do not store.
struct StateNetwork : LowerNeighbours {
  /// Blocks of the tangent: partners above a point within two bonds of it.
  std::vector<Offset> block_offset;
  Partners partner;

  /// @param reaches_twice true if points with a common neighbour are coupled
  StateNetwork(const Bonds& bonds, bool reaches_twice, int threads);
};

}  // namespace peristat
