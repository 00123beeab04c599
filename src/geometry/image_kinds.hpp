#pragma once

#include <array>
#include <limits>
#include <vector>

#include "src/geometry/points.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Extent of the points of a body along each axis [m], and the places of the outermost points.
struct BodyExtent {
  struct Along {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    Coordinates first{}, last{};
  };
  std::array<Along, 3> along;
};

/// @param points of the whole body, or those of this rank (collective)
[[nodiscard]] BodyExtent extent_of(const Points& points, const Communicator& ranks);

/// The kinds of images of a body between planes of symmetry and periodic sides that may lie within
/// a distance of its points.
/// @param points of the body or of a part of it; their places are not used
/// @throws InputError ("symmetries[k].…", "periods[k].…") for a plane that runs through points or
///         does not mirror the lattice, points on both sides of it, points beyond a period, or two
///         that share an axis
[[nodiscard]] std::vector<ImageKind> image_kinds(const Points& points, const BodyExtent& body,
                                                 const std::vector<SymmetryPlane>& planes,
                                                 const std::vector<Period>& periods, double reach);

/// Adds the images that lie within a distance of the box around the points; for a part of a body
/// first those of owned points.
void add_images(Points& points, const std::vector<ImageKind>& kinds, double reach);

/// Refuses planes that do not mirror a lattice onto itself, and periods that do not continue it.
/// @param lattice the points of this rank (collective)
/// @throws InputError as image_kinds does
void require_lattice_goes_on(const Points& lattice, const std::vector<SymmetryPlane>& planes,
                             const std::vector<Period>& periods, const Communicator& ranks);

}  // namespace peristat
