#pragma once

#include <vector>

#include "assembly/terms/model.hpp"
#include "src/conditions/surface_tractions.hpp"
#include "src/geometry/body_boundary.hpp"

namespace peristat {

/// The faces over which the balls around the points of a body of model "lps" reach, where these
/// have a normal. Of a point at several faces the shares a_f of sum_f a_f e_f = n are those of
/// least squares.
/// @param boundary null: nobody knows the faces
/// @param names of the boundary's shapes; may be empty
[[nodiscard]] std::vector<SurfaceSite> surface_sites(const Points& points, const Model& model,
                                                     const BodyBoundary* boundary,
                                                     const std::vector<std::string>& names,
                                                     double horizon, int threads);

}  // namespace peristat
