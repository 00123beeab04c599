#pragma once

#include <cstddef>
#include <vector>

#include "assembly/assembler.hpp"
#include "assembly/stress.hpp"
#include "solvers/body/body.hpp"

namespace peristat {

/// Strain and stress of a state at the body's own points; in a part of a body at owned points.
[[nodiscard]] Stress stress_of(const Body& body, Assembler& assembler, const StateView& at);

/// Upper halves of the symmetric parts of tensors: xx, or xx, yy, xy, or xx, yy, zz, xy, yz, xz.
/// @param tensors points x d x d
[[nodiscard]] std::vector<double> symmetric_parts(const std::vector<double>& tensors,
                                                  std::size_t d);

/// Share of an interior point's neighbourhood that each point lacks; 1 where its bonds give no F.
/// @param is_determined see Stress
[[nodiscard]] std::vector<double> missing_neighbourhood(const Body& body, const StateView& at,
                                                        const std::vector<char>& is_determined);

}  // namespace peristat
