#pragma once

#include <string>

#include "solvers/formulations/specification/body_specification.hpp"

namespace peristat {

/// Refuses a material that contradicts itself, is incomplete, or has data that its model does not
/// take.
/// @param key of the material, for errors
/// @throws InputError
void check_material(const MaterialSpecification& material, const std::string& key, int dimension);

/// Refuses materials, regions and interfaces that do not go together, and options that the
/// formulation takes with no operator, whatever the points are.
/// @throws InputError
void check_materials(const BodySpecification& of, int dimension);

/// Refuses a specification that contradicts itself, is incomplete or would be ignored in part, like
/// a Poisson ratio given to bonds alone.
/// @throws InputError ("horizon", "cross_section", "material.…", "cracks[0].…", …)
void check_specification(const BodySpecification& of, const Points& points);

/// Refuses a horizon whose neighbourhood in the bulk takes minutes to sum, however small the body.
/// @param key   key of the horizon, for the error
/// @param ratio horizon / spacing
/// @throws InputError
void require_summable(const MaterialSpecification& material, int dimension, const std::string& key,
                      const std::string& value, double ratio);

}  // namespace peristat
