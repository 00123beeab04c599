#pragma once

#include <memory>

#include "assembly/assembler.hpp"
#include "solvers/linear/memory_estimate.hpp"
#include "solvers/study/body.hpp"
#include "solvers/study/study_options.hpp"

namespace peristat {

/// How the linear systems of a body are solved.
struct LinearSystems {
  ChosenSolver chosen;
  bool is_stored = true;  ///< the tangent
  /// Of a part of a body: its tangent has rows for preconditioners to look at, as well as products.
  bool has_rows = true;
  double bytes = 0.0;  ///< estimated for the whole run

  [[nodiscard]] std::unique_ptr<TangentOperator> make_tangent(Assembler& assembler,
                                                              const Constraints& constraints) const;
};

/// Where the points of a body stand that sines are asked for, or may be chosen for by `automatic`;
/// nothing for others.
/// @throws InputError ("linear.preconditioner") where sines are asked for and can't be taken
[[nodiscard]] std::shared_ptr<const LatticeBox> box_for_sines(const StudyOptions& options,
                                                              const Body& body);

/// Of a body under its conditions.
/// @param tell see make_linear_solver
/// @throws InputError ("tangent", "linear.method", "linear.preconditioner") for what does not go
///         with its model or its conditions
[[nodiscard]] LinearSystems choose_linear_systems(const StudyOptions& options, const Body& body,
                                                  SolverLadder::Reporter tell);

/// Of a model whose loads are given.
/// @param estimate what the body is estimated to need
/// @param box see box_for_sines
/// @param tell see make_linear_solver
/// @param sharing of a part of a body; null: it is whole
/// @throws InputError ("tangent") if the model's can't do without being stored
[[nodiscard]] LinearSystems choose_linear_systems(const StudyOptions& options, const Model& model,
                                                  const MemoryEstimate& estimate,
                                                  std::shared_ptr<const LatticeBox> box,
                                                  SolverLadder::Reporter tell,
                                                  const Sharing* sharing = nullptr);

}  // namespace peristat
