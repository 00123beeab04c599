#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "src/geometry/points.hpp"
#include "src/geometry/shape.hpp"
#include "src/geometry/side.hpp"

namespace peristat {

/// Where lattice points stand relative to the lower corner of the first added shape's bounding box.
enum class LatticeOrigin { cell_centres, nodes };

/// One step of building the body: the shape is added to it or taken away from it, in order; the
/// boundary belongs to the shape, so a point on a subtracted shape's boundary goes. The first step
/// adds.
struct ShapeStep {
  enum class Action { add, subtract } action = Action::add;
  Shape shape{};
};

/// Fictitious points outside the body that carry a support: copies of the body's outermost lattice
/// plane on one side, shifted outwards by one to `thickness` spacings. The layer is also a set;
/// layers of one name make one set, and a place in two layers holds one point that is in both sets.
struct Layer {
  std::string name{};
  Side side{};
  int thickness = 3;    ///< in spacings
  std::string where{};  ///< optional expression of x, y, z that keeps a part of the layer
};

struct Lattice {
  int dimension = 2;
  double spacing = 0.0;        ///< [m]
  double cross_section = 1.0;  ///< 1D: area [m2]; 2D: thickness [m]; 3D: 1
  LatticeOrigin origin = LatticeOrigin::cell_centres;
  std::vector<ShapeStep> shapes{};
  std::vector<Layer> layers{};
  double perturbation = 0.0;  ///< largest random shift per component, in spacings, below 0.5
  std::uint64_t seed = 1;
};

/// Refuses shapes, layers and values that can't be used, whatever the number of points is.
/// @throws InputError
void check_lattice(const Lattice& lattice);

/// Upper bound of the number of points, without making them: the lattice places in the box around
/// all added shapes, and the layers; infinite if that box or the spacing can't be used.
[[nodiscard]] double estimate_points(const Lattice& lattice);

/// Points of the lattice, numbered with locality (see numbering.hpp); every point has the volume
/// spacing^dimension x cross_section. The layers' points stay on the lattice when it is perturbed;
/// a seed gives the same perturbation everywhere.
/// @throws InputError if a shape or value can't be used, or if no point is left
[[nodiscard]] Points make_points(const Lattice& lattice);

}  // namespace peristat
