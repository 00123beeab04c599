#pragma once

#include <memory>

#include "assembly/assembler.hpp"
#include "solvers/body/body.hpp"
#include "solvers/linear/memory_estimate.hpp"
#include "solvers/study/study_options.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Solution method for the linear systems of a body.
struct LinearSystems {
  ChosenSolver chosen;
  bool is_stored = true;  ///< the tangent is stored
  /// For a part of a body: its tangent has rows that preconditioners can read, as well as products.
  bool has_rows = true;
  Precision precision = Precision::full;  ///< see StudyOptions
  double bytes = 0.0;                     ///< estimated for the whole run

  /// What the assembler of the tangent has the pattern of.
  [[nodiscard]] Assembler::PatternOf pattern_of() const {
    return is_stored ? Assembler::PatternOf::blocks : Assembler::PatternOf::visited_rows;
  }
  [[nodiscard]] std::unique_ptr<TangentOperator> make_tangent(Assembler& assembler,
                                                              const Constraints& constraints) const;
};

/// Lattice box of a body for which sines are requested, or may be chosen by `automatic`; null for
/// others.
/// @throws InputError ("linear.preconditioner") if sines are requested and can't be used
[[nodiscard]] std::shared_ptr<const LatticeBox> box_for_sines(const StudyOptions& options,
                                                              const Body& body);

/// Chooses the method for a body under its conditions.
/// @param tell see make_linear_solver
/// @throws InputError ("tangent", "linear.method", "linear.preconditioner") for options that do not
///         go with its model or its conditions
[[nodiscard]] LinearSystems choose_linear_systems(const StudyOptions& options, const Body& body,
                                                  SolverLadder::Reporter tell);

/// Chooses the method for a model whose loads are given.
/// @param estimate memory estimate of the body
/// @param box see box_for_sines
/// @param tell see make_linear_solver
/// @throws InputError ("tangent") if the model needs a stored tangent
[[nodiscard]] LinearSystems choose_linear_systems(const StudyOptions& options, const Model& model,
                                                  const MemoryEstimate& estimate,
                                                  std::shared_ptr<const LatticeBox> box,
                                                  SolverLadder::Reporter tell,
                                                  const IndexMap& index_map = whole_body());

}  // namespace peristat
