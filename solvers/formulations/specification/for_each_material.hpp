#pragma once

#include <string>

#include "solvers/formulations/specification/body_specification.hpp"

namespace peristat {

/// Calls visit(material, key) for all materials that are given: the body's own if it has constants,
/// those of regions and of interfaces. The key is that of the specification.
/// @param of a BodySpecification, constant or not
template <class Specification, class Visit>
void for_each_material(Specification& of, const Visit& visit) {
  const auto number = [](std::size_t k) { return "[" + std::to_string(k) + "].material"; };
  if (of.regions.empty() || of.material.has_constants()) visit(of.material, "material");
  for (std::size_t k = 0; k < of.regions.size(); ++k) {
    visit(of.regions[k].material, "regions" + number(k));
  }
  for (std::size_t k = 0; k < of.interfaces.size(); ++k) {
    if (of.interfaces[k].material) visit(*of.interfaces[k].material, "interfaces" + number(k));
  }
}

}  // namespace peristat
