#pragma once

#include <span>
#include <string>
#include <vector>

#include "src/connectivity/holding.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Connected components of the bond graph.
struct Components {
  std::vector<Index> of_point;  ///< number of the component that a point belongs to
  std::vector<Index> size;      ///< points of each component

  /// Points of each component, ascending.
  [[nodiscard]] std::vector<std::vector<Index>> members() const;
};

/// Returns the connected components, numbered by their lowest points.
/// @param broken one flag per bond; flagged bonds do not connect. Empty: all bonds do.
/// @param links pairs of points that are connected, too
[[nodiscard]] Components connected_components(const Bonds& bonds, std::span<const char> broken = {},
                                              std::span<const BondEnds> links = {});

/// Adds what ties images to their sources, for images that unbroken bonds join to the body: links,
/// and the motions that would part the two.
/// @param positions of the points, points x dimension [m]
[[nodiscard]] Holding with_images(Holding holding, const Points& points, const Bonds& bonds,
                                  std::span<const char> broken, std::span<const double> positions);

/// Rigid motions that the supports leave to one connected component of the bond graph.
struct FreeMotion {
  GlobalIndex points = 0;            ///< of the component
  GlobalIndex example = 0;           ///< its lowest point, by its number in the whole body
  Coordinates place{};               ///< position of that point [m]
  std::vector<std::string> motions;  ///< "move along x", "rotate about z", …
};

/// All components that may move as rigid bodies, largest first; empty if everything is held.
/// Decided by the rank of the prescribed components on the rigid motions of each component.
/// Collective, with the same result on all ranks
[[nodiscard]] std::vector<FreeMotion> free_motions(const Points& points, const Bonds& bonds,
                                                   const Holding& holding,
                                                   const IndexMap& index_map = whole_body());

}  // namespace peristat
