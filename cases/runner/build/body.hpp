#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "solvers/study/body.hpp"

namespace peristat {

/// Points and sets of a case.
/// @throws InputError (with place) if a set selects nothing, and as the makers of points do
/// @throws MemoryError if the points would not fit
[[nodiscard]] Points make_points_of(const Case& from);

/// Subtracted shapes that bonds must not cross, by `cuts_bonds`.
[[nodiscard]] std::vector<Crack> cracks_of_shapes(const Case& from);

/// What the body is made of: with the cracks of its tables, then those of its shapes.
[[nodiscard]] BodySpecification specification_of(const Case& from);

/// The whole body.
/// @throws InputError (with place), MemoryError if the estimate exceeds the memory available
[[nodiscard]] std::unique_ptr<const Body> make_body(const Case& from, int threads);

/// What finding strain and stress takes, per point: five tensors that are told and three beside
/// them, symmetric halves of two, principal values and scalars [byte].
[[nodiscard]] double stress_bytes_per_point(int dimension);

/// The same points and conditions with elastic bonds of another horizon (solver.
/// elastic_horizon_ratio), or nothing if the case asks for none.
[[nodiscard]] std::optional<Model> make_elastic_stand_in(const Case& from, const Body& body,
                                                         int threads);

}  // namespace peristat
