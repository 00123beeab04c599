#pragma once

#include <functional>
#include <vector>

#include "src/core/communicator.hpp"
#include "src/geometry/numbered_points.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// What other ranks tell of bonds that a part has.
struct HeardOfBonds {
  std::vector<Offset> bond{};
  std::vector<double> values{};  ///< as many of each bond
};

/// What of bonds between two images, which weigh nothing, but which triangles stand on.
enum class BetweenImages {
  nothing,        ///< nobody tells of them
  what_they_show  ///< of the bond at a point that such a one is the image of
};

/// Of every bond the rank tells that owns its end with the lower number in the whole body, and of
/// one to an image that owns the other end: those that have it, too, ask for it, also for one
/// between two of their ghosts. A call that all ranks make.
/// @param numbered the points that stand for themselves
/// @param width how many values tell(bond, to) writes of a bond
/// @throws std::logic_error if a rank asks for a bond that the other one does not have
[[nodiscard]] HeardOfBonds heard_of_bonds(const Bonds& bonds, const Points& points,
                                          const NumberedPoints& numbered, const Communicator& ranks,
                                          BetweenImages between_images, int width,
                                          const std::function<void(Offset, double*)>& tell);

}  // namespace peristat
