#pragma once

#include <functional>
#include <vector>

#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"
#include "src/parallel/communicator.hpp"
#include "src/parallel/numbered_points.hpp"

namespace peristat {

/// Values of bonds of a part that other ranks have sent.
struct HeardOfBonds {
  std::vector<Offset> bond{};
  std::vector<double> values{};  ///< equally many per bond
};

/// Treatment of bonds between two images, which have no weight but may be edges of triangles.
enum class BetweenImages {
  nothing,        ///< they get no values
  what_they_show  ///< they get those of the bond at a source point that they are the image of
};

/// Gets values of bonds that several ranks have from the rank that owns a bond's end with the lower
/// number in the whole body; of a bond to an image, from the rank that owns the other end. All
/// ranks that have the bond request them, also for bonds between two of their ghosts. Collective.
/// @param numbered the points that are no images
/// @param width number of values that tell(bond, to) writes per bond
/// @throws std::logic_error if a rank requests a bond that the other one does not have
[[nodiscard]] HeardOfBonds heard_of_bonds(const Bonds& bonds, const Points& points,
                                          const NumberedPoints& numbered, const Communicator& ranks,
                                          BetweenImages between_images, int width,
                                          const std::function<void(Offset, double*)>& tell);

}  // namespace peristat
