#pragma once

#include <vector>

#include "tests/problems.hpp"

namespace peristat::tests {

/// A tangent of a body, with some degrees of freedom prescribed.
struct System {
  BoxBody body;
  FreeDofs free;
  Tangent tangent;
  std::vector<double> b, x;

  System(const BoxSetting& box, const std::vector<char>& prescribed,
         const std::vector<double>& state)
      : body(box),
        free(prescribed, box.dimension),
        tangent(Assembler(body.points, body.model, 1)),
        b(Random(3).vector(std::size_t(free.count()))),
        x(std::size_t(free.count()), 1e300) {
    assemble(state);
  }

  void assemble(const std::vector<double>& state) {
    Assembler(body.points, body.model, 1).tangent(state, tangent);
  }

  LinearOutcome solve(LinearSolver& solver, FactorUse use = FactorUse::factorize_now) {
    LinearOutcome outcome = solver.factorize(tangent, use);
    if (outcome == LinearOutcome::solved) outcome = solver.solve(b, x, 1e-12);
    return outcome;
  }
};

/// Prescribes all components of four points (0, 1, middle, last) and single components of others.
inline std::vector<char> some_prescribed(const BoxBody& body) {
  const int d = body.points.dimension;
  const int last = body.points.count() - 1;
  std::vector<char> prescribed(body.dofs(), 0);
  for (int point : {0, 1, last / 2, last}) {
    for (int c = 0; c < d; ++c) prescribed[std::size_t(point) * d + c] = 1;
  }
  for (int k = 0; k < d; ++k) prescribed[std::size_t(8 + 2 * k) * d + k] = 1;
  return prescribed;
}

/// Eigenvalues, ascending, of the tangent on the free degrees of freedom, by Eigen's dense solver.
[[nodiscard]] std::vector<double> dense_eigenvalues(const System& system);

/// Distance of the system's solution from that of Eigen's dense solver, over its norm.
[[nodiscard]] double solution_error(const System& system);

}  // namespace peristat::tests
