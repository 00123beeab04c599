#pragma once

#include "solvers/study/bond_materials.hpp"
#include "src/core/communicator.hpp"

namespace peristat {

/// refuse_idle_interfaces for a part of a body. Collective.
/// @param ranks null: the body is not partitioned
void refuse_idle_interfaces(const BodySpecification& from, const PointMaterials& materials,
                            const Bonds& bonds, const Communicator* ranks);

}  // namespace peristat
