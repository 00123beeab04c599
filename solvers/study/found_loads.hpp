#pragma once

#include "solvers/body/body.hpp"
#include "solvers/study/study_options.hpp"

namespace peristat {

/// True if loads are found with the states, not given: under a control, and in mode arc_length.
[[nodiscard]] bool finds_loads(const StudyOptions& options, const Conditions& conditions);

/// Refuses loads that can't be found, by the tangent at rest.
/// @param solver analysed for the body's pattern and `free`
/// @throws InputError ("controls") for a control that does not depend on the load, ("supports") if
///         nothing depends on it
void refuse_unanswered_loads(const Body& body, const FreeDofs& free, Assembler& assembler,
                             LinearSolver& solver, TangentOperator& tangent);

}  // namespace peristat
