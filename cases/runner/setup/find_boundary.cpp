#include "cases/runner/setup/find_boundary.hpp"

#include <memory>
#include <variant>
#include <vector>

#include "solvers/formulations/formulations.hpp"
#include "src/geometry/covers.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

void find_boundary(const Case& from, const Points& points, const Communicator& ranks,
                   BodySpecification& of) {
  const auto* const lattice = std::get_if<Lattice>(&from.body);
  if (!takes(from, Option::surface_loads) || lattice == nullptr) return;
  std::vector<Coordinates> places;
  for (Index i = 0; i < points.owned.value_or(points.own()); ++i) {
    places.push_back(points.position(i));
  }
  of.boundary = std::make_shared<const BodyBoundary>(
      from.dimension, lattice->shapes, covers_of(*lattice, places, ranks), points.spacing);
  for (const ShapeStep& step : lattice->shapes) of.boundary_names.push_back(step.name);
}

}  // namespace peristat
