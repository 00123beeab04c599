#pragma once

#include <vector>

#include "src/geometry/points.hpp"

namespace peristat {

/// Adds the tensors of images to those of their sources, mirrored back: M T M with the mirror M of
/// a plane of symmetry.
/// @param tensors points x dimension x dimension, row major
void gather_image_tensors(const Points& points, std::vector<double>& tensors);

}  // namespace peristat
