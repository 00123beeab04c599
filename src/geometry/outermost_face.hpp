#pragma once

#include <optional>
#include <vector>

#include "src/geometry/layer.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// outermost_face of a body that ranks share. Collective, with the places of each rank.
[[nodiscard]] std::optional<double> outermost_face(const Solid& body, const Side& side,
                                                   const std::vector<Coordinates>& places,
                                                   double spacing, const Communicator& ranks);

}  // namespace peristat
