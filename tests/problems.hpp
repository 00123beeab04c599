#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "solvers/linear/cholesky.hpp"
#include "solvers/problem/equilibrium.hpp"
#include "tests/bodies.hpp"

namespace peristat::tests {

/// A support; components that are not given are free.
[[nodiscard]] inline SupportSpecification support(std::string set, std::optional<std::string> x,
                                                  std::optional<std::string> y = std::nullopt,
                                                  std::optional<std::string> z = std::nullopt) {
  return {std::move(set), {std::move(x), std::move(y), std::move(z)}};
}

[[nodiscard]] inline LoadSpecification body_force(std::string set, std::string x,
                                                  std::string y = "0", std::string z = "0") {
  return {LoadSpecification::Kind::body_force,
          std::move(set),
          {std::move(x), std::move(y), std::move(z)}};
}

/// Points of a box with the sets "left" and "right" (the outermost points in x) and "all".
[[nodiscard]] inline Points points_with_ends(const BoxSetting& box) {
  Points points = box_points(box);
  for (Index i = 0; i < points.count(); ++i) {
    const double x = points.position(i)[0];
    if (x < box.spacing) points.sets["left"].push_back(i);
    if (x > (box.extent[0] - 1) * box.spacing) points.sets["right"].push_back(i);
    points.sets["all"].push_back(i);
  }
  return points;
}

/// A body with conditions, and everything that a search for equilibrium needs.
struct Problem {
  BoxBody body;
  Conditions conditions;
  FreeDofs free;
  Assembler assembler;
  Tangent tangent;
  EquilibriumProblem equilibrium{assembler, conditions, free};

  Problem(const BoxSetting& box, const std::vector<SupportSpecification>& supports,
          const std::vector<LoadSpecification>& loads, int threads = 1)
      : body(points_with_ends(box), box),
        conditions(body.points, supports, loads),
        free(conditions.prescribed(), box.dimension),
        assembler(body.points, body.model, threads),
        tangent(BlockPattern(body.model.bonds()), box.dimension) {}
  Problem(const Problem&) = delete;
  Problem& operator=(const Problem&) = delete;

  /// Prepares the solver for this problem.
  LinearOutcome analyze(LinearSolver& solver) const {
    return solver.analyze(tangent.pattern, free);
  }

  [[nodiscard]] State at_rest() const {
    return {std::vector<double>(body.dofs(), 0.0), 0.0, assembler.initial_history()};
  }
};

}  // namespace peristat::tests
