#pragma once

#include "solvers/study/bond_materials.hpp"
#include "src/core/communicator.hpp"

namespace peristat {

/// refuse_idle_interfaces of a part of a body; a call that all ranks make.
/// @param ranks null: the body is whole
void refuse_idle_interfaces(const BodySpecification& from, const PointMaterials& materials,
                            const Bonds& bonds, const Communicator* ranks);

}  // namespace peristat
