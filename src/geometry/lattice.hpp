#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "src/core/given_function.hpp"
#include "src/core/spacing.hpp"
#include "src/geometry/layer.hpp"
#include "src/geometry/points.hpp"
#include "src/geometry/solid.hpp"
#include "src/geometry/spacing_field.hpp"

namespace peristat {

/// Where lattice points stand relative to the lower corner of the first added shape's bounding box.
enum class LatticeOrigin { cell_centres, nodes };

/// Volumes of points: `whole`, that of a cell, the body being all cells whose place lies in it; or
/// `fractional`, that of the part of the cell that lies in the body, whether the cell's place does
/// or not.
enum class CellVolumes { whole, fractional };

/// Where points stand: on the lattice, or at random with about the same distance from their
/// neighbours, see blue_noise.hpp.
enum class Arrangement { lattice, blue_noise };

struct Lattice {
  int dimension = 2;
  Arrangement arrangement = Arrangement::lattice;
  Spacing spacing = 0.0;       ///< along the lattice's axes [m]
  double angle = 0.0;          ///< rotation of the lattice about z through the origin [degrees]
  double cross_section = 1.0;  ///< 1D: area [m2]; 2D: thickness [m]; 3D: 1
  LatticeOrigin origin = LatticeOrigin::cell_centres;
  CellVolumes volumes = CellVolumes::whole;
  std::vector<ShapeStep> shapes{};
  std::vector<Layer> layers{};
  double perturbation = 0.0;  ///< largest random shift along each of the lattice's axes, in
                              ///< spacings, below 0.5
  /// Largest random shift of the corners of cells inside the body along each of the lattice's axes,
  /// in spacings, below 1/4, so that cells stay convex ([GPMB] app. B); dimensions 1 and 2.
  double cell_perturbation = 0.0;
  std::vector<Refinement> refinements{};  ///< blue noise: regions of finer points
  int lloyd_steps = 5;  ///< blue noise: how often points move to the centroids of their cells
  std::uint64_t seed = 1;
  /// Functions that expressions of layers may call; null: none.
  std::shared_ptr<const GivenFunctions> functions{};
};

/// Refuses shapes, layers and values that can't be used, whatever the number of points is.
/// @throws InputError
void check_lattice(const Lattice& lattice);

/// A part of a cell below this share is given to the parts in the adjacent cells, in proportion to
/// their shares; without any it stays.
inline constexpr double smallest_share = 0.01;

/// Upper bound of the number of points, without making them: the lattice places in the box around
/// all added shapes, and the layers; infinite if that box or the spacing can't be used.
[[nodiscard]] double estimate_points(const Lattice& lattice);

/// Points of the lattice, numbered with locality (see numbering.hpp). With whole cells every point
/// has the volume of a cell, the product of the spacings x cross_section; fractional volumes add up
/// to the body's volume, with the accuracy of piece_of. The layers' points stay on the lattice when
/// it is perturbed; a seed gives the same perturbation everywhere. Points of perturbed cells stand
/// at their centroids and have their volumes. Blue noise is that of make_blue_noise_points.
/// @throws InputError if a shape or value can't be used, if no point is left, or if a layer that
///         needs a flat face has none
[[nodiscard]] Points make_points(const Lattice& lattice);

}  // namespace peristat
