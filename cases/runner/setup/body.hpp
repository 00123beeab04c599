#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "solvers/body/body.hpp"

namespace peristat {

/// Points and sets of a case.
/// @throws InputError (with place) if a set selects nothing, and as the makers of points do
/// @throws MemoryError if the points would not fit
[[nodiscard]] Points make_points_of(const Case& from);

/// Subtracted shapes that bonds must not cross, by `cuts_bonds`.
[[nodiscard]] std::vector<Crack> cracks_of_shapes(const Case& from);

/// Specification of the body: the cracks of its tables come first, then those of its shapes.
[[nodiscard]] BodySpecification specification_of(const Case& from);

/// Builds the whole body on one rank.
/// @throws InputError (with place), MemoryError if the estimate exceeds the memory available
[[nodiscard]] std::unique_ptr<const Body> make_body(const Case& from, int threads);

/// Memory per point for strain and stress: five tensors that are written and three more, symmetric
/// halves of two, principal values and scalars [byte].
[[nodiscard]] double stress_bytes_per_point(int dimension);

/// Elastic model of the same points and conditions with another horizon
/// (solver.elastic_horizon_ratio); nothing if the case asks for none.
[[nodiscard]] std::optional<Model> make_elastic_stand_in(const Case& from, const Body& body,
                                                         int threads);

}  // namespace peristat
