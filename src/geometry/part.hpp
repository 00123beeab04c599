#pragma once

#include <string>
#include <vector>

#include "src/geometry/points.hpp"

namespace peristat {

/// The part of a body that a rank holds: points that it owns, ascending by their numbers in the
/// whole body, then ghosts, ascending as well: points of other ranks within a distance of its own.
/// Sets hold the points that are here, and every rank knows all names.
///
/// Numbers in the whole body are those that make_points gives, whatever the number of ranks.
struct Part {
  Points points{};
  Index owned = 0;                    ///< points that this rank owns: the first ones
  std::vector<GlobalIndex> number{};  ///< number of each point in the whole body
  std::vector<int> owner{};           ///< rank that owns each ghost
  GlobalIndex whole = 0;              ///< points of the whole body
  double reach = 0.0;                 ///< distance within which ghosts are here [m]
  std::vector<ImageKind> images{};    ///< kinds of images in the whole body, with all inverses

  [[nodiscard]] Index ghosts() const { return points.own() - owned; }
  [[nodiscard]] bool is_ghost(Index point) const {
    return point >= owned && !points.is_image(point);
  }
};

}  // namespace peristat
