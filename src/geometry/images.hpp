#pragma once

#include <array>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

struct Points;

/// A plane of symmetry across an axis, on one side of which the body lies.
struct SymmetryPlane {
  int axis = 0;
  double at = 0.0;  ///< [m]
};

/// Two sides across an axis that continue each other.
struct Period {
  int axis = 0;
  double from = 0.0, to = 0.0;  ///< [m]
};

/// Map of a source to its image: X' = mirror X + shift, per component.
struct ImageKind {
  std::array<double, 3> mirror{1.0, 1.0, 1.0};  ///< -1 across a plane of symmetry
  Coordinates shift{};                          ///< [m]
  std::array<int, 3> periods{};                 ///< per axis, number of periods between the two

  [[nodiscard]] Coordinates place(const Coordinates& of_source) const {
    Coordinates at{};
    for (std::size_t c = 0; c < 3; ++c) at[c] = mirror[c] * of_source[c] + shift[c];
    return at;
  }
};

/// Relative kind of two images, of kinds `from` and `to`: the image of the second one's source that
/// lies to the first one's source as the two images lie to each other.
[[nodiscard]] ImageKind relative(const ImageKind& from, const ImageKind& to);

/// True if both place images alike, within a distance.
[[nodiscard]] bool is_same(const ImageKind& one, const ImageKind& other, double tolerance);

/// The last points of a body, which represent points beyond planes of symmetry and periodic sides.
struct Images {
  std::vector<ImageKind> kinds;
  std::vector<Index> source;      ///< of each image
  std::vector<std::size_t> kind;  ///< of each image
};

/// Adds the images that lie within a distance of the body's points.
/// @throws InputError ("symmetries[k].…", "periods[k].…") for a plane that runs through points or
///         does not mirror the lattice, points on both sides of it, points beyond a period, or two
///         that share an axis
void add_images(Points& points, const std::vector<SymmetryPlane>& planes,
                const std::vector<Period>& periods, double reach);

/// Refuses planes that do not mirror a lattice onto itself, and periods that do not continue it.
/// @throws InputError as add_images does
void require_lattice_goes_on(const Points& lattice, const std::vector<SymmetryPlane>& planes,
                             const std::vector<Period>& periods);

/// The points that are no images.
[[nodiscard]] Points without_images(const Points& points);

}  // namespace peristat
