#pragma once

#include <vector>

#include "assembly/terms/model.hpp"
#include "src/conditions/surface_tractions.hpp"
#include "src/geometry/body_boundary.hpp"

namespace peristat {

/// Finds the faces over which the balls around points of a body of model "lps" reach, for points
/// that have a normal. At a point with several faces the shares a_f of sum_f a_f e_f = n are those
/// of least squares. In a part of a body only points that its rank owns have sites.
/// @param boundary null: the faces are not known
/// @param names of the boundary's shapes; may be empty
[[nodiscard]] std::vector<SurfaceSite> surface_sites(const Points& points, const Model& model,
                                                     const BodyBoundary* boundary,
                                                     const std::vector<std::string>& names,
                                                     double horizon, int threads);

/// Refuses free points on a face of the body: their missing half balls would begin half a spacing
/// too deep, and tractions act there.
/// @param prescribed per degree of freedom
/// @throws InputError ("material.model")
void refuse_points_on_faces(const Points& points, const std::vector<SurfaceSite>& sites,
                            const std::vector<char>& prescribed);

}  // namespace peristat
