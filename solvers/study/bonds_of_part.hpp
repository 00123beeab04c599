#pragma once

#include "solvers/ranks/part_bonds.hpp"
#include "solvers/study/body_specification.hpp"

namespace peristat {

/// Returns which bonds a part of a body needs for the terms of its model.
[[nodiscard]] inline PartBonds bonds_of_part(const BodySpecification& of) {
  if (of.material.model == MaterialModel::cpd) return PartBonds::among_neighbours;
  return of.has_states() || of.is_collocated() ? PartBonds::of_neighbours : PartBonds::of_owned;
}

}  // namespace peristat
